// SPDX-License-Identifier: MIT
// [GR alg. 1] The program with any model, compiled once: an animated scene in, a stylised animation out.
#include "program.hpp"

#include "checkpoint_file.hpp"
#include "guidance_source.hpp"
#include "interruption.hpp"
#include "npy_file.hpp"
#include "output_file.hpp"
#include "plan_output.hpp"
#include "preflight_output.hpp"
#include "progress_line.hpp"
#include "render_options.hpp"
#include "render_output.hpp"
#include "resident_memory.hpp"
#include "run_report.hpp"

#include <genrender/baselines/pix2video.hpp>
#include <genrender/baselines/tokenflow.hpp>
#include <genrender/core/fingerprint.hpp>
#include <genrender/pipeline/render.hpp>
#include <genrender/version.hpp>

#include <algorithm>
#include <exception>
#include <filesystem>
#include <functional>
#include <iostream>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace genrender::examples {

namespace {

/// What `use` makes of the method that the options name.
template <class Use>
auto with_method(render_method method, Use const& use) {
    switch (method) {
    case render_method::pix2video:
        return use(pix2video{});
    case render_method::tokenflow:
        return use(tokenflow{});
    default:
        return use(generative_rendering{});
    }
}

/// What `use` makes of the maps that name surface points as the options say.
template <class Use>
auto with_canonical_maps(render_options const& options, guidance_source const& source, Use const& use) {
    return options.correspondence.coordinates() == canonical_coordinates::position
               ? use(to_position_view(source.guidance))
               : use(to_uv_view(source.guidance.uv));
}

/// Frames as pictures.
std::vector<rgb8_image> pictures_of(tensor<float, 4> const& images) {
    std::vector<rgb8_image> frames;
    for (std::size_t i = 0; i < images.shape()[0]; ++i) {
        frames.push_back(rgb_picture(to_view(images)[i]));
    }
    return frames;
}

/// What tells the denoiser of a run from others: the model with its prompt, and the depth.
std::string key_of(guidance_source const& source, picture_model const& model) {
    fingerprint depth;
    auto const& maps = source.guidance.depth;
    for (std::size_t p = 0; p < maps.depth.size(); ++p) {
        auto const is_covered = maps.coverage.data()[p] != 0;
        depth.add(is_covered ? maps.depth.data()[p] : -1.0F);
    }
    return model.key() + " " + extents_text({source.image.height, source.image.width}) + " " +
           std::to_string(depth.value()) + " " GENRENDER_VERSION_STRING;
}

/// What is written after steps of a run. A disk that has no room is said once; the run goes on, and so does the
/// checkpoint that there is.
class kept_steps {
public:
    kept_steps(render_options const& options, picture_model const& model, any_loop loop)
        : options_(&options), model_(&model), loop_(std::move(loop)), file_(options.out) {
        for (auto const& folder : {options.out, options.out / "frames", options.out / "maps"}) {
            remove_left_parts(folder);
        }
    }

