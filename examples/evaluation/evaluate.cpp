// SPDX-License-Identifier: MIT
// [GR sec. 4] The paper's comparison on the reference denoiser, with true correspondences: tables, pictures, a plot.
#include "evaluation_scene.hpp"
#include "measures.hpp"
#include "methods.hpp"
#include "paper_figures.hpp"
#include "results.hpp"

#include <examples/support/contact_sheet.hpp>
#include <examples/support/output_file.hpp>
#include <examples/support/pictures.hpp>
#include <examples/support/render_output.hpp>

#include <genrender/core/error.hpp>
#include <genrender/core/parallel.hpp>
#include <genrender/evaluation/time_slice.hpp>
#include <genrender/reference/reference_embedder.hpp>
#include <genrender/reference/reference_network.hpp>

#include <CLI/CLI.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <mutex>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

using namespace genrender;

using namespace genrender::reference;
using namespace genrender::examples;

namespace {

using network = reference_network<float>;

struct options {
    std::filesystem::path out;
    std::filesystem::path weights = GENRENDER_REFERENCE_DENOISER "/weights";
    std::filesystem::path embedder = GENRENDER_REFERENCE_DENOISER "/embedder";
    std::vector<std::string> scenes{scenes::names.begin(), scenes::names.end()};
    std::vector<std::string> prompts{"stripes", "checker", "dots"};
    std::size_t seeds = 3;
    std::size_t frames = 24;
    std::size_t steps = 10;
    std::size_t keyframes = 4;
    float alpha = 0.7f;
    std::vector<std::string> groups = paper_groups();
    std::vector<std::string> methods;
    std::uint32_t size = 64;
    std::size_t threads = 0;
};

/// One animation to make and measure.
struct job {
    std::size_t prompt;
    std::uint64_t seed;
    std::size_t method; ///< in the list of methods; their number stands for the painted render
};

/// Whether the pictures show a job: those of the first prompt and seed.
bool is_shown(job const& job) { return job.prompt == 0 && job.seed == 0; }

/// What a job gave, with its frames if the pictures show it.
struct outcome {
    measures figures;
    tensor<float, 4> images = tensor<float, 4>::from_shape({0, 3, 1, 1});
};

std::string label_of(compared_method<network> const& method) { return method.name + ", " + method.noise + " noise"; }

/// The methods of the groups that are told, and of those the ones whose names are told, if any.
std::vector<compared_method<network>> chosen_methods(options const& told) {
    auto methods = compared_methods<network>();
    auto const is_among = [](std::string const& name, std::vector<std::string> const& names) {
        return std::find(names.begin(), names.end(), name) != names.end();
    };
    std::erase_if(methods, [&](auto const& method) {
        return !is_among(method.group, told.groups) || (!told.methods.empty() && !is_among(method.name, told.methods));
    });
    require_value(!methods.empty(), "evaluate", "--groups or --methods",
                  told.methods.empty() ? told.groups.front() : told.methods.front(), "names as --help tells");
    return methods;
}

/// Settings that all methods share. None of them was chosen by looking at these scenes.
render_settings<float> shared_settings(options const& told, std::uint64_t seed) {
    render_settings<float> settings;
    settings.steps = told.steps;
    settings.sampler = sampler_kind::dpmpp_2m;
    settings.noise.seed = seed;
    settings.keyframes.seed = seed;
    settings.keyframes.count = std::min(told.keyframes, told.frames);
    settings.alpha = [alpha = told.alpha](std::size_t, attention_site const&) { return alpha; };
    return settings;
}

/// The styles as texts: what the embedder has to choose from.
std::vector<std::string> style_texts() { return {style_words.begin(), style_words.end()}; }

std::size_t style_number(std::string const& prompt) {
    auto const found = std::find(style_words.begin(), style_words.end(), prompt);
    require_value(found != style_words.end(), "evaluate", "--prompts", prompt, "styles of the reference denoiser");
    return static_cast<std::size_t>(found - style_words.begin());
}

/// All runs of one scene, in the order of the jobs.
std::vector<outcome> run_scene(options const& told, evaluation_scene const& scene, std::vector<job> const& jobs,
                               std::vector<compared_method<network>> const& methods,
                               reference_embedder<float> const& embedder, threaded_loop const& loop) {
    std::vector<network> phis;
    for (auto const& prompt : told.prompts) {
        phis.push_back(network::from_folder(told.weights, to_view(scene.inverse_depth), prompt));
    }
    auto const texts = style_texts();
    std::vector<outcome> outcomes(jobs.size());
    std::mutex mutex;
    std::size_t done = 0;
    loop(jobs.size(), [&](std::size_t j) {
        auto const& job = jobs[j];
        auto const style = style_number(told.prompts[job.prompt]);
        auto images =
            job.method == methods.size()
                ? painted_frames(scene, static_cast<surface_style>(style), job.seed, sequential_loop{})
                : decoded(methods[job.method].run(phis[job.prompt], scene.uv(), shared_settings(told, job.seed)));
        outcomes[j].figures = measures_of(to_view(std::as_const(images)), scene, embedder, texts, style);
        if (is_shown(job)) {
            outcomes[j].images = std::move(images);
        }
        std::lock_guard const lock(mutex);
        std::printf("\r%s: %zu of %zu", scene.name.c_str(), ++done, jobs.size());
        std::fflush(stdout);
    });
    std::printf("\n");
    return outcomes;
}

/// Frames of one prompt and seed, a row for each method, eight moments of the animation.
void write_contact_sheet(std::filesystem::path const& path, std::vector<std::string> const& labels,
                         std::vector<tensor<float, 4> const*> const& runs) {
    constexpr std::size_t columns = 8;
    std::vector<rgb8_image> cells;
    std::vector<std::string> texts;
    for (std::size_t r = 0; r < runs.size(); ++r) {
        auto const frames = runs[r]->shape()[0];
        for (std::size_t c = 0; c < columns; ++c) {
            auto const i = c * (frames - 1) / (columns - 1);
            cells.push_back(rgb_picture(to_view(*runs[r])[i]));
            // The first two frames of a row carry its name and its noise.
            auto const comma = std::min(labels[r].rfind(", "), labels[r].size());
            texts.push_back(c == 0                               ? labels[r].substr(0, comma)
                            : c == 1 && comma < labels[r].size() ? labels[r].substr(comma + 2)
                                                                 : "");
        }
    }
    write_png(path, contact_sheet(cells, {.columns = columns, .enlargement = 2, .labels = texts}));
}

/// One image row over time for each method: time runs downwards.
void write_time_slices(std::filesystem::path const& path, std::vector<std::string> const& labels,
                       std::vector<tensor<float, 4> const*> const& runs, std::size_t row) {
    std::vector<rgb8_image> slices;
    for (auto const* const run : runs) {
        auto const slice = time_slice(to_view(*run), row);
        rgb8_image picture({slice.extent(0), slice.extent(2)}, {0, 0, 0});
        for (std::size_t i = 0; i < slice.extent(0); ++i) {
            for (std::size_t column = 0; column < slice.extent(2); ++column) {
                picture.set(i, column,
                            {to_byte(slice(i, 0, column)), to_byte(slice(i, 1, column)), to_byte(slice(i, 2, column))});
            }
        }
        slices.push_back(std::move(picture));
    }
    write_png(path, contact_sheet(slices, {.columns = 3, .enlargement = 4, .labels = labels}));
}

/// The paper's tables 1 and 2 with what was measured beside what it reports.
std::string paper_tables(std::vector<run_figures> const& runs) {
    std::ostringstream text;
    text
        << "| Method | Frame consistency | paper | Prompt fidelity | paper | Recognised |\n|---|---|---|---|---|---|\n";
    for (auto const& row : paper_rows) {
        auto const figure = [&](char const* measure) {
            return figure_text(figure_of(runs, std::string(row.method), measure));
        };
        text << "| " << row.name << " | " << figure("consistency_1") << " | "
             << examples::detail::decimal(row.consistency[0]) << " | " << figure("fidelity") << " | "
             << examples::detail::decimal(row.fidelity) << " | " << figure("recognition") << " |\n";
    }
    text << "\n| Frame consistency at interval |";
    for (auto const interval : intervals) {
        text << ' ' << interval << " | paper |";
    }
    text << "\n|---|" << std::string("---|---|---|---|---|---|---|---|---|---|") << '\n';
    for (auto const& row : paper_rows) {
        text << "| " << row.name << " |";
        for (std::size_t k = 0; k < intervals.size(); ++k) {
            auto const measure = "consistency_" + std::to_string(intervals[k]);
            text << ' ' << figure_text(figure_of(runs, std::string(row.method), measure)) << " | "
                 << examples::detail::decimal(row.consistency[k]) << " |";
        }
        text << '\n';
    }
    return text.str();
}

/// Frame consistency against the interval, for the plot: measured, its standard error and the paper's figure.
std::string consistency_csv(std::vector<run_figures> const& runs) {
    std::ostringstream text;
    text << "method,interval,measured,standard_error,paper\n";
    for (auto const& row : paper_rows) {
        for (std::size_t k = 0; k < intervals.size(); ++k) {
            auto const figure = figure_of(runs, std::string(row.method), "consistency_" + std::to_string(intervals[k]));
            text << row.name << ',' << intervals[k] << ',' << (figure ? examples::detail::decimal(figure->mean, 6) : "")
                 << ',' << (figure && figure->error ? examples::detail::decimal(*figure->error, 6) : "") << ','
                 << examples::detail::decimal(row.consistency[k]) << '\n';
        }
    }
    return text.str();
}

std::string all_tables(options const& told, std::vector<run_figures> const& runs) {
    std::vector<table_column> const errors{{"error_1", "RMSE 1"},     {"error_5", "5"},   {"error_10", "10"},
                                           {"error_15", "15"},        {"error_20", "20"}, {"contrast", "Contrast"},
                                           {"sharpness", "Sharpness"}};
    std::vector<table_column> const object_errors{{"object_error_1", "RMSE 1"},
                                                  {"object_error_5", "5"},
                                                  {"object_error_10", "10"},
                                                  {"object_error_15", "15"},
                                                  {"object_error_20", "20"},
                                                  {"relative_object_error_1", "RMSE 1 / contrast"},
                                                  {"relative_object_error_10", "RMSE 10 / contrast"}};
    std::vector<table_column> const pairs{{"object_pairs_1", "Pairs 1"},
                                          {"object_pairs_5", "5"},
                                          {"object_pairs_10", "10"},
                                          {"object_pairs_15", "15"},
                                          {"object_pairs_20", "20"}};
    std::vector<table_column> const embedded{{"consistency_1", "Consistency 1"}, {"consistency_5", "5"},
                                             {"consistency_10", "10"},           {"consistency_20", "20"},
                                             {"fidelity", "Fidelity"},           {"recognition", "Recognised"}};
    std::vector<table_column> const flickers{{"background_flicker", "Background"},
                                             {"colour_flicker", "Mean colour"},
                                             {"deviation_flicker", "Colour deviation"}};
    std::vector<table_column> const differences{{"object_error_1", "RMSE 1, objects"},
                                                {"object_error_10", "RMSE 10, objects"},
                                                {"object_error_20", "RMSE 20, objects"},
                                                {"relative_object_error_10", "RMSE 10 / contrast"},
                                                {"consistency_1", "Consistency 1"},
                                                {"consistency_10", "Consistency 10"},
                                                {"fidelity", "Fidelity"},
                                                {"sharpness", "Sharpness"},
                                                {"colour_flicker", "Mean colour"}};
    auto all = told.groups;
    all.insert(all.begin(), "render");
    std::ostringstream text;
    text
        << "# Tables 1 and 2 of the paper\n\n"
        << told.scenes.size() << " scenes, " << told.prompts.size() << " prompts, " << told.seeds << " seeds, "
        << told.frames << " frames, " << told.steps
        << " steps; mean ± standard error over runs. The paper's figures are CLIP's, those measured here the reference "
           "embedder's.\n\n"
        << paper_tables(runs) << "\n# Correspondence error, all surfaces\n\n"
        << markdown_table(runs, all, errors) << "\n# Correspondence error, objects without the ground\n\n"
        << markdown_table(runs, all, object_errors) << "\nPairs of pixels behind each error of a run:\n\n"
        << scene_table(runs, pairs) << "\n# Frame consistency and prompt fidelity\n\n"
        << markdown_table(runs, all, embedded) << "\n# Flicker\n\n"
        << markdown_table(runs, all, flickers) << "\n# Ours against the others, paired runs\n\n"
        << difference_table(runs, "Ours, UV noise", told.groups, differences);
    return text.str();
}

void evaluate(options const& told) {
    threaded_loop const loop(told.threads);
    auto const embedder = reference_embedder<float>::from_folder(told.embedder);
    auto const methods = chosen_methods(told);
    std::vector<job> jobs;
    for (std::size_t prompt = 0; prompt < told.prompts.size(); ++prompt) {
        style_number(told.prompts[prompt]);
        for (std::uint64_t seed = 0; seed < told.seeds; ++seed) {
            jobs.push_back({prompt, seed, methods.size()});
            for (std::size_t method = 0; method < methods.size(); ++method) {
                jobs.push_back({prompt, seed, method});
            }
        }
    }
    make_folder(told.out);
    std::vector<run_figures> runs;
    for (auto const& scene_name : told.scenes) {
        auto const scene = make_evaluation_scene(scene_name, told.frames, {told.size, told.size}, loop);
        auto const outcomes = run_scene(told, scene, jobs, methods, embedder, loop);
        std::vector<std::string> labels;
        std::vector<tensor<float, 4> const*> shown;
        for (std::size_t j = 0; j < jobs.size(); ++j) {
            auto const is_render = jobs[j].method == methods.size();
            auto const label = is_render ? "Painted render" : label_of(methods[jobs[j].method]);
            runs.push_back({label, is_render ? "render" : methods[jobs[j].method].group, scene.name,
                            told.prompts[jobs[j].prompt], jobs[j].seed, outcomes[j].figures});
            if (is_shown(jobs[j])) {
                labels.push_back(label);
                shown.push_back(&outcomes[j].images);
            }
        }
        write_contact_sheet(told.out / (scene.name + ".png"), labels, shown);
        write_time_slices(told.out / (scene.name + "_over_time.png"), labels, shown, told.size * 5 / 8);
        // After every scene, so that a run that is stopped leaves what it has measured.
        write_text(told.out / "runs.csv", runs_csv(runs));
    }
    write_text(told.out / "tables.csv", means_csv(runs));
    write_text(told.out / "consistency.csv", consistency_csv(runs));
    auto const tables = all_tables(told, runs);
    write_text(told.out / "tables.md", tables);
    std::printf("\n%s", tables.c_str());
}

} // namespace

