// SPDX-License-Identifier: MIT
// A finished frame as a file: PNG of 8 or 16 bits a channel, or OpenEXR in linear light, with or without alpha.
#pragma once

#include "exr_maps_writer.hpp"
#include "names.hpp"
#include "output_file.hpp"

#include <genrender/core/error.hpp>
#include <genrender/core/index.hpp>
#include <genrender/core/strided_view.hpp>

#include <png.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <csetjmp>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace genrender::examples {

/// How the values of a frame are kept.
enum class frame_format {
    png8,  ///< 8 bits a channel, sRGB
    png16, ///< 16 bits a channel, sRGB
    exr    ///< 32-bit numbers of linear light, colours times alpha, as OpenEXR has them
};

inline constexpr named<frame_format> frame_format_names[]{
    {"png8", frame_format::png8}, {"png16", frame_format::png16}, {"exr", frame_format::exr}};

/// `.png` or `.exr`
inline char const* ending_of(frame_format format) { return format == frame_format::exr ? ".exr" : ".png"; }

/// The light of an sRGB value (IEC 61966-2-1).
inline float linear_of_srgb(float value) {
    return value <= 0.04045f ? value / 12.92f : std::pow((value + 0.055f) / 1.055f, 2.4f);
}

namespace detail {

/// Gives back what libpng allocated.
struct png_writer {
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
    png_infop info = png != nullptr ? png_create_info_struct(png) : nullptr;
    std::FILE* file = nullptr;

    png_writer() = default;
    png_writer(png_writer const&) = delete;
    png_writer& operator=(png_writer const&) = delete;
    ~png_writer() {
        png_destroy_write_struct(&png, &info);
        if (file != nullptr) {
            std::fclose(file);
        }
    }
};

/// Whether all was written. No object with a destructor lives in here, as libpng jumps out of it.
inline bool write_rows(png_writer& writer, grid_extents grid, int bits, bool has_alpha, png_byte* bytes,
                       std::size_t row_bytes) {
    if (setjmp(png_jmpbuf(writer.png)) != 0) { // NOLINT(modernize-avoid-setjmp-longjmp): how libpng tells of errors
        return false;
    }
    png_init_io(writer.png, writer.file);
    png_set_IHDR(writer.png, writer.info, static_cast<png_uint_32>(grid.width), static_cast<png_uint_32>(grid.height),
                 bits, has_alpha ? PNG_COLOR_TYPE_RGB_ALPHA : PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_set_sRGB(writer.png, writer.info, PNG_sRGB_INTENT_PERCEPTUAL);
    png_write_info(writer.png, writer.info);
    for (std::size_t row = 0; row < grid.height; ++row) {
        png_write_row(writer.png, bytes + row * row_bytes);
    }
    png_write_end(writer.png, writer.info);
    return std::fflush(writer.file) == 0;
}

} // namespace detail

/// Writes a frame [3, height, width] in [0, 1], sRGB, values outside clamped, with `alpha` [height, width] in [0, 1] where
/// there is one; whole or not at all. Throws shape_error if the extents differ, file_error if it cannot be written.
inline void write_frame(std::filesystem::path const& path, strided_view<float const, 3> rgb,
                        std::optional<strided_view<float const, 2>> alpha, frame_format format) {
    grid_extents const grid{rgb.extent(1), rgb.extent(2)};
    require_shape("write_frame", "rgb", rgb, {3, grid.height, grid.width});
    if (alpha) {
        require_shape("write_frame", "alpha", *alpha, {grid.height, grid.width});
    }
    auto const clamped = [](float value) { return value > 0 ? std::min(value, 1.0f) : 0.0f; };
    auto const opacity = [&](std::size_t row, std::size_t column) {
        return alpha ? clamped((*alpha)(row, column)) : 1.0f;
    };
    if (format == frame_format::exr) {
        std::vector<detail::exr_output_plane> channels;
        for (std::size_t c = 0; c < 3; ++c) {
            auto& channel = channels.emplace_back(detail::exr_output_plane{"", std::string(1, "RGB"[c]), {}});
            for (std::size_t row = 0; row < grid.height; ++row) {
                for (std::size_t column = 0; column < grid.width; ++column) {
                    channel.values.push_back(linear_of_srgb(clamped(rgb(c, row, column))) * opacity(row, column));
                }
            }
        }
        if (alpha) {
            auto& channel = channels.emplace_back(detail::exr_output_plane{"", "A", {}});
            for (std::size_t row = 0; row < grid.height; ++row) {
                for (std::size_t column = 0; column < grid.width; ++column) {
                    channel.values.push_back(opacity(row, column));
                }
            }
        }
        detail::write_exr_planes(path, channels, grid, false);
        return;
    }

    auto const bits = format == frame_format::png16 ? 16 : 8;
    std::vector<png_byte> bytes;
    auto const add = [&](float value) {
        auto const number = static_cast<unsigned>(std::lround(value * static_cast<float>((1 << bits) - 1)));
        if (bits == 16) {
            bytes.push_back(static_cast<png_byte>(number >> 8));
        }
        bytes.push_back(static_cast<png_byte>(number & 0xFFU));
    };
    for (std::size_t row = 0; row < grid.height; ++row) {
        for (std::size_t column = 0; column < grid.width; ++column) {
            for (std::size_t c = 0; c < 3; ++c) {
                add(clamped(rgb(c, row, column)));
            }
            if (alpha) {
                add(opacity(row, column));
            }
        }
    }
    output_file file(path);
    bool is_written = false;
    {
        detail::png_writer writer;
        writer.file = std::fopen(file.temporary().c_str(), "wb");
        is_written =
            writer.file != nullptr && writer.info != nullptr &&
            detail::write_rows(writer, grid, bits, alpha.has_value(), bytes.data(), bytes.size() / grid.height);
    }
    if (!is_written) {
        throw file_error(path.string() + ": cannot be written, expected room on the disk");
    }
    file.commit();
}

} // namespace genrender::examples