    /// Told of every step that is done.
    void operator()(finished_step<float> const& step) {
        try {
            file_.write(step.make_checkpoint());
            if (options_->preview > 0 && (step.number() + 1) % options_->preview == 0) {
                write_preview(options_->out, pictures_of(model_->pictures(step.estimates(), loop_)));
            }
        } catch (file_error const& error) {
            if (!has_warned_) {
                std::cerr << "\nnote: " << error.what() << "\n";
            }
            has_warned_ = true;
        }
    }
    /// What it costs to keep them.
    checkpoint_file const& file() const { return file_; }

private:
    render_options const* options_;
    picture_model const* model_;
    any_loop loop_;
    checkpoint_file file_;
    bool has_warned_ = false;
};

/// A run of --resume that does not fit what there is.
struct wrong_checkpoint : std::invalid_argument {
    using std::invalid_argument::invalid_argument;
};

/// Renders and writes all that is told, but for a run that Ctrl-C ends. The exit code; `again` is the command that goes
/// on.
int run(render_options const& options, guidance_source const& source, picture_model& model,
        std::optional<earlier_run> const& earlier, std::optional<checkpoint<float>> const& from,
        threaded_loop const& loop, stopwatch const& total, std::string const& again) {
    // The denoiser is told the prompt and the depth of the whole animation.
    auto const phi = model.network(source.guidance, source.image, loop);
    kept_steps kept(options, model, loop);
    auto const key = key_of(source, model);

    render_result<float> result;
    bool has_begun = false;
    auto const show = progress_line(options.is_quiet);
    auto const observer = [&](progress const& now) {
        has_begun = true;
        return show(now);
    };
    auto const grown = resident_growth([&] {
        result = with_canonical_maps(options, source, [&](auto const& maps) {
            return with_method(options.method, [&](auto const& method) {
                try {
                    return render<std::remove_cvref_t<decltype(method)>>(phi, maps,
                                                                         {.settings = options.settings,
                                                                          .method = method,
                                                                          .observer = observer,
                                                                          .loop = loop,
                                                                          .after_step = std::ref(kept),
                                                                          .resume = from ? &*from : nullptr,
                                                                          .model_key = key});
                } catch (std::invalid_argument const& error) {
                    if (from && !has_begun) {
                        throw wrong_checkpoint("--resume with " + kept.file().path().string() + ": " + error.what());
                    }
                    throw;
                }
            });
        });
    });
    auto const words = "interrupted: " + (from || kept.file().bytes() > 0
                                              ? kept.file().path().string() +
                                                    " has all steps that are done; go on with\n    " + again + "\n"
                                              : "no step was done, so that there is nothing to go on from\n");
    if (result.is_cancelled || was_interrupted()) {
        std::cerr << "\n" << words;
        return interrupted_code;
    }

    if (options.keeps_latents) {
        write_npy(options.out / "latents.npy", to_view(std::as_const(result.z)));
    }
    leave_when_interrupted("\n" + words);
    auto const images = model.pictures(result.z, loop);
    note_interruptions(); // Files that are begun are ended.
    auto const frames = pictures_of(images);
    write_pictures(options.out, source.guidance, frames);
    auto json = report_of(options, source, result.report, images);
    json["render_resident_bytes"] = grown ? nlohmann::ordered_json(*grown) : nlohmann::ordered_json(nullptr);
    json["seconds"] = seconds_of(result.report, total.seconds());
    json["checkpoint"] = {{"bytes", kept.file().bytes()}, {"seconds", kept.file().seconds()}};
    write_text(options.out / "report.json", json.dump(2) + "\n");
    if (earlier) {
        write_comparison(options.out, *earlier, frames, method_name(name_in(method_names, options.method)));
    }
    kept.file().remove();
    return 0;
}

/// Tells what a run will take. The exit code.
int plan(render_options const& options, guidance_source const& source, picture_model& model,
         threaded_loop const& loop) {
    std::optional<any_denoiser<float>> phi;
    auto const weights = resident_growth([&] { phi.emplace(model.network(source.guidance, source.image, loop)); });
    auto timed = with_canonical_maps(
        options, source, [&](auto const& maps) { return plan_run(*phi, maps, options.settings, loop.threads()); });
    timed.weights_bytes = weights;
    timed.decoding = time_decoding(*phi, [&](latents<float> const& z) { return model.pictures(z, loop); });
    write_plan(options.out, timed);
    std::cout << plan_text(timed);
    return 0;
}

/// The options that help with what a check finds.
std::string advice(recommendation const& one) {
    switch (one.kind) {
    case recommendation_kind::mirrored:
    case recommendation_kind::overlapping:
    case recommendation_kind::tiled:
    case recommendation_kind::degenerate:
    case recommendation_kind::many_seams:
        return sentence_of(one) + " (--canonical position)";
    case recommendation_kind::texture_too_fine:
    case recommendation_kind::texture_too_coarse:
        return sentence_of(one) + " (--correspondence footprint)";
    case recommendation_kind::low_coverage:
        return sentence_of(one) + " (--keyframes)";
    default:
        return sentence_of(one);
    }
}

/// Tells what the maps are good for, at the feature resolutions of the network's injected layers. The exit code.
int check(render_options const& options, guidance_source const& source, picture_model& model,
          threaded_loop const& loop) {
    auto const phi = model.network(source.guidance, source.image, loop); // asked for its layers only
    std::vector<grid_extents> grids;
    for (auto const& site : phi.sites()) {
        if (options.settings.layers(site, 0) && std::find(grids.begin(), grids.end(), site.grid) == grids.end()) {
            grids.push_back(site.grid);
        }
    }
    auto const report = with_canonical_maps(options, source, [&](auto const& maps) {
        return write_preflight(options.out, maps, grids, options.settings, loop, advice);
    });
    std::cout << text_of(report, advice) << "picture: " << (options.out / "preflight.png").string() << "\n";
    return report.allows_run() ? 0 : 1;
}

/// Throws value_error unless the network can halve its latents as often as it does.
void require_pixels(grid_extents image, std::size_t factor) {
    auto const expected = "a multiple of " + std::to_string(factor) + " for this model";
    require_value(image.height % factor == 0, "--size", "height", image.height, expected.c_str());
    require_value(image.width % factor == 0, "--width", "width", image.width, expected.c_str());
}

/// Prints a sentence and gives the exit code.
int fail(std::string const& program, int code, std::exception const& error) {
    std::cerr << program << ": " << error.what() << "\n";
    return code;
}

} // namespace

