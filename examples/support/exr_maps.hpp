// SPDX-License-Identifier: MIT
// [GR sec. 3] UV and depth maps from a folder of EXR files, as Blender's Cycles writes them.
#pragma once

#include "exr_folder.hpp"
#include "exr_layers.hpp"
#include "exr_layout.hpp"

#include <genrender/core/error.hpp>
#include <genrender/core/tensor.hpp>
#include <genrender/maps/depth_maps.hpp>
#include <genrender/maps/uv_convention.hpp>
#include <genrender/maps/uv_maps.hpp>

#include <algorithm>
#include <bitset>
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

/// Which frames of a folder are read: of those between two numbers, every so many, and at most so many.
struct exr_frame_range {
    std::optional<long> start{};        ///< the least number at the end of a file's name
    std::optional<long> end{};          ///< the largest one
    std::size_t step = 1;               ///< 1 or more
    std::optional<std::size_t> count{}; ///< none: to the end
};

/// How a folder of EXR files is read.
struct exr_sequence_options {
    std::string layer{};                   ///< view layer to read; empty: all that have all the passes, by depth
    std::optional<bool> v_upwards{};       ///< whether the file's v = 0 is the texture's bottom, so that 1 - v is read;
                                           ///< without a value true for Blender's layout, false for the plain one
    uv_outside outside = uv_outside::keep; ///< what becomes of coordinates outside [0, 1], which tiled textures have
    exr_frame_range frames{};              ///< no other file is opened
    bool has_position = true;              ///< read positions where there are any
};

/// The maps of a folder, and what its reader noticed.
struct exr_sequence {
    uv_maps uv;
    depth_maps depth; ///< covered where `uv` is
    /// Canonical positions [frames, height, width, 3]; without frames unless every file and layer has them.
    tensor<float, 4> position = tensor<float, 4>::from_shape({0, 0, 0, 3});
    std::vector<std::filesystem::path> files; ///< the file of each frame, of several that with UVs
    std::string manifest;                     ///< JSON text of Cryptomatte's names and ids; empty if there is none
    std::vector<std::string> notes;           ///< sentences about what is readable and may not be meant
};

namespace detail {

/// Fills the maps frame by frame and counts what is worth a note.
class exr_sequence_reader {
public:
    explicit exr_sequence_reader(exr_sequence& result) : result_(result) {}