int main(int argc, char** argv) {
    options told;
    CLI::App app("Renders three scenes with every method, baseline and ablation of the paper, and measures them.");
    app.add_option("--out", told.out, "Folder of tables and pictures")->required();
    app.add_option("--weights", told.weights, "The denoiser, a folder in diffusers' layout");
    app.add_option("--embedder", told.embedder, "The image_text_embedder of train_embedder.py");
    app.add_option("--scenes", told.scenes, "Built-in scenes")->capture_default_str();
    auto const* const prompts = app.add_option("--prompts", told.prompts, "Styles")->capture_default_str();
    auto const* const seeds =
        app.add_option("--seeds", told.seeds, "Runs of each scene and prompt")->capture_default_str();
    app.add_option("--frames", told.frames, "Frames of an animation")->capture_default_str();
    auto const* const steps = app.add_option("--steps", told.steps, "Denoising steps")->capture_default_str();
    app.add_option("--keyframes", told.keyframes, "Keyframes of a step")->capture_default_str();
    app.add_option("--alpha", told.alpha, "Weight of the blended features (eq. 6)")->capture_default_str();
    app.add_option("--groups", told.groups, "Of method, noise, ablation and correspondence (texels of any resolution)")
        ->capture_default_str();
    app.add_option("--methods", told.methods, "Names as in the tables; all of the groups unless told");
    app.add_option("--size", told.size, "Height and width of the images")->capture_default_str();
    app.add_option("--threads", told.threads, "Threads; 0 = all of the machine")->capture_default_str();
    bool is_quick = false;
    app.add_flag("--quick", is_quick, "One prompt, one seed and fewer steps where not told: a look, no evidence");
    CLI11_PARSE(app, argc, argv);
    if (is_quick) {
        told.prompts.resize(prompts->count() > 0 ? told.prompts.size() : 1);
        told.seeds = seeds->count() > 0 ? told.seeds : 1;
        told.steps = steps->count() > 0 ? told.steps : 8;
    }
    try {
        evaluate(told);
    } catch (std::exception const& failure) {
        std::fprintf(stderr, "evaluate: %s\n", failure.what());
        return 1;
    }
    return 0;
}
