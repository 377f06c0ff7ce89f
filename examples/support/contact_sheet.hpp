// SPDX-License-Identifier: MIT
// Many frames on one picture, in rows, with their names below them.
#pragma once

#include "bitmap_font.hpp"
#include "pictures.hpp"

#include <genrender/core/error.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace genrender::examples {

/// How frames are laid out.
struct contact_sheet_options {
    std::size_t columns = 0;           ///< frames in a row; 0: as many as make the sheet about square
    std::size_t margin = 2;            ///< pixels between frames and around them
    std::size_t enlargement = 1;       ///< side of the square that one pixel of a frame becomes
    std::vector<std::string> labels{}; ///< a name below each frame, cut at the frame's width; none: no room for them
    rgb8 paper{48, 48, 48};
    rgb8 ink{230, 230, 230};
};

/// Draws text with its top left corner at (row, column), characters 6 pixels apart; what lies beyond `end_column` or
/// the image is not drawn.
inline void draw_text(rgb8_image& image, std::string_view text, std::size_t row, std::size_t column,
                      std::size_t end_column, rgb8 ink) {
    for (std::size_t i = 0; i < text.size(); ++i) {
        auto const& rows = glyph(text[i]);
        for (std::size_t y = 0; y < rows.size(); ++y) {
            for (std::size_t x = 0; x < 5; ++x) {
                auto const at = column + 6 * i + x;
                if (((rows[y] >> (4 - x)) & 1) != 0 && row + y < image.height &&
                    at < std::min(end_column, image.width)) {
                    image.set(row + y, at, ink);
                }
            }
        }
    }
}

/// All frames on one sheet, row by row from the top left. Throws value_error if there are none, shape_error if they
/// differ in extents or are not as many as the labels.
inline rgb8_image contact_sheet(std::span<rgb8_image const> frames, contact_sheet_options const& options = {}) {
    require_value(!frames.empty(), "contact_sheet", "frames", "empty", "at least one frame");
    require_value(options.enlargement > 0, "contact_sheet", "enlargement", options.enlargement, "at least 1");
    for (auto const& frame : frames) {
        validate(frame, "contact_sheet");
        require_extents("contact_sheet", "frames", std::array{frame.height, frame.width},
                        std::array{frames[0].height, frames[0].width});
    }
    if (!options.labels.empty()) {
        require_extents("contact_sheet", "labels", std::array{options.labels.size()}, std::array{frames.size()});
    }

    // Lay out the cells
    auto const height = frames[0].height * options.enlargement;
    auto const width = frames[0].width * options.enlargement;
    auto const label_height = options.labels.empty() ? std::size_t{0} : std::size_t{9};
    auto const square = std::ceil(std::sqrt(static_cast<double>(frames.size() * height) / static_cast<double>(width)));
    auto const columns = std::clamp<std::size_t>(
        options.columns > 0 ? options.columns : static_cast<std::size_t>(square), 1, frames.size());
    auto const rows = (frames.size() + columns - 1) / columns;
    auto const row_step = height + label_height + options.margin;
    auto const column_step = width + options.margin;
    rgb8_image sheet({rows * row_step + options.margin, columns * column_step + options.margin}, options.paper);

    // Fill them
    for (std::size_t i = 0; i < frames.size(); ++i) {
        auto const top = options.margin + i / columns * row_step;
        auto const left = options.margin + i % columns * column_step;
        for (std::size_t row = 0; row < height; ++row) {
            for (std::size_t column = 0; column < width; ++column) {
                sheet.set(top + row, left + column,
                          frames[i].at(row / options.enlargement, column / options.enlargement));
            }
        }
        if (label_height > 0) {
            draw_text(sheet, options.labels[i], top + height + 1, left + 1, left + width, options.ink);
        }
    }
    return sheet;
}

} // namespace genrender::examples
