// SPDX-License-Identifier: MIT
// Frames as one moving picture: an animated WebP that every browser plays.
#pragma once

#include "output_file.hpp"
#include "pictures.hpp"

#include <genrender/core/error.hpp>

#include <webp/encode.h>
#include <webp/mux.h>

#include <cmath>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <span>
#include <string>

namespace genrender::examples {

/// How frames become a moving picture.
struct animation_file_options {
    double frames_per_second = 12; ///< above 0, at most 1000: the file counts in milliseconds
    int near_lossless = 100; ///< 100: every pixel as it is; down to 0: values may move a little, files get smaller
};

namespace detail {

struct webp_deleter {
    void operator()(WebPAnimEncoder* encoder) const { WebPAnimEncoderDelete(encoder); }
};

/// A picture that gives back what the library allocated for it.
struct webp_picture {
    WebPPicture value{};
    webp_picture() { WebPPictureInit(&value); }
    webp_picture(webp_picture const&) = delete;
    webp_picture& operator=(webp_picture const&) = delete;
    ~webp_picture() { WebPPictureFree(&value); }
};

struct webp_data {
    WebPData value{};
    webp_data() { WebPDataInit(&value); }
    webp_data(webp_data const&) = delete;
    webp_data& operator=(webp_data const&) = delete;
    ~webp_data() { WebPDataClear(&value); }
};

} // namespace detail

/// Writes the frames as an animated WebP that loops for ever, whole or not at all; equal neighbours become one longer
/// frame. Throws value_error if there are no frames or the options are out of range, shape_error if frames differ in
/// extents or a side is above 16383, file_error if the file cannot be written.
inline void write_animation(std::filesystem::path const& path, std::span<rgb8_image const> frames,
                            animation_file_options const& options = {}) {
    require_value(!frames.empty(), "write_animation", "frames", "empty", "at least one frame");
    require_value(options.frames_per_second > 0 && options.frames_per_second <= 1000, "write_animation",
                  "frames_per_second", options.frames_per_second, "above 0 and at most 1000");
    require_value(options.near_lossless >= 0 && options.near_lossless <= 100, "write_animation", "near_lossless",
                  options.near_lossless, "0 to 100");
    auto const grid = frames[0].grid();
    for (auto const& frame : frames) {
        validate(frame, "write_animation");
        require_extents("write_animation", "frames", std::array{frame.height, frame.width},
                        std::array{grid.height, grid.width});
    }
    if (grid.height > WEBP_MAX_DIMENSION || grid.width > WEBP_MAX_DIMENSION) {
        throw shape_error("write_animation: frames is " + extents_text({grid.height, grid.width}) +
                          ", expected sides of at most 16383");
    }
    auto const require = [&](bool succeeded, std::string const& reason) {
        if (!succeeded) {
            throw file_error(path.string() + ": cannot be made a WebP animation (" + reason +
                             "), expected enough memory");
        }
    };

    WebPAnimEncoderOptions encoder_options;
    WebPConfig config;
    require(WebPAnimEncoderOptionsInit(&encoder_options) != 0 && WebPConfigInit(&config) != 0, "library version");
    encoder_options.anim_params.loop_count = 0; // for ever
    require(WebPConfigLosslessPreset(&config, 4) != 0, "settings");
    config.near_lossless = options.near_lossless;

    // Add every frame at its time in milliseconds
    std::unique_ptr<WebPAnimEncoder, detail::webp_deleter> const encoder(
        WebPAnimEncoderNew(static_cast<int>(grid.width), static_cast<int>(grid.height), &encoder_options));
    require(encoder != nullptr, "no encoder");
    auto const time_of = [&](std::size_t frame) {
        return static_cast<int>(std::lround(1000 * static_cast<double>(frame) / options.frames_per_second));
    };
    for (std::size_t i = 0; i < frames.size(); ++i) {
        detail::webp_picture picture;
        picture.value.use_argb = 1;
        picture.value.width = static_cast<int>(grid.width);
        picture.value.height = static_cast<int>(grid.height);
        require(WebPPictureImportRGB(&picture.value, frames[i].bytes.data(), static_cast<int>(3 * grid.width)) != 0,
                "no memory for a frame");
        require(WebPAnimEncoderAdd(encoder.get(), &picture.value, time_of(i), &config) != 0,
                WebPAnimEncoderGetError(encoder.get()));
    }
    require(WebPAnimEncoderAdd(encoder.get(), nullptr, time_of(frames.size()), nullptr) != 0,
            WebPAnimEncoderGetError(encoder.get()));

    detail::webp_data data;
    require(WebPAnimEncoderAssemble(encoder.get(), &data.value) != 0, WebPAnimEncoderGetError(encoder.get()));
    write_bytes(path, {data.value.bytes, data.value.size});
}

} // namespace genrender::examples
