// SPDX-License-Identifier: MIT
// [GR sec. 4] The paper's comparison on the miniature Stable Diffusion, with true correspondences: tables and pictures.
#include "caption.hpp"
#include "evaluation_scene.hpp"
#include "measures.hpp"
#include "methods.hpp"
#include "results.hpp"
#include "run_pictures.hpp"
#include "run_store.hpp"
#include "settings_text.hpp"
#include "studies.hpp"
#include "tables.hpp"

#include <examples/support/output_file.hpp>
#include <examples/support/resident_memory.hpp>

#include <genrender/core/error.hpp>
#include <genrender/core/parallel.hpp>
#include <genrender/reference/pipeline_files.hpp>
#include <genrender/reference/reference_clip.hpp>
#include <genrender/reference/stable_diffusion.hpp>
#include <genrender/version.hpp>

#include <CLI/CLI.hpp>

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <iterator>
#include <map>
#include <mutex>
#include <optional>
#include <sstream>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

using namespace genrender;
using namespace genrender::reference;
using namespace genrender::examples;

namespace {

using network = reference_network<float>;

constexpr grid_extents image_grid{128, 128}; // what denoiser and embedder were trained on

struct options {
    std::filesystem::path out;
    std::filesystem::path pipeline = GENRENDER_MINIATURE "/weights";
    std::filesystem::path embedder = GENRENDER_MINIATURE "/embedder";
    double guidance = 3;
    std::size_t threads = 0;
    bool is_quick = false, is_full = false, is_development = false, is_long = false, only_lists = false;
    std::vector<std::string> studies, rows, scenes;
    std::optional<std::size_t> captions, seeds, frames, steps;
};

/// The studies that the options ask for.
std::vector<study> chosen_studies(options const& told) {
    auto chosen = told.is_quick         ? quick_studies()
                  : told.is_full        ? full_studies()
                  : told.is_development ? development_studies()
                  : told.is_long        ? long_studies()
                                        : usual_studies();
    auto const is_among = [](std::string const& name, std::vector<std::string> const& names) {
        return names.empty() || std::find(names.begin(), names.end(), name) != names.end();
    };
    std::erase_if(chosen, [&](auto const& each) { return !is_among(each.name, told.studies); });
    require_value(!chosen.empty(), "evaluate", "--studies", told.studies.empty() ? "" : told.studies.front(),
                  "names as --list tells");
    for (auto& each : chosen) {
        std::vector<std::string> rows;
        for (auto const& row : rows_of(each)) {
            if (is_among(row.name, told.rows)) {
                rows.push_back(row.name);
            }
        }
        require_value(!rows.empty(), "evaluate", "--rows", told.rows.empty() ? "" : told.rows.front(),
                      ("rows of the study " + each.name + ", as --list tells").c_str());
        each.rows = std::move(rows);
        each.groups.clear();
        each.scenes = told.scenes.empty() ? each.scenes : told.scenes;
        for (auto const& scene : each.scenes) {
            auto const names = scene_names(each.set);
            require_value(is_among(scene, names), "evaluate", "--scenes", scene,
                          ("a scene of the set, say " + names.front()).c_str());
        }
        each.captions = told.captions.value_or(each.captions);
        require_value(each.captions > 0 && each.captions <= captions_of(each.set).size(), "evaluate", "--captions",
                      each.captions, "1 to 4");
        each.seeds = told.seeds.value_or(each.seeds);
        each.frames = told.frames.value_or(each.frames);
        each.steps = told.steps.value_or(each.steps);
    }
    return chosen;
}

/// The seed of noise, keyframes and paint of a set's run. Training draws scenes by 1 and 2.
std::uint64_t seed_of(scene_set set, std::uint64_t number) {
    return (set == scene_set::development ? 2000 : 1000) + number;
}

/// Networks, measures and what is kept: what all studies share.
class comparison {
public:
    explicit comparison(options const& told)
        : told_(told), loop_(told.threads), pipeline_(pipeline_files(told.pipeline)),
          embedder_(reference_clip<float>::from_folder(told.embedder)), store_(told.out / "runs") {
        auto const nearness = tensor<float, 3>::from_shape({1, image_grid.height, image_grid.width});
        auto const phi =
            pipeline_.network(pipeline_.conditioning(to_view(nearness), {.text = "", .guidance_scale = told.guidance}));
        sites_.assign(phi.sites().begin(), phi.sites().end());
        branches_ = static_cast<std::uint32_t>(phi.branches());
        networks_key_ = "library = " GENRENDER_VERSION_STRING "\nmeasures = " + std::to_string(measures_version) +
                        "\npipeline = " + digest_of(told.pipeline) + "\nembedder = " + digest_of(told.embedder) +
                        "\nguidance = " + std::to_string(told.guidance) + '\n';
    }

