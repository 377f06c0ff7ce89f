// SPDX-License-Identifier: MIT
// [GR sec. 3] One frame's share of what is told of its objects: counts of all pixels, samples of neighbours and claims.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/finite.hpp>
#include <genrender/correspondence/surface_footprint.hpp>
#include <genrender/maps/canonical_maps.hpp>
#include <genrender/inspection/object_check.hpp>
#include <genrender/inspection/pixel_check.hpp>
#include <genrender/inspection/pixel_lattice.hpp>
#include <genrender/inspection/screen_search.hpp>
#include <genrender/inspection/texture_tiles.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <vector>

namespace genrender {

/// How closely maps are looked at. Counts of pixels are always of all of them; shares of neighbours and of points shown
/// twice are of a sample where the maps are large.
struct map_check_settings {
    std::size_t frames = 16;                   ///< evenly spread, at most
    std::size_t pixels = std::size_t{1} << 18; ///< of a frame whose neighbours are looked at, at most
    std::size_t questions = 4096;              ///< of a frame whose points are searched for, about
};

/// One frame's share of the checks of its objects.
template <canonical_maps Maps>
class frame_inspection {
    static constexpr auto D = Maps::dimensions;

public:
    /// What is measured at an object's pixels, for medians over all frames.
    struct object_values {
        std::vector<double> sides;                 ///< of footprints, canonical units
        std::vector<double> long_sides;            ///< over 8 pixels, where rounding hides what one pixel changes
        std::array<std::vector<float>, D> values;  ///< each coordinate
        std::array<std::vector<float>, D> bends;   ///< second differences of each coordinate across
        std::array<std::vector<double>, D> slopes; ///< the steeper of the changes of each coordinate across and down
    };

    frame_check frame;                            ///< counts of the frame
    std::map<object_index, object_check> objects; ///< counts of each object in it
    std::map<object_index, texture_tiles> tiles;  ///< parts of each object's texture that it shows
    std::map<object_index, object_values> values; ///< values measured at each object's pixels

    /// Counts every pixel.
    void count(Maps const& maps, frame_index i) {
        frame.pixels = maps.grid().size();
        frame.same_as_previous = i.value > 0;
        object_check* object = nullptr;
        texture_tiles* used = nullptr;
        for (std::uint32_t row = 0; row < maps.grid().height; ++row) {
            for (std::uint32_t column = 0; column < maps.grid().width; ++column) {
                pixel const p{row, column};
                frame.same_as_previous = frame.same_as_previous && shows_the_same(maps, {i.value - 1}, i, p);
                if (!maps.is_covered(i, p)) {
                    continue;
                }
                ++frame.covered;
                auto const number = maps.object_at(i, p);
                if (!object || object->object != number) {
                    object = &objects[number];
                    object->object = number;
                    used = &tiles[number];
                }
                ++object->pixels;
                count_point(*object, *used, maps.point_at(i, p));
            }
        }
        for (auto& [number, seen] : objects) {
            frame.objects.push_back(number);
            seen.frames.push_back(i);
            if (seen.not_finite > 0) {
                seen.not_finite_frames.push_back(i);
            }
        }
    }

