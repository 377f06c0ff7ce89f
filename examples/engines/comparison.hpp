// SPDX-License-Identifier: MIT
// One run for engines of every kind: the miniature's folder, maps and settings, and the row of the table that an engine's
// frames make beside those of the library's own network.
#pragma once

#include <genrender/core/tensor.hpp>
#include <genrender/maps/uv_maps.hpp>
#include <genrender/pipeline/render.hpp>
#include <genrender/pipeline/render_settings.hpp>
#include <genrender/reference/network_conditioning.hpp>
#include <genrender/reference/unet_config.hpp>

#include <cstddef>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace genrender::examples {

/// A tensor of a file, row-major.
struct named_tensor {
    std::vector<std::size_t> shape;
    std::vector<float> values;
};

using named_tensors = std::map<std::string, named_tensor>; ///< of a file

/// What a run is given: the folder, the architecture and all tensors of UNet and ControlNet, encoded prompts and the hint
/// of every frame, maps and settings.
struct engine_case {
    std::filesystem::path folder;
    reference::unet_config config;
    named_tensors unet;
    named_tensors controlnet;
    reference::network_conditioning<float> conditioning;
    uv_maps UV;
    render_settings<float> settings = render_settings<float>::plain(); ///< what Python's clients have, too
};

/// A camera that goes around a still life in 8 frames, in pictures of `size` pixels a side, with the prompts as the
/// folder's text encoder encodes them. Throws file_error where the folder is not as it should be.
engine_case case_of_size(std::size_t size);

/// What an engine's run gave.
struct engine_frames {
    latents<float> z;
    render_report report;
    double seconds = 0; ///< of the processor's time
};

/// Renders the cases of 64 and of 128 pixels by `run` and by the library's own network, both told the same, on one thread, and
/// prints the line
///
///     engine | way in | - | - | greatest difference | run s against the reference network | library outside the denoiser
///
/// where `-` are lines and seconds of compiling, which table.cmake knows, and run s are of the processor's time. The
/// difference is a share of the range of the reference's latents, the greatest of both sizes. Returns 0; 1 if it is above
/// `bound`, if an engine without injection would pass too, or with a sentence if something throws.
int compare_frames(std::string_view engine, std::string_view way_in, double bound,
                   std::function<engine_frames(engine_case const&)> const& run);

/// The same for an engine in this program, whose seconds are measured here.
int compare_engine(std::string_view engine, std::string_view way_in, double bound,
                   std::function<render_result<float>(engine_case const&)> const& run);

} // namespace genrender::examples