    /// Makes what is not kept of a study, and writes its tables and pictures.
    void run(study const& of) {
        make_missing(of);
        auto const rows = rows_of(of);
        std::vector<run_figures> figures;
        auto const scenes = scenes_of(of);
        std::map<std::string, std::vector<shown_run>> shown;
        std::map<std::size_t, std::size_t> first_caption; // of a scene
        for (auto const& planned : runs_of(of)) {
            auto const is_painted = planned.row == rows.size();
            auto const row = is_painted ? painted_row() : rows[planned.row];
            auto const key = key_of(of, planned, row);
            auto kept = store_.find(key);
            if (!kept) {
                throw file_error("evaluate: a run of " + row.name + " is not kept, expected what was just made");
            }
            auto const& scene = scenes[planned.scene];
            figures.push_back({row.name, row.group, scene,
                               text_of(captions_of(of.set)[planned.caption], subject_of(scene, of.set)), planned.seed,
                               std::move(kept->figures)});
            auto const is_first = first_caption.try_emplace(planned.scene, planned.caption).first->second;
            if (planned.seed == 0 && planned.caption == is_first) {
                shown[scene].push_back({row.name, store_.frames(key, of.frames).value()});
            }
        }
        for (auto const& [scene, runs] : shown) {
            write_moments(told_.out / (of.name + "_" + scene + ".png"), runs);
            write_time_slices(told_.out / (of.name + "_" + scene + "_over_time.png"), runs, image_grid.height * 5 / 8,
                              std::max<std::size_t>(1, 64 / of.frames));
        }
        write_text(told_.out / (of.name + "_runs.csv"), runs_csv(figures));
        write_text(told_.out / (of.name + ".csv"), means_csv(figures));
        if (of.name == methods_study().name) {
            write_text(told_.out / "consistency.csv", consistency_csv(figures));
        }
        auto const tables = study_tables(of, figures);
        write_text(told_.out / (of.name + ".md"), tables);
        std::printf("\n%s", tables.c_str());
    }

    /// Says what a study has, and how much of it is kept.
    void list(study const& of) const {
        auto const rows = rows_of(of);
        auto const runs = runs_of(of);
        std::size_t kept = 0;
        for (auto const& planned : runs) {
            kept += is_kept(of, planned, rows) ? 1U : 0U;
        }
        std::printf("%s: %zu runs of %zu frames and %zu steps, %zu of them kept\n", of.name.c_str(), runs.size(),
                    of.frames, of.steps, kept);
        for (auto const& scene : scenes_of(of)) {
            std::printf("  scene \"%s\"\n", scene.c_str());
        }
        for (auto const& row : rows) {
            std::printf("  row \"%s\"\n", row.name.c_str());
        }
    }

    /// The most resident memory that the program has held, bytes; 0 where the system does not tell.
    std::int64_t peak() {
        note_peak();
        return peak_;
    }

private:
    /// Asked for before the system's own mark is lowered (resident_growth).
    void note_peak() {
        std::lock_guard const lock(peak_mutex_);
        peak_ = std::max(peak_, memory_status("VmHWM").value_or(0));
    }

    row_settings settings_of_run(study const& of, planned_run const& planned, compared_row const& row) const {
        auto const schedule = pipeline_.schedule();
        return settings_of(row, {.steps = of.steps,
                                 .keyframes = std::min<std::size_t>(4, of.frames),
                                 .sigma_min = static_cast<float>(schedule.sigma_min()),
                                 .sigma_max = static_cast<float>(schedule.sigma_max()),
                                 .seed = seed_of(of.set, planned.seed)});
    }