    /// Gathers what medians are taken of.
    void gather(Maps const& maps, frame_index i, std::size_t pixels) {
        pixel_lattice(maps.grid(), std::min<std::size_t>(pixels, std::size_t{1} << 14)).visit_pixels([&](pixel p) {
            if (!maps.is_covered(i, p) || !is_finite(maps.point_at(i, p))) {
                return;
            }
            auto& of = values[maps.object_at(i, p)];
            auto const here = maps.point_at(i, p);
            if (auto const footprint = footprint_at(maps, i, p)) {
                of.sides.push_back(std::sqrt(footprint->area()));
            }
            constexpr std::int64_t lag = 8;
            std::array<double, D> steepest{};
            auto is_long = false;
            for (auto const step : {pixel_step{0, lag}, pixel_step{lag, 0}}) {
                if (auto const there = point_beside(maps, i, p, step)) {
                    is_long = true;
                    of.long_sides.push_back(distance_between(here, *there) / lag);
                    for (std::size_t d = 0; d < D; ++d) {
                        steepest[d] = std::max(steepest[d], std::abs(double{(*there)[d]} - double{here[d]}) / lag);
                    }
                }
            }
            auto const left = point_beside(maps, i, p, {0, -1});
            auto const right = point_beside(maps, i, p, {0, 1});
            for (std::size_t d = 0; d < D; ++d) {
                of.values[d].push_back(here[d]);
                if (is_long) {
                    of.slopes[d].push_back(steepest[d]);
                }
                if (left && right) {
                    of.bends[d].push_back((*right)[d] - 2 * here[d] + (*left)[d]);
                }
            }
        });
    }

private:
    static bool shows_the_same(Maps const& maps, frame_index a, frame_index b, pixel p) {
        return maps.is_covered(a, p) == maps.is_covered(b, p) &&
               (!maps.is_covered(a, p) ||
                (maps.object_at(a, p) == maps.object_at(b, p) && maps.point_at(a, p) == maps.point_at(b, p)));
    }

    static void count_point(object_check& object, texture_tiles& used, std::array<float, D> const& point) {
        if (!is_finite(point)) {
            ++object.not_finite;
            return;
        }
        if (object.range.empty()) {
            object.range.assign(D, {std::numeric_limits<double>::max(), std::numeric_limits<double>::lowest()});
        }
        auto is_inside = true;
        for (std::size_t d = 0; d < D; ++d) {
            object.range[d][0] = std::min(object.range[d][0], double{point[d]});
            object.range[d][1] = std::max(object.range[d][1], double{point[d]});
            is_inside = is_inside && point[d] >= 0 && point[d] <= 1;
        }
        if constexpr (D == 2) {
            object.out_of_range += !is_inside;
            used.add(point);
        }
    }
};

/// Looks at neighbours in frame i and searches for points shown twice. `frame` and `objects` are what is known of the
/// frame and, of all frames, of the side of every object's pixels. Only what is counted here is filled in.
template <canonical_maps Maps>
std::map<object_index, object_check> compare_pixels(Maps const& maps, frame_index i, map_check_settings const& settings,
                                                    frame_check const& frame,
                                                    std::map<object_index, object_check> const& objects) {
    std::map<object_index, object_check> result;
    auto const is_shown = [&](pixel p) { return maps.is_covered(i, p) && is_finite(maps.point_at(i, p)); };
    pixel_lattice(maps.grid(), settings.pixels).visit_pixels([&](pixel p) {
        if (!is_shown(p)) {
            return;
        }
        auto& object = result[maps.object_at(i, p)];
        auto const side = objects.at(maps.object_at(i, p)).side;
        ++object.looked_at;
        object.without_footprint += !footprint_at(maps, i, p);
        for (auto const step : {pixel_step{0, 1}, pixel_step{1, 0}}) {
            auto const seam = is_seam(maps, i, p, step, side);
            object.pairs += seam.has_value();
            object.seams += seam.value_or(false);
        }
        auto const blended = is_blended_edge(maps, i, p, side);
        object.edges += blended.has_value();
        object.blended_edges += blended.value_or(false);
    });
    // Questions are for covered pixels, of which a lattice meets its share.
    auto const covered = std::max(0.02, share_of(frame.covered, frame.pixels));
    auto const questions = static_cast<double>(settings.questions) / covered;
    screen_search<Maps> const search(maps, i);
    pixel_lattice(maps.grid(), static_cast<std::size_t>(questions)).visit_pixels([&](pixel p) {
        if (is_shown(p)) {
            auto& object = result[maps.object_at(i, p)];
            auto const claims = claims_on(maps, search, i, p, objects.at(maps.object_at(i, p)).side);
            object.asked += claims.has_value();
            object.overlapping += claims && claims->same;
            object.mirrored += claims && claims->mirrored;
        }
    });
    return result;
}

} // namespace genrender

#include <genrender/core/end_header.inl>
