// SPDX-License-Identifier: MIT
// [GR alg. 1] The program that does it all: an animated scene in, a stylised animation out.
#include "support/guidance_source.hpp"
#include "support/progress_line.hpp"
#include "support/render_options.hpp"
#include "support/render_output.hpp"
#include "support/run_report.hpp"

#include <genrender/baselines/pix2video.hpp>
#include <genrender/baselines/tokenflow.hpp>
#include <genrender/models/reference_network.hpp>
#include <genrender/models/reference_weights.hpp>
#include <genrender/pipeline/render.hpp>

#include <algorithm>
#include <exception>
#include <iostream>
#include <optional>
#include <string>
#include <vector>

using namespace genrender;
using namespace genrender::examples;

namespace {

using network = reference_network<float, threaded_loop>;

/// The user's denoiser; here the reference network with the weights of a folder, or with random ones.
reference_weights<float> load_weights(render_options const& options) {
    auto weights = options.weights == "random" ? reference_weights<float>::seeded(options.seed)
                                               : reference_weights<float>::from_folder(options.weights);
    require_value(weights.config.in_channels == 12, "--weights", "channels of the latents", weights.config.in_channels,
                  "12, the Haar bands of a colour image: this program has no other decoder");
    return weights;
}

/// What `use` makes of the method that the options name.
template <class Use>
auto with_method(render_method method, Use const& use) {
    switch (method) {
    case render_method::pix2video: return use(pix2video{});
    case render_method::tokenflow: return use(tokenflow{});
    default: return use(generative_rendering{});
    }
}

void run(render_options const& options, guidance_source const& source, reference_weights<float>& weights,
         std::optional<earlier_run> const& earlier, threaded_loop const& loop, stopwatch const& total) {
    // The denoiser is told the prompt and the depth of the whole animation.
    auto const nearness = cell_means(sequence_inverse_depth(source.guidance.depth), source.image);
    network const phi(weights, weights.conditioning(to_view(nearness), options.prompt), loop);

    render_report report;
    auto const z = with_method(options.method, [&](auto const& method) {
        return render(method, phi, to_uv_view(source.guidance.uv), options.settings, report,
                      progress_line(options.is_quiet), loop);
    });

    auto const images = decoded(z);
    std::vector<rgb8_image> frames;
    for (std::size_t i = 0; i < images.shape()[0]; ++i) {
        frames.push_back(rgb_picture(to_view(images)[i]));
    }
    write_pictures(options.out, source.guidance, frames);
    auto json = report_of(options, source, report, images);
    json["seconds"] = seconds_of(report, total.seconds());
    write_text(options.out / "report.json", json.dump(2) + "\n");
    if (earlier) {
        write_comparison(options.out, *earlier, frames,
                         method_name(render_method_names[static_cast<std::size_t>(options.method)]));
    }
}

/// Prints a sentence and gives the exit code.
int fail(int code, std::exception const& error) {
    std::cerr << "generative_rendering: " << error.what() << "\n";
    return code;
}

} // namespace

int main(int argc, char** argv) {
    stopwatch const total;
    render_options options;
    guidance_source source;
    std::optional<earlier_run> earlier;
    std::optional<reference_weights<float>> weights;
    threaded_loop loop;
    // Everything that can be wrong with the arguments shows before the first step.
    try {
        options = parse_render_options(argc, argv);
        loop = threaded_loop(options.threads);
        weights = load_weights(options);
        if (weights->vocabulary) {
            prompt_rows(options.prompt, weights->vocabulary->words());
        }
        make_folder(options.out);
        source = load_guidance(options, loop);
        auto const frame_count = source.guidance.uv.frame_count();
        options.settings.keyframes.count = options.keyframes.value_or(std::min<std::size_t>(4, frame_count));
        require_render_settings(options.settings, frame_count);
        with_method(options.method, [&](auto const& method) { // which knows whether it draws keyframes
            return frames_to_denoise(options.settings, frame_count, method);
        });
        if (!options.beside.empty()) {
            earlier = load_earlier_run(options.beside, options.out, frame_count, source.image);
        }
        require_latent_grid(weights->config, {source.image.height / 2, source.image.width / 2});
    } catch (no_run const& none) {
        return none.exit_code;
    } catch (std::invalid_argument const& error) {
        return fail(2, error);
    } catch (std::exception const& error) {
        return fail(1, error);
    }
    for (auto const& note : source.notes) {
        std::cerr << "note: " << note << "\n";
    }
    try {
        run(options, source, *weights, earlier, loop, total);
    } catch (std::exception const& error) {
        return fail(1, error);
    }
    std::cout << "animation:     " << (options.out / "animation.webp").string() << "\n"
              << "contact sheet: " << (options.out / "contact_sheet.png").string() << "\n"
              << "report:        " << (options.out / "report.json").string() << "\n";
    return 0;
}
