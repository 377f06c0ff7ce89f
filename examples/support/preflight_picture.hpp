// SPDX-License-Identifier: MIT
// The pre-flight report as a picture: what is wrong where, and which tokens no keyframe covers.
#pragma once

#include "contact_sheet.hpp"
#include "pictures.hpp"
#include "preflight_text.hpp"

#include <genrender/inspection/pixel_check.hpp>
#include <genrender/inspection/screen_search.hpp>
#include <genrender/inspection/finite_maps.hpp>
#include <genrender/inspection/preflight.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace genrender::examples {

namespace detail {

inline constexpr rgb8 empty_colour{16, 16, 24};
inline constexpr rgb8 sound_colour{88, 92, 100};
inline constexpr rgb8 overlap_colour{230, 40, 40};
inline constexpr rgb8 seam_colour{250, 220, 40};
inline constexpr rgb8 blended_colour{240, 60, 240};
inline constexpr rgb8 not_finite_colour{255, 255, 255};
inline constexpr rgb8 uncovered_colour{235, 110, 30};
inline constexpr rgb8 covered_colour{60, 170, 90};

/// Pictures of frames whose maps are too large or too small to look at: a picture pixel is a block of map pixels.
template <canonical_maps Maps>
class preflight_pictures {
public:
    preflight_pictures(Maps const& maps, preflight_report const& report) : maps_(&maps), report_(&report) {
        auto const grid = maps.grid();
        block_ = (std::max(grid.height, grid.width) + widest - 1) / widest;
        extents_ = {(grid.height + block_ - 1) / block_, (grid.width + block_ - 1) / block_};
        for (auto const& object : report.maps.objects) {
            objects_[object.object] = &object;
        }
    }

    /// Times that a picture is enlarged to be looked at.
    std::size_t enlargement() const {
        return std::max<std::size_t>(1, widest / std::max(extents_.height, extents_.width));
    }

    /// Coordinates as red, green and, of positions, blue, on a board of squares; each object with a blue of its own.
    rgb8_image coordinates(frame_index i) const {
        return draw(
            [&](pixel p) {
                auto const point = maps_->point_at(i, p);
                if (!is_finite(point)) {
                    return not_finite_colour;
                }
                auto const object = maps_->object_at(i, p);
                auto const turns = 0.618034 * static_cast<double>(object.value + 1);
                std::array<double, 3> place{0, 0, turns - std::floor(turns)};
                std::int64_t squares = 0;
                for (std::size_t d = 0; d < point.size(); ++d) {
                    auto const& range = objects_.at(object)->range[d];
                    auto const x = Maps::dimensions == 2
                                       ? double{point[d]}
                                       : (double{point[d]} - range[0]) / (range[1] - range[0] + 1e-30);
                    place[d] = Maps::dimensions == 2 ? x - std::floor(x) : x;
                    squares += static_cast<std::int64_t>(place[d] * 8);
                }
                auto const light = squares % 2 != 0 ? 0.72 : 1.0;
                rgb8 colour{};
                for (std::size_t c = 0; c < 3; ++c) {
                    colour[c] = to_byte(static_cast<float>(light * (0.2 + 0.8 * place[c])));
                }
                return colour;
            },
            i);
    }

    /// What is wrong with each pixel; the worst of a block shows.
    rgb8_image flags(frame_index i) const {
        screen_search<Maps> const search(*maps_, i);
        return draw(
            [&](pixel p) {
                auto colour = sound_colour;
                if (is_finite(maps_->point_at(i, p))) {
                    auto const claims = claims_on(*maps_, search, i, p, objects_.at(maps_->object_at(i, p))->side);
                    colour = claims && claims->any() ? overlap_colour : colour;
                }
                // Lines are thinner than a block: look at up to 4 x 4 of its pixels.
                auto const step = std::max<std::size_t>(1, block_ / 4);
                auto const top = p.row / block_ * block_;
                auto const left = p.column / block_ * block_;
                auto rank = 0;
                for (auto row = top; row < std::min(top + block_, maps_->grid().height); row += step) {
                    for (auto column = left; column < std::min(left + block_, maps_->grid().width); column += step) {
                        pixel const q{static_cast<std::uint32_t>(row), static_cast<std::uint32_t>(column)};
                        auto const flag = line_flag(i, q);
                        if (flag.first > rank) {
                            rank = flag.first;
                            colour = flag.second;
                        }
                    }
                }
                return colour;
            },
            i);
    }

    /// Tokens of the finest grid in the k-th frame looked at: the more of the steps cover one, the greener it is.
    rgb8_image cover(std::size_t k) const {
        auto const& grids = report_->grids;
        if (grids.empty() || grids.front().refusal || k >= grids.front().cover.size()) {
            return rgb8_image(extents_, empty_colour);
        }
        auto const& check = grids.front();
        auto const cell_height = maps_->grid().height / check.grid.height;
        auto const cell_width = maps_->grid().width / check.grid.width;
        rgb8_image image(extents_, empty_colour);
        for (std::size_t row = 0; row < extents_.height; ++row) {
            for (std::size_t column = 0; column < extents_.width; ++column) {
                auto const p = middle_of(row, column);
                auto const token = p.row / cell_height * check.grid.width + p.column / cell_width;
                if (auto const steps = check.cover[k].steps[token]) {
                    auto const share = share_of(*steps, report_->steps.size());
                    rgb8 colour{};
                    for (std::size_t c = 0; c < 3; ++c) {
                        colour[c] = static_cast<std::uint8_t>(
                            std::lround((1 - share) * uncovered_colour[c] + share * covered_colour[c]));
                    }
                    image.set(row, column, colour);
                }
            }
        }
        return image;
    }

private:
    static constexpr std::size_t widest = 256;

