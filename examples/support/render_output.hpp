// SPDX-License-Identifier: MIT
// What a run leaves behind to look at: frames, maps, a moving picture, a contact sheet, a comparison.
#pragma once

#include "animation_file.hpp"
#include "contact_sheet.hpp"
#include "frame_file.hpp"
#include "guidance_source.hpp"
#include "output_file.hpp"
#include "pictures.hpp"

#include <genrender/core/tensor.hpp>
#include <genrender/maps/depth_maps.hpp>

#include <algorithm>
#include <array>
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

/// `0007.png`, with another ending where one is told
inline std::string numbered_name(std::size_t frame, char const* ending = ".png") {
    std::array<char, 32> name{};
    std::snprintf(name.data(), name.size(), "%04zu%s", frame, ending);
    return name.data();
}

/// Removes files of higher numbers that a longer run before this one left in a folder: it must not lend it frames.
inline void remove_numbered(std::filesystem::path const& folder, std::size_t first, char const* ending,
                            std::string const& prefix = "") {
    for (auto i = first; std::filesystem::remove(folder / (prefix + numbered_name(i, ending))); ++i) {
    }
}

/// Writes every picture into a folder, one file each, and removes higher numbers that an earlier run left there.
inline void write_numbered(std::filesystem::path const& folder, std::vector<rgb8_image> const& pictures,
                           std::string const& prefix = "") {
    make_folder(folder);
    for (std::size_t i = 0; i < pictures.size(); ++i) {
        write_png(folder / (prefix + numbered_name(i)), pictures[i]);
    }
    remove_numbered(folder, pictures.size(), ".png", prefix);
}

/// Writes frames [frames, 3, height, width] in [0, 1] into a folder, one file each; with the share of each pixel that
/// objects of `coverage` [frames, map height, map width] cover as alpha, where it is told.
inline void write_frames(std::filesystem::path const& folder, tensor<float, 4> const& images,
                         tensor<std::uint8_t, 3> const* coverage, frame_format format) {
    make_folder(folder);
    std::optional<tensor<float, 3>> alpha;
    if (coverage != nullptr) {
        auto mask = tensor<float, 3>::from_shape(coverage->shape());
        std::copy_n(coverage->data(), mask.size(), mask.data());
        alpha = cell_means(mask, {images.shape()[2], images.shape()[3]});
    }
    auto const frames = images.shape()[0];
    for (std::size_t i = 0; i < frames; ++i) {
        write_frame(folder / numbered_name(i, ending_of(format)), to_view(images)[i],
                    alpha ? std::optional(to_view(std::as_const(*alpha))[i]) : std::nullopt, format);
    }
    for (auto const* const ending : {".png", ".exr"}) {
        remove_numbered(folder, ending_of(format) == std::string_view(ending) ? frames : 0, ending);
    }
}

/// How many times frames of this height are enlarged so that a person can look at them.
inline std::size_t viewing_factor(std::size_t height) { return std::max<std::size_t>(1, 256 / height); }

/// Writes pictures of a run below `out`: maps/, animation.webp and contact_sheet.png. Throws file_error if one cannot be
/// written; those before it stay.
inline void write_pictures(std::filesystem::path const& out, rendered_guidance const& guidance,
                           std::vector<rgb8_image> const& frames, double frames_per_second) {
    write_numbered(out / "maps", uv_pictures(guidance.uv), "uv_");
    write_numbered(out / "maps", depth_pictures(guidance.depth), "depth_");
    auto const factor = viewing_factor(frames.front().height);
    std::vector<rgb8_image> large;
    for (auto const& frame : frames) {
        large.push_back(enlarge(frame, factor));
    }
    write_animation(out / "animation.webp", large, {.frames_per_second = frames_per_second});
    write_png(out / "contact_sheet.png", contact_sheet(frames, {.enlargement = std::max<std::size_t>(1, factor / 2)}));
}

/// Writes preview.png, what the frames look like so far. Throws file_error if it cannot be written.
inline void write_preview(std::filesystem::path const& out, std::vector<rgb8_image> const& frames) {
    auto const factor = viewing_factor(frames.front().height);
    write_png(out / "preview.png", contact_sheet(frames, {.enlargement = std::max<std::size_t>(1, factor / 2)}));
}

/// Frames of an earlier run, and what it is called.
struct earlier_run {
    std::string name;
    std::vector<rgb8_image> frames;
};

/// Writes comparison.png, one row of an earlier run's frames over one of this run's, and comparison.webp, both side by
/// side. Throws file_error if they cannot be written.
inline void write_comparison(std::filesystem::path const& out, earlier_run const& earlier,
                             std::vector<rgb8_image> const& frames, std::string const& name, double frames_per_second) {
    std::vector<rgb8_image> pairs;
    for (std::size_t i = 0; i < frames.size(); ++i) {
        std::array const both{earlier.frames[i], frames[i]};
        pairs.push_back(contact_sheet(
            both, {.columns = 2, .enlargement = viewing_factor(frames[i].height), .labels = {earlier.name, name}}));
    }
    write_animation(out / "comparison.webp", pairs, {.frames_per_second = frames_per_second});

    // A handful of frames over the whole time, enough to see what stays and what changes.
    auto const columns = std::min<std::size_t>(8, frames.size());
    std::vector<rgb8_image> rows;
    std::vector<std::string> labels;
    for (auto const* const run : {&earlier.frames, &frames}) {
        for (std::size_t c = 0; c < columns; ++c) {
            auto const frame = c * frames.size() / columns;
            rows.push_back((*run)[frame]);
            labels.push_back((run == &earlier.frames ? earlier.name : name) + " " + std::to_string(frame));
        }
    }
    write_png(out / "comparison.png",
              contact_sheet(rows, {.columns = columns,
                                   .enlargement = std::max<std::size_t>(1, viewing_factor(frames[0].height) / 2),
                                   .labels = labels}));
}

} // namespace genrender::examples
