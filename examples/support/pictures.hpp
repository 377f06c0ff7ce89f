// SPDX-License-Identifier: MIT
// Pictures for people: an 8-bit image, its PNG file, and UV, depth and colour maps made visible.
#pragma once

#include "output_file.hpp"

#include <genrender/core/error.hpp>
#include <genrender/core/index.hpp>
#include <genrender/core/strided_view.hpp>
#include <genrender/maps/depth_maps.hpp>
#include <genrender/maps/uv_maps.hpp>

#include <png.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace genrender::examples {

/// A colour, red, green and blue in 0..255.
using rgb8 = std::array<std::uint8_t, 3>;

/// An image of 8 bits a channel, row 0 on top.
struct rgb8_image {
    std::size_t height = 0;
    std::size_t width = 0;
    std::vector<std::uint8_t> bytes; ///< [height, width, 3]

    rgb8_image() = default;

    /// An image of one colour.
    rgb8_image(grid_extents grid, rgb8 colour) : height(grid.height), width(grid.width), bytes(grid.size() * 3) {
        for (std::size_t i = 0; i < bytes.size(); ++i) {
            bytes[i] = colour[i % 3];
        }
    }

    grid_extents grid() const { return {height, width}; }
    rgb8 at(std::size_t row, std::size_t column) const {
        auto const* const p = &bytes[(row * width + column) * 3];
        return {p[0], p[1], p[2]};
    }
    void set(std::size_t row, std::size_t column, rgb8 colour) {
        std::copy(colour.begin(), colour.end(),
                  bytes.begin() + static_cast<std::ptrdiff_t>((row * width + column) * 3));
    }
};

/// Throws shape_error unless the image has pixels and three bytes for each. `function` begins the text.
inline void validate(rgb8_image const& image, char const* function) {
    if (image.grid().size() == 0) {
        throw shape_error(std::string(function) + ": image is " + extents_text({image.height, image.width}) +
                          ", expected at least one pixel");
    }
    require_extents(function, "image.bytes", std::array{image.bytes.size()}, std::array{image.grid().size() * 3});
}

/// Writes the image as PNG, whole or not at all. Throws shape_error at an image without pixels, file_error if the
/// file cannot be written.
inline void write_png(std::filesystem::path const& path, rgb8_image const& image) {
    validate(image, "write_png");
    output_file file(path);
    png_image png{};
    png.version = PNG_IMAGE_VERSION;
    png.width = static_cast<png_uint_32>(image.width);
    png.height = static_cast<png_uint_32>(image.height);
    png.format = PNG_FORMAT_RGB;
    if (png_image_write_to_file(&png, file.temporary().c_str(), 0, image.bytes.data(), 0, nullptr) == 0) {
        throw file_error(path.string() + ": cannot be written (" + png.message + "), expected room on the disk");
    }
    file.commit();
}

/// The pixels of a PNG file, its transparency on black. Throws file_error with the PNG library's reason.
inline rgb8_image read_png(std::filesystem::path const& path) {
    png_image png{};
    png.version = PNG_IMAGE_VERSION;
    rgb8_image image;
    auto const refuse = [&] {
        throw file_error(path.string() + ": cannot be read as PNG (" + png.message + "), expected a whole PNG file");
    };
    if (png_image_begin_read_from_file(&png, path.c_str()) == 0) {
        refuse();
    }
    png.format = PNG_FORMAT_RGB;
    image.height = png.height;
    image.width = png.width;
    image.bytes.resize(image.grid().size() * 3);
    png_color const black{};
    if (png_image_finish_read(&png, &black, image.bytes.data(), 0, nullptr) == 0) {
        refuse();
    }
    return image;
}

/// 0..255 for [0, 1], clamped; not-a-number is 0.
inline std::uint8_t to_byte(float value) {
    return static_cast<std::uint8_t>(std::lround(255 * (value > 0 ? std::min(value, 1.0f) : 0.0f)));
}

/// One frame of colour, [3, height, width] in [0, 1], values outside clamped. Throws shape_error unless there are 3
/// channels.
inline rgb8_image rgb_picture(strided_view<float const, 3> rgb) {
    require_shape("rgb_picture", "rgb", rgb, {3, rgb.extent(1), rgb.extent(2)});
    rgb8_image image({rgb.extent(1), rgb.extent(2)}, {0, 0, 0});
    for (std::size_t row = 0; row < image.height; ++row) {
        for (std::size_t column = 0; column < image.width; ++column) {
            image.set(row, column,
                      {to_byte(rgb(0, row, column)), to_byte(rgb(1, row, column)), to_byte(rgb(2, row, column))});
        }
    }
    return image;
}

/// Every frame of UV made visible: red grows with u, green with v, blue is the object's; every second square of an 8
/// x 8 board on the texture is darker; the background is nearly black.
inline std::vector<rgb8_image> uv_pictures(uv_maps const& maps) {
    std::vector<rgb8_image> pictures;
    for (std::size_t frame = 0; frame < maps.frame_count(); ++frame) {
        auto& image = pictures.emplace_back(maps.grid(), rgb8{16, 16, 24});
        for (std::size_t row = 0; row < image.height; ++row) {
            for (std::size_t column = 0; column < image.width; ++column) {
                if (maps.coverage(frame, row, column) == 0) {
                    continue;
                }
                auto const u = maps.uv(frame, row, column, 0) - std::floor(maps.uv(frame, row, column, 0));
                auto const v = maps.uv(frame, row, column, 1) - std::floor(maps.uv(frame, row, column, 1));
                // Multiples of the golden ratio keep the blues of few objects far apart
                auto const turns = 0.618034 * static_cast<double>(maps.object(frame, row, column) + 1);
                auto const object = static_cast<float>(turns - std::floor(turns));
                auto const is_dark = (static_cast<int>(u * 8) + static_cast<int>(v * 8)) % 2 != 0;
                auto const light = is_dark ? 0.72f : 1.0f;
                image.set(row, column,
                          {to_byte(light * (0.2f + 0.8f * u)), to_byte(light * (0.2f + 0.8f * v)),
                           to_byte(light * (0.15f + 0.85f * object))});
            }
        }
    }
    return pictures;
}

/// Every frame of depth made visible on one scale for all: white at the animation's nearest point, dark grey at its
/// farthest, black on the background. Throws as sequence_inverse_depth does.
inline std::vector<rgb8_image> depth_pictures(depth_maps const& maps) {
    auto const nearness = sequence_inverse_depth(maps);
    std::vector<rgb8_image> pictures;
    for (std::size_t frame = 0; frame < maps.frame_count(); ++frame) {
        auto& image = pictures.emplace_back(maps.grid(), rgb8{0, 0, 0});
        for (std::size_t row = 0; row < image.height; ++row) {
            for (std::size_t column = 0; column < image.width; ++column) {
                if (maps.coverage(frame, row, column) != 0) {
                    auto const grey = to_byte(0.2f + 0.8f * nearness(frame, row, column));
                    image.set(row, column, {grey, grey, grey});
                }
            }
        }
    }
    return pictures;
}

/// Every pixel as a square of `factor` x `factor`. Throws value_error at a factor of 0.
inline rgb8_image enlarge(rgb8_image const& image, std::size_t factor) {
    require_value(factor > 0, "enlarge", "factor", factor, "at least 1");
    rgb8_image result({image.height * factor, image.width * factor}, {0, 0, 0});
    for (std::size_t row = 0; row < result.height; ++row) {
        for (std::size_t column = 0; column < result.width; ++column) {
            result.set(row, column, image.at(row / factor, column / factor));
        }
    }
    return result;
}

} // namespace genrender::examples