    pixel middle_of(std::size_t row, std::size_t column) const {
        return {static_cast<std::uint32_t>(std::min(row * block_ + block_ / 2, maps_->grid().height - 1)),
                static_cast<std::uint32_t>(std::min(column * block_ + block_ / 2, maps_->grid().width - 1))};
    }

    template <class Colour>
    rgb8_image draw(Colour const& colour_of, frame_index i) const {
        rgb8_image image(extents_, empty_colour);
        for (std::size_t row = 0; row < extents_.height; ++row) {
            for (std::size_t column = 0; column < extents_.width; ++column) {
                auto const p = middle_of(row, column);
                if (maps_->is_covered(i, p)) {
                    image.set(row, column, colour_of(p));
                }
            }
        }
        return image;
    }

    /// How bad what runs through a pixel is, and its colour; 0 for nothing.
    std::pair<int, rgb8> line_flag(frame_index i, pixel p) const {
        if (!maps_->is_covered(i, p)) {
            return {0, sound_colour};
        }
        if (!is_finite(maps_->point_at(i, p))) {
            return {3, not_finite_colour};
        }
        auto const side = objects_.at(maps_->object_at(i, p))->side;
        if (is_blended_edge(*maps_, i, p, side).value_or(false)) {
            return {2, blended_colour};
        }
        auto const is_beside_seam =
            is_seam(*maps_, i, p, {0, 1}, side).value_or(false) || is_seam(*maps_, i, p, {1, 0}, side).value_or(false);
        return {is_beside_seam ? 1 : 0, seam_colour};
    }

    Maps const* maps_;
    preflight_report const* report_;
    std::size_t block_ = 1;
    grid_extents extents_;
    std::map<object_index, object_check const*> objects_;
};

/// A strip of coloured squares with their meaning, below `image`.
inline rgb8_image with_legend(rgb8_image const& image) {
    constexpr std::array<std::pair<rgb8, std::string_view>, 6> entries{
        {{overlap_colour, "shown twice (overlap, mirror, tile)"},
         {seam_colour, "seam"},
         {blended_colour, "antialiased edge"},
         {not_finite_colour, "not finite"},
         {covered_colour, "token covered by keyframes"},
         {uncovered_colour, "not covered"}}};
    // As many entries in a line as fit
    std::vector<std::pair<std::size_t, std::size_t>> places;
    std::size_t line = 0;
    std::size_t column = 4;
    for (auto const& [colour, meaning] : entries) {
        auto const width = 24 + 6 * meaning.size();
        if (column > 4 && column + width > image.width) {
            ++line;
            column = 4;
        }
        places.emplace_back(line, column);
        column += width;
    }
    constexpr std::size_t line_height = 14;
    rgb8_image sheet({image.height + (line + 1) * line_height + 4, image.width}, {48, 48, 48});
    std::copy(image.bytes.begin(), image.bytes.end(), sheet.bytes.begin());
    for (std::size_t e = 0; e < entries.size(); ++e) {
        auto const top = image.height + 2 + places[e].first * line_height;
        auto const left = places[e].second;
        for (std::size_t y = 0; y < 9; ++y) {
            for (std::size_t x = 0; x < 9 && left + x < sheet.width; ++x) {
                sheet.set(top + y, left + x, entries[e].first);
            }
        }
        draw_text(sheet, entries[e].second, top + 1, left + 13, sheet.width, {230, 230, 230});
    }
    return sheet;
}

} // namespace detail

/// One row for each of at most 6 frames: its coordinates, what is wrong with its pixels, and which tokens of the finest
/// grid the keyframes cover; a legend below.
template <canonical_maps Maps>
rgb8_image preflight_picture(Maps const& maps, preflight_report const& report) {
    auto const& looked_at = report.maps.looked_at;
    if (looked_at.empty() || maps.grid().size() == 0) {
        rgb8_image image({20, 256}, detail::empty_colour);
        draw_text(image, "no pixels to look at", 6, 6, image.width, {230, 230, 230});
        return image;
    }
    detail::preflight_pictures<Maps> const pictures(maps, report);
    std::vector<rgb8_image> images;
    std::vector<std::string> labels;
    for (auto const chosen : spread_frames(looked_at.size(), 6)) {
        auto const i = looked_at[chosen.value];
        images.push_back(pictures.coordinates(i));
        images.push_back(pictures.flags(i));
        images.push_back(pictures.cover(chosen.value));
        auto const name = "frame " + std::to_string(i.value);
        labels.insert(
            labels.end(),
            {name + ": coordinates", name + ": defects",
             name + ": tokens" + (report.grids.empty() ? "" : " " + detail::extents_name(report.grids.front().grid))});
    }
    return detail::with_legend(contact_sheet(
        images, {.columns = 3, .margin = 4, .enlargement = pictures.enlargement(), .labels = std::move(labels)}));
}

} // namespace genrender::examples
