// SPDX-License-Identifier: MIT
// Pictures of runs side by side: moments of the animations, and one image row over time.
#pragma once

#include <examples/support/contact_sheet.hpp>
#include <examples/support/pictures.hpp>

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace genrender::examples {

/// A run as pictures show it.
struct shown_run {
    std::string label;
    std::vector<rgb8_image> frames;
};

/// A row for each run, up to eight moments of the animation. Throws file_error if it cannot be written.
inline void write_moments(std::filesystem::path const& path, std::vector<shown_run> const& runs) {
    std::vector<rgb8_image> cells;
    std::vector<std::string> texts;
    std::size_t columns = 1;
    for (auto const& run : runs) {
        columns = std::min<std::size_t>(8, run.frames.size());
        for (std::size_t c = 0; c < columns; ++c) {
            cells.push_back(run.frames[columns > 1 ? c * (run.frames.size() - 1) / (columns - 1) : 0]);
            // The first two frames of a row carry its name: before a comma and after it.
            auto const comma = std::min(run.label.find(", "), run.label.size());
            texts.push_back(c == 0                               ? run.label.substr(0, comma)
                            : c == 1 && comma < run.label.size() ? run.label.substr(comma + 2)
                                                                 : "");
        }
    }
    write_png(path, contact_sheet(cells, {.columns = columns, .labels = texts}));
}

/// One image row over time for each run: time runs downwards. Throws file_error if it cannot be written.
inline void write_time_slices(std::filesystem::path const& path, std::vector<shown_run> const& runs, std::size_t row,
                              std::size_t enlargement) {
    std::vector<rgb8_image> slices;
    std::vector<std::string> labels;
    for (auto const& run : runs) {
        rgb8_image slice({run.frames.size(), run.frames.front().width}, {0, 0, 0});
        for (std::size_t i = 0; i < slice.height; ++i) {
            for (std::size_t column = 0; column < slice.width; ++column) {
                slice.set(i, column, run.frames[i].at(row, column));
            }
        }
        slices.push_back(std::move(slice));
        labels.push_back(run.label);
    }
    write_png(path, contact_sheet(slices, {.columns = 3, .enlargement = enlargement, .labels = labels}));
}

} // namespace genrender::examples