    /// All that a run's figures depend on.
    std::string key_of(study const& of, planned_run const& planned, compared_row const& row) const {
        auto const caption = captions_of(of.set)[planned.caption];
        auto const scene = scenes_of(of)[planned.scene];
        std::ostringstream key;
        key << networks_key_ << "scene = " << scene << (of.set == scene_set::development ? ", development" : "")
            << "\nframes = " << of.frames << "\nmaps = " << of.map_pixels << "\nis_alone = " << of.is_alone
            << "\nintervals =";
        for (auto const interval : of.apart) {
            key << ' ' << interval;
        }
        key << "\nprompt = " << text_of(caption, subject_of(scene, of.set)) << "\nmethod = " << int(row.method) << '\n';
        if (row.method == row_method::painted) {
            key << "seed = " << seed_of(of.set, planned.seed) << '\n';
        } else {
            key << settings_text(settings_of_run(of, planned, row), sites_, branches_);
        }
        return key.str();
    }

    bool is_kept(study const& of, planned_run const& planned, std::vector<compared_row> const& rows) const {
        auto const key = key_of(of, planned, planned.row == rows.size() ? painted_row() : rows[planned.row]);
        return store_.find(key) && (planned.seed > 0 || store_.frames(key, of.frames));
    }

    void make_missing(study const& of) {
        auto const rows = rows_of(of);
        std::vector<planned_run> missing;
        for (auto const& planned : runs_of(of)) {
            if (!is_kept(of, planned, rows)) {
                missing.push_back(planned);
            }
        }
        std::size_t done = 0;
        auto const start = std::chrono::steady_clock::now();
        auto const names = scenes_of(of);
        for (std::size_t s = 0; s < names.size(); ++s) {
            std::vector<planned_run> here;
            std::copy_if(missing.begin(), missing.end(), std::back_inserter(here),
                         [s](auto const& planned) { return planned.scene == s; });
            if (here.empty()) {
                continue;
            }
            auto const scene = make_evaluation_scene(names[s], of.set, of.frames, image_grid, loop_, of.map_pixels);
            // Runs side by side take one thread each.
            auto const inner = of.is_alone ? any_loop(loop_) : any_loop(sequential_loop{});
            std::map<std::size_t, network> networks;
            for (auto const& planned : here) {
                if (planned.row < rows.size() && !networks.contains(planned.caption)) {
                    networks.emplace(planned.caption, network_for(scene, planned.caption, inner));
                }
            }
            std::mutex mutex;
            auto const make = [&](std::size_t j) {
                auto const& planned = here[j];
                auto const row = planned.row == rows.size() ? painted_row() : rows[planned.row];
                auto const* const phi = row.method == row_method::painted ? nullptr : &networks.at(planned.caption);
                make_run(of, planned, row, scene, phi, inner);
                std::lock_guard const lock(mutex);
                ++done;
                auto const seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
                auto const a_run = seconds / static_cast<double>(done);
                std::printf("\r%s, %s: %zu of %zu, %.1f s a run, %.0f minutes left   ", of.name.c_str(),
                            scene.name.c_str(), done, missing.size(), a_run,
                            a_run * static_cast<double>(missing.size() - done) / 60);
                std::fflush(stdout);
            };
            if (of.is_alone) {
                for (std::size_t j = 0; j < here.size(); ++j) {
                    make(j);
                }
            } else {
                loop_(here.size(), make);
            }
        }
        std::printf("\n");
    }

    network network_for(evaluation_scene const& scene, std::size_t caption, any_loop const& loop) const {
        return pipeline_.network(
            pipeline_.conditioning(
                to_view(scene.inverse_depth),
                {.text = text_of(captions_of(scene.set)[caption], scene.subject), .guidance_scale = told_.guidance},
                loop),
            loop);
    }

    void make_run(study const& of, planned_run const& planned, compared_row const& row, evaluation_scene const& scene,
                  network const* phi, any_loop const& loop) {
        auto const caption = captions_of(of.set)[planned.caption];
        kept_run made;
        auto images = tensor<float, 4>::from_shape({0, 3, 1, 1});
        std::optional<std::int64_t> grown;
        if (row.method == row_method::painted) {
            images = painted_frames(scene, caption, seed_of(of.set, planned.seed), loop);
        } else {
            auto settings = settings_of_run(of, planned, row);
            settings.noise.rays = scene.rays;
            auto const start = std::chrono::steady_clock::now();
            auto z = latents<float>();
            auto const render_frames = [&] { z = rendered(row.method, *phi, scene, settings, loop); };
            if (of.is_alone) {
                note_peak();
                grown = resident_growth(render_frames);
            } else {
                render_frames();
            }
            made.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
            auto const pictures = pipeline_.pictures(to_view(std::as_const(z)), loop);
            auto const [frames, channels, height, width] = pictures.extents();
            images = tensor<float, 4>::from_shape({frames, channels, height, width});
            copy(to_view(images), pictures.view());
        }
        made.figures = measures_of(to_view(std::as_const(images)), scene, caption, embedder_, of.apart);
        if (row.method != row_method::painted) {
            made.figures["seconds_a_frame"] = made.seconds / static_cast<double>(of.frames);
        }
        if (grown) {
            auto const pixels = scene.guidance.uv.grid().size() * of.frames;
            made.figures["megabytes"] = static_cast<double>(*grown) / 1e6;
            made.figures["map_megabytes"] = static_cast<double>(18 * pixels) / 1e6;
        }
        auto const key = key_of(of, planned, row);
        if (planned.seed == 0) {
            store_.keep_frames(key, to_view(std::as_const(images)));
        }
        store_.keep(key, made);
    }

