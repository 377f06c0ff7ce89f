// SPDX-License-Identifier: MIT
// What a run leaves behind to look at: frames, maps, a moving picture, a contact sheet, a comparison.
#pragma once

#include "animation_file.hpp"
#include "contact_sheet.hpp"
#include "guidance_source.hpp"
#include "output_file.hpp"
#include "pictures.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

namespace genrender::examples {

/// `0007.png`
inline std::string numbered_png(std::size_t frame) {
    std::array<char, 32> name{};
    std::snprintf(name.data(), name.size(), "%04zu.png", frame);
    return name.data();
}

/// Writes every picture into a folder, one file each, and removes higher numbers that an earlier run left there.
inline void write_numbered(std::filesystem::path const& folder, std::vector<rgb8_image> const& pictures,
                           std::string const& prefix = "") {
    make_folder(folder);
    for (std::size_t i = 0; i < pictures.size(); ++i) {
        write_png(folder / (prefix + numbered_png(i)), pictures[i]);
    }
    // A longer run before this one must not lend it frames.
    for (auto i = pictures.size(); std::filesystem::remove(folder / (prefix + numbered_png(i))); ++i) {
    }
}

/// How many times frames of this height are enlarged so that a person can look at them.
inline std::size_t viewing_factor(std::size_t height) { return std::max<std::size_t>(1, 256 / height); }

/// Writes a run's pictures below `out`: maps/, frames/, animation.webp and contact_sheet.png, frames before what is
/// made of them. Throws file_error if one cannot be written; those before it stay.
inline void write_pictures(std::filesystem::path const& out, rendered_guidance const& guidance,
                           std::vector<rgb8_image> const& frames) {
    write_numbered(out / "frames", frames);
    write_numbered(out / "maps", uv_pictures(guidance.uv), "uv_");
    write_numbered(out / "maps", depth_pictures(guidance.depth), "depth_");
    auto const factor = viewing_factor(frames.front().height);
    std::vector<rgb8_image> large;
    for (auto const& frame : frames) {
        large.push_back(enlarge(frame, factor));
    }
    write_animation(out / "animation.webp", large);
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
                             std::vector<rgb8_image> const& frames, std::string const& name) {
    std::vector<rgb8_image> pairs;
    for (std::size_t i = 0; i < frames.size(); ++i) {
        std::array const both{earlier.frames[i], frames[i]};
        pairs.push_back(contact_sheet(
            both, {.columns = 2, .enlargement = viewing_factor(frames[i].height), .labels = {earlier.name, name}}));
    }
    write_animation(out / "comparison.webp", pairs);

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