    void read(std::size_t at, exr_frame const& frame, std::vector<exr_map_channels> const& layers) {
        auto const has_position = at < result_.position.shape()[0];
        std::vector<exr_layer_pixels> pixels;
        for (auto const& layer : layers) {
            for (auto const* const channel : {&layer.u, &layer.v, &layer.depth}) {
                has_half_ = has_half_ || channel->type == Imf::HALF;
            }
            pixels.emplace_back(frame, layer, has_position);
        }
        for (std::size_t i = 0; i < frame.grid().size(); ++i) {
            if (auto const surface = nearest_surface(pixels, i)) {
                take(at * frame.grid().size() + i, *surface, has_position);
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
    void take(std::size_t i, exr_surface const& surface, bool has_position) {
        ++covered_;
        mixed_ += surface.is_mixed;
        outside_ += surface.u < 0 || surface.u > 1 || surface.v < 0 || surface.v > 1;
        note_level(surface.u);
        note_level(surface.v);
        has_object_ = has_object_ || surface.object > 0;
        result_.uv.uv.data()[2 * i] = surface.u;
        result_.uv.uv.data()[2 * i + 1] = surface.v;
        result_.uv.object.data()[i] = surface.object;
        result_.uv.coverage.data()[i] = 1;
        result_.depth.depth.data()[i] = surface.depth;
        result_.depth.coverage.data()[i] = 1;
        if (has_position) {
            std::copy(surface.position.begin(), surface.position.end(), result_.position.data() + 3 * i);
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

/// The frames of a range. Throws value_error if there are none, a name has no number that is asked for, or the step is 0.
inline std::vector<exr_frame_files> frames_in(std::vector<exr_frame_files> all, exr_frame_range const& range) {
    require_value(range.step > 0, "load_exr_sequence", "frames.step", range.step, "1 or more");
    require_value(range.count != 0U, "load_exr_sequence", "frames.count", 0, "1 or more");
    if (range.start || range.end) {
        auto const last = all.back().front().path.filename().string();
        std::erase_if(all, [&](exr_frame_files const& frame) {
            auto const number = frame_number(frame);
            require_value(number.has_value(), "load_exr_sequence", "frames.start",
                          frame.front().path.filename().string(), "files whose names end with their frame's number");
            return *number < range.start.value_or(0) || (range.end && *number > *range.end);
        });
        require_value(!all.empty(), "load_exr_sequence", "frames.start",
                      (range.start ? std::to_string(*range.start) : "0") + " to " +
                          (range.end ? std::to_string(*range.end) : "the end"),
                      ("numbers of files, of which the last is " + last).c_str());
    }
    std::vector<exr_frame_files> chosen;
    for (std::size_t i = 0; i < all.size(); ++i) {
        if (i % range.step == 0 && chosen.size() < range.count.value_or(all.size())) {
            chosen.push_back(std::move(all[i]));
        }
    }
    return chosen;
}

/// Whether all layers have positions.
inline bool have_positions(std::vector<exr_map_channels> const& layers) {
    return std::all_of(layers.begin(), layers.end(), [](auto const& layer) { return !layer.position.empty(); });
}

/// Throws file_error unless a frame is as the first one: in size, layers and positions.
inline void require_like_first(exr_frame const& frame, std::vector<exr_map_channels> const& layers, grid_extents grid,
                               std::vector<exr_map_channels> const& first, std::string const& first_name) {
    auto const path = frame.path().string();
    auto const as_in_first = " as in " + first_name;
    if (frame.grid() != grid) {
        throw file_error(path + ": is " + extents_text({frame.grid().height, frame.grid().width}) + ", expected " +
                         extents_text({grid.height, grid.width}) + as_in_first);
    }
    for (std::size_t i = 0; i < std::max(layers.size(), first.size()); ++i) {
        auto const& found = i < layers.size() ? layers[i] : layers.back();
        auto const& expected = i < first.size() ? first[i] : first.back();
        if (i >= layers.size() || i >= first.size() || found.layout != expected.layout ||
            found.layer != expected.layer) {
            throw file_error(path + ": has other channel names (" + found.u.name + "), expected " + expected.u.name +
                             as_in_first);
        }
    }
    if (have_positions(layers) != have_positions(first)) {
        throw file_error(path + (have_positions(layers) ? ": has positions" : ": has no positions") + ", expected " +
                         (have_positions(first) ? first.front().position.front().name : "none") + as_in_first);
    }
}

/// What is to be said about the choice of view layers.
inline void note_layers(std::vector<std::string>& notes, exr_frame const& frame,
                        std::vector<exr_map_channels> const& layers, std::string const& wanted) {
    auto const text_of = [](std::vector<std::string> const& names) {
        std::string text;
        for (std::size_t i = 0; i < names.size(); ++i) {
            text += (i == 0 ? "" : i + 1 < names.size() ? ", " : " and ") + names[i];
        }
        return text;
    };
    if (layers.size() > 1) {
        std::vector<std::string> names;
        names.reserve(layers.size());
        for (auto const& layer : layers) {
            names.push_back(layer.layer.empty() ? "(without a name)" : layer.layer);
        }
        notes.push_back("View layers " + text_of(names) +
                        " are shown together, the nearest surface of each pixel: --view-layer NAME shows one.");
    }
    auto const left_out = wanted.empty() ? incomplete_layers(frame) : std::vector<std::string>{};
    if (!left_out.empty() && layers.front().layout == exr_layout::blender) {
        notes.push_back("View layers without UV, Z or Object Index passes are left out: " + text_of(left_out) + ".");
    }
    if (!layers.front().cryptomatte.empty()) {
        notes.push_back("Objects are told apart by Cryptomatte, as there is no Object Index pass.");
    }
}

} // namespace detail

/// The maps of the chosen frames of `folder`, which `exr_frames_of` orders, each with the extents of its display window;
/// files of other frames are not opened. A pixel is background where `UV.A` is 0, depth is not in (0, 1e10), or the
/// plain layout's `id` is below 0, and outside a file's data window; of several view layers the nearest surface is
/// taken. Objects keep the file's index, rounded, or Cryptomatte's id; v is 0 at the texture's top. Throws file_error
/// that names the file, what was found and what was expected: no or unreadable folder, no EXR file, 8-bit UV, broken
/// files, missing channels, frames of different sizes or layouts, impossible values; value_error for a range without
/// frames.
inline exr_sequence load_exr_sequence(std::filesystem::path const& folder, exr_sequence_options const& options = {}) {
    exr_sequence result;
    auto const frames = detail::frames_in(exr_frames_of(folder), options.frames);
    detail::exr_sequence_reader reader(result);
    std::vector<exr_map_channels> first;
    for (std::size_t i = 0; i < frames.size(); ++i) {
        exr_frame const frame(frames[i]);
        result.files.push_back(frame.path());
        auto const layers = find_map_channels(frame, options.layer);
        if (i == 0) {
            first = layers;
            result.uv = uv_maps(frames.size(), frame.grid());
            result.depth = depth_maps(frames.size(), frame.grid());
            if (options.has_position && detail::have_positions(layers)) {
                result.position =
                    tensor<float, 4>::from_shape({frames.size(), frame.grid().height, frame.grid().width, 3});
                result.position.fill(0);
            }
            detail::note_layers(result.notes, frame, layers, options.layer);
            result.manifest = layers.front().object ? "" : cryptomatte_manifest(frame, layers.front().layer);
        }
        detail::require_like_first(frame, layers, result.uv.grid(), first, result.files.front().filename().string());
        reader.read(i, frame, layers);
    }
    reader.finish(folder, first.front().layout);
    auto const is_world = [](auto const& layer) { return layer.position.front().name.ends_with("Position.X"); };
    if (result.position.shape()[0] > 0 && std::any_of(first.begin(), first.end(), is_world)) {
        result.notes.push_back(
            "Positions are Blender's Position pass, which is where points are in the world: right as "
            "canonical coordinates for what stands still only. Write rest positions as Rest.X, Y, Z.");
    }
    adopt_uv(to_view(result.uv.uv), to_view(result.uv.coverage),
             {.v_upwards = options.v_upwards.value_or(first.front().layout == exr_layout::blender),
              .outside = options.outside});
    return result;
}

} // namespace genrender::examples
