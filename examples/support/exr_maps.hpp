// SPDX-License-Identifier: MIT
// [GR sec. 3] UV and depth maps from a folder of EXR files, one a frame, as Blender's Cycles writes them.
#pragma once

#include "exr_layout.hpp"

#include <genrender/core/error.hpp>
#include <genrender/core/tensor.hpp>
#include <genrender/maps/depth_maps.hpp>
#include <genrender/maps/uv_convention.hpp>
#include <genrender/maps/uv_maps.hpp>

#include <algorithm>
#include <bitset>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

// In Blender: Cycles, one sample, pixel filter width 0.01 px (UVs of several surfaces must not mix in a pixel); View
// Layer > Passes: Z, UV, Object Index; Object > Relations > Pass Index, a number of its own for every object; Output:
// OpenEXR MultiLayer, Float (Full).

namespace genrender::examples {

/// How a folder of EXR files is read.
struct exr_sequence_options {
    std::string layer{};                   ///< view layer to read; empty: the first that has all the passes
    std::optional<bool> v_upwards{};       ///< whether the file's v = 0 is the texture's bottom, so that 1 - v is read;
                                           ///< without a value true for Blender's layout, false for the plain one
    uv_outside outside = uv_outside::keep; ///< what becomes of coordinates outside [0, 1], which tiled textures have
};

/// The maps of a folder, and what its reader noticed.
struct exr_sequence {
    uv_maps uv;
    depth_maps depth; ///< covered where `uv` is
    /// Canonical positions [frames, height, width, 3]; without frames unless every file has them.
    tensor<float, 4> position = tensor<float, 4>::from_shape({0, 0, 0, 3});
    std::vector<std::filesystem::path> files; ///< the file of each frame
    std::vector<std::string> notes;           ///< sentences about what is readable and may not be meant
};

namespace detail {

/// Whether `a` comes before `b` when runs of digits count as numbers: frame_9 before frame_10.
inline bool comes_before(std::string const& a, std::string const& b) {
    auto const is_digit = [](char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; };
    auto const number_at = [&](std::string const& text, std::size_t& i) {
        auto const begin = std::min(text.find_first_not_of('0', i), text.size());
        while (i < text.size() && is_digit(text[i])) {
            ++i;
        }
        return begin < i ? text.substr(begin, i - begin) : std::string{};
    };
    for (std::size_t i = 0, j = 0; i < a.size() && j < b.size();) {
        if (is_digit(a[i]) && is_digit(b[j])) {
            auto const m = number_at(a, i);
            auto const n = number_at(b, j);
            if (m != n) {
                return m.size() != n.size() ? m.size() < n.size() : m < n;
            }
        } else if (a[i] != b[j]) {
            return a[i] < b[j];
        } else {
            ++i;
            ++j;
        }
    }
    return a.size() != b.size() ? a.size() < b.size() : a < b;
}

/// The EXR files of a folder in order. Throws file_error if there are none, and says why 8-bit pictures are not enough.
inline std::vector<std::filesystem::path> exr_files(std::filesystem::path const& folder) {
    std::vector<std::filesystem::path> files;
    std::string picture;
    std::error_code failure;
    for (std::filesystem::directory_iterator entry(folder, failure), end; !failure && entry != end;
         entry.increment(failure)) {
        auto ending = entry->path().extension().string();
        std::transform(ending.begin(), ending.end(), ending.begin(),
                       [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
        if (ending == ".exr" && entry->path().filename().string().front() != '.') {
            files.push_back(entry->path());
        } else if (ending == ".png" || ending == ".jpg" || ending == ".jpeg") {
            picture = entry->path().filename().string();
        }
    }
    if (failure) {
        throw file_error(folder.string() + ": cannot be read (" + failure.message() +
                         "), expected a folder of EXR files");
    }
    if (files.empty() && !picture.empty()) {
        throw file_error(
            folder.string() + ": holds 8-bit pictures (" + picture +
            ") and no EXR file, expected 32-bit float EXR (256 levels of u and v cannot address a texture)");
    }
    if (files.empty()) {
        throw file_error(folder.string() + ": holds no EXR file, expected one a frame");
    }
    std::sort(files.begin(), files.end(),
              [](auto const& a, auto const& b) { return comes_before(a.filename().string(), b.filename().string()); });
    return files;
}

/// Fills the maps frame by frame and counts what is worth a note.
class exr_sequence_reader {
public:
    explicit exr_sequence_reader(exr_sequence& result) : result_(result) {}

    void read(std::size_t frame, exr_file const& file, exr_map_channels const& channels) {
        for (auto const* const channel : {&channels.u, &channels.v, &channels.depth}) {
            has_half_ = has_half_ || channel->type == Imf::HALF;
        }

        // Outside the data window is background in both layouts: alpha 0, depth 0
        std::vector<exr_channel> wanted{channels.u, channels.v, channels.object, channels.depth};
        if (channels.alpha) {
            wanted.push_back(*channels.alpha);
        }
        auto const first_position = wanted.size();
        auto const has_position = frame < result_.position.shape()[0];
        if (has_position) {
            wanted.insert(wanted.end(), channels.position.begin(), channels.position.end());
        }
        auto const planes = file.planes(wanted, 0.0f);
        auto const grid = file.grid();
        for (std::uint32_t row = 0; row < grid.height; ++row) {
            for (std::uint32_t column = 0; column < grid.width; ++column) {
                auto const i = row * grid.width + column;
                auto const depth = planes[3][i];
                auto const alpha = channels.alpha ? planes[4][i] : 1.0f;
                auto const object = planes[2][i];
                auto const is_background = !(alpha > 0) || !(depth > 0) || !(depth < 1e10f) ||
                                           (channels.layout == exr_layout::plain && object < 0);
                if (is_background) {
                    continue;
                }
                ++covered_;
                mixed_ += alpha < 1 || object != std::round(object);
                // Cycles adds up the UVs of the samples that hit: alpha is their share
                auto const u = planes[0][i] / alpha;
                auto const v = planes[1][i] / alpha;
                require(std::isfinite(u) && std::isfinite(v), file, row, column, "UV is not a finite number",
                        "texture coordinates where a surface is covered");
                require(object >= 0 && object < 16777216.0f, file, row, column,
                        "object index is " + std::to_string(object), "0 to 2^24 - 1");
                outside_ += u < 0 || u > 1 || v < 0 || v > 1;
                note_level(u);
                note_level(v);
                auto const index = std::lround(object);
                has_object_ = has_object_ || index > 0;
                result_.uv.uv(frame, row, column, 0) = u;
                result_.uv.uv(frame, row, column, 1) = v;
                result_.uv.object(frame, row, column) = static_cast<std::uint32_t>(index);
                for (std::size_t axis = 0; has_position && axis < 3; ++axis) {
                    auto const coordinate = planes[first_position + axis][i] / alpha;
                    require(std::isfinite(coordinate), file, row, column, "position is not a finite number",
                            "coordinates where a surface is covered");
                    result_.position(frame, row, column, axis) = coordinate;
                }
                result_.uv.coverage(frame, row, column) = 1;
                result_.depth.depth(frame, row, column) = depth;
                result_.depth.coverage(frame, row, column) = 1;
            }
        }
    }

    /// Throws file_error if every u and v is a multiple of 1/255; else leaves the notes.
    void finish(std::filesystem::path const& folder, exr_layout layout) const {
        if (is_8_bit_ && levels_.count() >= 16) {
            throw file_error(folder.string() + ": every u and v is a multiple of 1/255, expected UV that never passed "
                                               "through an 8-bit picture (256 levels cannot address a texture)");
        }
        auto const share = [&](std::size_t count) {
            return std::to_string(count) + " of " + std::to_string(covered_) + " covered pixels ";
        };
        if (covered_ == 0) {
            result_.notes.push_back("No frame shows a surface.");
        }
        if (has_half_) {
            result_.notes.push_back("UV or depth are 16-bit floats (11 bits of precision): render with Float (Full).");
        }
        if (mixed_ > 0) {
            result_.notes.push_back(share(mixed_) +
                                    "mix several surfaces: render one sample, pixel filter width 0.01.");
        }
        if (outside_ > 0) {
            result_.notes.push_back(share(outside_) + "have u or v outside [0, 1].");
        }
        if (covered_ > 0 && !has_object_ && layout == exr_layout::blender) {
            result_.notes.push_back(
                "Every object has index 0 and so shares one texture: give each its own Pass Index.");
        }
    }

private:
    static void require(bool holds, exr_file const& file, std::uint32_t row, std::uint32_t column,
                        std::string const& found, char const* expected) {
        if (!holds) {
            throw file_error(file.path().string() + ": at row " + std::to_string(row) + ", column " +
                             std::to_string(column) + " the " + found + ", expected " + expected);
        }
    }

    void note_level(float coordinate) {
        auto const level = coordinate * 255;
        is_8_bit_ = is_8_bit_ && coordinate >= 0 && coordinate <= 1 && std::abs(level - std::round(level)) < 1e-4f;
        if (is_8_bit_) {
            levels_.set(static_cast<std::size_t>(std::lround(level)));
        }
    }

    exr_sequence& result_;
    std::size_t covered_ = 0;
    std::size_t mixed_ = 0;
    std::size_t outside_ = 0;
    bool has_half_ = false;
    bool has_object_ = false;
    bool is_8_bit_ = true;
    std::bitset<256> levels_;
};

} // namespace detail

/// The maps of all EXR files of `folder`, ordered by name with digits as numbers, each with the extents of its
/// display window. A pixel is background where `UV.A` is 0, depth is not in (0, 1e10), or the plain layout's `id` is
/// below 0, and outside a file's data window. Objects keep the file's index, rounded; v is 0 at the texture's top.
/// Throws file_error that names the file, what was found and what was expected: no or unreadable folder, no EXR file,
/// 8-bit UV, broken files, missing channels, frames of different sizes or layouts, impossible values.
inline exr_sequence load_exr_sequence(std::filesystem::path const& folder, exr_sequence_options const& options = {}) {
    exr_sequence result;
    result.files = detail::exr_files(folder);
    detail::exr_sequence_reader reader(result);
    exr_map_channels first;
    for (std::size_t frame = 0; frame < result.files.size(); ++frame) {
        exr_file const file(result.files[frame]);
        auto const channels = find_map_channels(file, frame == 0 ? options.layer : first.layer);
        if (frame == 0) {
            first = channels;
            result.uv = uv_maps(result.files.size(), file.grid());
            result.depth = depth_maps(result.files.size(), file.grid());
            if (!channels.position.empty()) {
                result.position =
                    tensor<float, 4>::from_shape({result.files.size(), file.grid().height, file.grid().width, 3});
                result.position.fill(0);
            }
        }
        auto const expected = result.uv.grid();
        if (file.grid() != expected) {
            throw file_error(file.path().string() + ": is " + extents_text({file.grid().height, file.grid().width}) +
                             ", expected " + extents_text({expected.height, expected.width}) + " as in " +
                             result.files.front().filename().string());
        }
        if (channels.layout != first.layout) {
            throw file_error(file.path().string() + ": has other channel names (" + channels.u.name + "), expected " +
                             first.u.name + " as in " + result.files.front().filename().string());
        }
        if (channels.position.size() != first.position.size()) {
            throw file_error(file.path().string() +
                             (channels.position.empty() ? ": has no positions" : ": has positions") + ", expected " +
                             (first.position.empty() ? "none" : first.position.front().name) + " as in " +
                             result.files.front().filename().string());
        }
        reader.read(frame, file, channels);
    }
    reader.finish(folder, first.layout);
    if (!first.position.empty() && first.position.front().name.ends_with("Position.X")) {
        result.notes.push_back(
            "Positions are Blender's Position pass, which is where points are in the world: right as "
            "canonical coordinates for what stands still only. Write rest positions as Rest.X, Y, Z.");
    }
    adopt_uv(
        to_view(result.uv.uv), to_view(result.uv.coverage),
        {.v_upwards = options.v_upwards.value_or(first.layout == exr_layout::blender), .outside = options.outside});
    return result;
}

} // namespace genrender::examples
