// SPDX-License-Identifier: MIT
// [GR alg. 1] The program with any model, compiled once: an animated scene in, a stylised animation out.
#include "program.hpp"

#include "checkpoint_file.hpp"
#include "guidance_source.hpp"
#include "interruption.hpp"
#include "kept_steps.hpp"
#include "npy_file.hpp"
#include "plan_output.hpp"
#include "preflight_output.hpp"
#include "progress_line.hpp"
#include "render_options.hpp"
#include "render_output.hpp"
#include "resident_memory.hpp"
#include "run_report.hpp"
#include "video_file.hpp"

#include <genrender/baselines/pix2video.hpp>
#include <genrender/baselines/tokenflow.hpp>
#include <genrender/pipeline/render.hpp>

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

/// A run of --resume that does not fit what there is.
struct wrong_checkpoint : std::invalid_argument {
    using std::invalid_argument::invalid_argument;
};

/// Renders, from a checkpoint where there is one, and writes everything but the last lines. Cuts the maps of `source` to
/// what is shown. The exit code; `again` is the command that goes on after Ctrl-C.
int run(render_options const& options, guidance_source& source, picture_model& model,
        std::optional<earlier_run> const& earlier, std::optional<checkpoint<float>> const& from,
        threaded_loop const& loop, stopwatch const& total, std::string const& again) {
    // The denoiser is told the prompt and the depth of the whole animation.
    auto const phi = model.network(source.guidance, source.extents.rendered, loop);
    kept_steps kept(options, model, source.extents.shown, loop);
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
    auto const last_words = kept.last_words(from.has_value(), again);
    if (result.is_cancelled || was_interrupted()) {
        std::cerr << "\n" << last_words;
        return interrupted_code;
    }

    if (options.keeps_latents) {
        write_npy(options.out / "latents.npy", to_view(std::as_const(result.z)));
    }
    leave_when_interrupted("\n" + last_words);
    auto const images = with_extents(model.pictures(result.z, loop), source.extents.shown);
    note_interruptions(); // Files that are begun are ended.
    source.guidance = with_extents(std::move(source.guidance), source.extents.shown_maps());
    write_frames(options.out / "frames", images, options.has_alpha ? &source.guidance.uv.coverage : nullptr,
                 options.format);
    auto const frames = pictures_of(images);
    write_pictures(options.out, source.guidance, frames, source.frames_per_second);
    auto const video = options.out / "animation.mp4";
    if (auto const ffmpeg = program_on_path("ffmpeg")) {
        write_mp4(*ffmpeg, video, frames, source.frames_per_second);
    } else {
        std::filesystem::remove(video); // of an earlier run
    }
    auto json = report_of(options, source, result.report, images);
    json["render_resident_bytes"] = grown ? nlohmann::ordered_json(*grown) : nlohmann::ordered_json(nullptr);
    json["seconds"] = seconds_of(result.report, total.seconds());
    json["checkpoint"] = {{"bytes", kept.file().bytes()}, {"seconds", kept.file().seconds()}};
    write_text(options.out / "report.json", json.dump(2) + "\n");
    if (earlier) {
        write_comparison(options.out, *earlier, frames, method_name(name_in(method_names, options.method)),
                         source.frames_per_second);
    }
    kept.file().remove();
    return 0;
}

/// Tells what a run will take. The exit code.
int plan(render_options const& options, guidance_source const& source, picture_model& model,
         threaded_loop const& loop) {
    std::optional<any_denoiser<float>> phi;
    auto const weights =
        resident_growth([&] { phi.emplace(model.network(source.guidance, source.extents.rendered, loop)); });
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
    auto const phi = model.network(source.guidance, source.extents.rendered, loop); // asked for its layers only
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
        source = load_guidance(options, model->scale(), model->scale() * model->grid_divisor(), loop);
        source.notes.insert(source.notes.begin(), notes.begin(), notes.end());
        for (auto const& note : source.notes) {
            std::cerr << "note: " << note << "\n";
        }
        auto const frame_count = source.guidance.uv.frame_count();
        options.settings.keyframes.count = options.keyframes.value_or(std::min<std::size_t>(4, frame_count));
        options.settings.noise.rays = source.rays;
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
            earlier = load_earlier_run(options.beside, options.out, frame_count, source.extents.shown);
        }
    } catch (no_run const& none) {
        return none.exit_code;
    } catch (std::invalid_argument const& error) {
        return fail(program, 2, error);
    } catch (std::exception const& error) {
        return fail(program, 1, error);
    }
    if (from && !options.is_quiet) {
        std::cerr << "note: goes on after step " << from->steps << " of " << options.settings.steps << "\n";
    }
    if (checkpoint_file const left(options.out); left.exists() && !options.resumes) {
        std::cerr << "note: " << left.path().string()
                  << " is of a run that was interrupted and is replaced after the first step: --resume would go on "
                     "with it\n";
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
              << (std::filesystem::exists(options.out / "animation.mp4")
                      ? "video:         " + (options.out / "animation.mp4").string() + "\n"
                      : "video:         none, as ffmpeg is not on the PATH\n")
              << "contact sheet: " << (options.out / "contact_sheet.png").string() << "\n"
              << "report:        " << (options.out / "report.json").string() << "\n";
    return 0;
}

} // namespace genrender::examples