    static latents<float> rendered(row_method method, network const& phi, evaluation_scene const& scene,
                                   row_settings const& settings, any_loop const& loop) {
        auto const with = [&](auto const& chosen) {
            return render<std::remove_cvref_t<decltype(chosen)>>(phi, scene.uv(),
                                                                 {.settings = settings, .method = chosen, .loop = loop})
                .z;
        };
        return method == row_method::pix2video   ? with(pix2video{})
               : method == row_method::tokenflow ? with(tokenflow{})
                                                 : with(generative_rendering{});
    }

    options told_;
    threaded_loop loop_;
    stable_diffusion<float> pipeline_;
    reference_clip<float> embedder_;
    run_store store_;
    std::vector<attention_site> sites_;
    std::uint32_t branches_ = 1;
    std::string networks_key_;
    std::mutex peak_mutex_;
    std::int64_t peak_ = 0;
};

void evaluate(options const& told) {
    auto const studies = chosen_studies(told);
    make_folder(told.out);
    comparison compared(told);
    for (auto const& each : studies) {
        told.only_lists ? compared.list(each) : compared.run(each);
    }
    if (auto const peak = compared.peak(); peak > 0) {
        std::printf("\nPeak memory: %.0f MB\n", static_cast<double>(peak) / 1e6);
    }
}

} // namespace

int main(int argc, char** argv) {
    options told;
    CLI::App app(
        "Renders scenes with every method, baseline and ablation, and measures them. What was made is kept in\n"
        "OUT/runs and not made again as long as all that it depends on stays the same.");
    app.add_option("--out", told.out, "Folder of tables, pictures and kept runs")->required();
    auto* const what = app.add_option_group("What", "methods and ablations unless told");
    what->add_flag("--quick", told.is_quick, "A look in minutes: fewer runs, frames and steps; no evidence");
    what->add_flag("--full", told.is_full, "Three seeds, all noises and texels, 48 frames and 50 steps once; hours");
    what->add_flag("--development", told.is_development,
                   "Variants of vivid on scenes, captions and seeds that settings may be chosen by");
    what->add_flag("--long", told.is_long, "240 frames of one scene, and what memory they take");
    what->require_option(0, 1);
    app.add_flag("--list", told.only_lists, "Say what would be made and how much of it is kept, and make nothing");
    app.add_option("--studies", told.studies, "Only these, by the names that --list tells");
    app.add_option("--rows", told.rows, "Only these, by the names that --list tells");
    app.add_option("--scenes", told.scenes, "Only these, by the names that --list tells");
    app.add_option("--captions", told.captions, "The first so many");
    app.add_option("--seeds", told.seeds, "Runs of each scene and caption")->check(CLI::PositiveNumber);
    app.add_option("--frames", told.frames, "Frames of an animation")->check(CLI::PositiveNumber);
    app.add_option("--steps", told.steps, "Denoising steps")->check(CLI::PositiveNumber);
    app.add_option("--pipeline", told.pipeline, "The denoiser, a folder in diffusers' layout")->capture_default_str();
    app.add_option("--embedder", told.embedder, "The embedder, a folder of train_embedder.py")->capture_default_str();
    app.add_option("--guidance", told.guidance, "Scale of classifier-free guidance")->capture_default_str();
    app.add_option("--threads", told.threads, "Threads; 0 = all of the machine")->capture_default_str();
    CLI11_PARSE(app, argc, argv);
    try {
        evaluate(told);
    } catch (std::exception const& failure) {
        std::fprintf(stderr, "%s\n", failure.what());
        return 1;
    }
    return 0;
}