int run_program(int argc, char const* const* argv, program_kind kind, make_model const& make) {
    auto const program = std::filesystem::path(argv[0]).filename().string();
    stopwatch const total;
    render_options options;
    guidance_source source;
    std::optional<earlier_run> earlier;
    std::optional<checkpoint<float>> from;
    std::unique_ptr<picture_model> model;
    threaded_loop loop;
    // Everything that can be wrong with the arguments shows before the first step.
    try {
        options = parse_render_options(argc, argv, kind);
        if (options.resumes) {
            from = checkpoint_file(options.out).read();
        }
        loop = threaded_loop(options.threads);
        force_vector_target(options.vectors);
        model = make(options);
        auto const notes = model->notes();
        options.settings.sigma_min = model->sigma_min();
        options.settings.sigma_max = model->sigma_max();
        if (model->is_of_one_size()) {
            options.width = model->usual_size().width;
        }
        options.size = options.size > 0 ? options.size : model->usual_size().height;
        make_folder(options.out);
        source = load_guidance(options, model->scale(), loop);
        source.notes.insert(source.notes.begin(), notes.begin(), notes.end());
        auto const frame_count = source.guidance.uv.frame_count();
        options.settings.keyframes.count = options.keyframes.value_or(std::min<std::size_t>(4, frame_count));
        options.settings.noise.rays = source.rays;
        require_pixels(source.image, model->scale() * model->grid_divisor());
        if (options.is_check) {
            return check(options, source, *model, loop);
        }
        require_render_settings(options.settings, frame_count);
        with_method(options.method, [&](auto const& method) { // which knows whether it draws keyframes
            return frames_to_denoise(options.settings, frame_count, method);
        });
        if (options.is_plan) {
            return plan(options, source, *model, loop);
        }
        if (!options.beside.empty()) {
            earlier = load_earlier_run(options.beside, options.out, frame_count, source.image);
        }
    } catch (no_run const& none) {
        return none.exit_code;
    } catch (std::invalid_argument const& error) {
        return fail(program, 2, error);
    } catch (std::exception const& error) {
        return fail(program, 1, error);
    }
    if (checkpoint_file const left(options.out); left.exists() && !options.resumes) {
        source.notes.push_back(left.path().string() +
                               " is of a run that was interrupted and is replaced after the first step: --resume "
                               "would go on with it");
    }
    for (auto const& note : source.notes) {
        std::cerr << "note: " << note << "\n";
    }
    try {
        auto const again = command_text(argc, argv, "--resume");
        if (auto const code = run(options, source, *model, earlier, from, loop, total, again); code != 0) {
            return code;
        }
    } catch (wrong_checkpoint const& error) {
        return fail(program, 2, error);
    } catch (std::exception const& error) {
        return fail(program, 1, error);
    }
    std::cout << "animation:     " << (options.out / "animation.webp").string() << "\n"
              << "contact sheet: " << (options.out / "contact_sheet.png").string() << "\n"
              << "report:        " << (options.out / "report.json").string() << "\n";
    return 0;
}

} // namespace genrender::examples
