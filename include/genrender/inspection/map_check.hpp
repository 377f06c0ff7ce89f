// SPDX-License-Identifier: MIT
// [GR sec. 3] What maps tell of themselves before they are worked with: defects of every object, contents of every
// frame.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/parallel.hpp>
#include <genrender/maps/canonical_maps.hpp>
#include <genrender/inspection/frame_inspection.hpp>
#include <genrender/inspection/object_check.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>
#include <numeric>
#include <utility>
#include <vector>

namespace genrender {

/// The answer of check_maps.
struct map_check {
    std::size_t dimensions = 0;         ///< components of a coordinate: 2 for UVs, 3 for positions at rest
    grid_extents grid;                  ///< pixels of a frame
    std::vector<frame_check> frames;    ///< one a frame, in order
    std::vector<object_check> objects;  ///< by number
    std::vector<frame_index> looked_at; ///< frames of the sample

    /// Covered pixels whose coordinate is not finite, of all objects.
    std::size_t not_finite() const {
        std::size_t count = 0;
        for (auto const& object : objects) {
            count += object.not_finite;
        }
        return count;
    }
};

/// At most `most` of `count` frames, evenly spread, the first among them.
inline std::vector<frame_index> spread_frames(std::size_t count, std::size_t most) {
    auto const chosen = std::min(count, most);
    std::vector<frame_index> frames;
    for (std::size_t k = 0; k < chosen; ++k) {
        frames.push_back({static_cast<std::uint32_t>(k * count / chosen)});
    }
    return frames;
}

namespace detail {

/// The median; 0 of nothing.
inline double median_of(std::vector<double>& values) {
    if (values.empty()) {
        return 0;
    }
    auto const middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

/// The mean of the middle half, which neither a few leaps nor levels disturb; 0 of nothing.
inline double middle_mean_of(std::vector<double>& values) {
    std::sort(values.begin(), values.end());
    auto const cut = static_cast<std::ptrdiff_t>(values.size() / 4);
    auto const count = static_cast<std::ptrdiff_t>(values.size()) - 2 * cut;
    return count > 0 ? std::accumulate(values.begin() + cut, values.end() - cut, 0.0) / static_cast<double>(count) : 0;
}

/// Appends what one frame gathered to what the others did.
template <class Number>
void append(std::vector<Number>& all, std::vector<Number> const& more) {
    all.insert(all.end(), more.begin(), more.end());
}

/// Adds the counts of all pixels of one frame.
inline void add_counts(object_check& all, object_check const& one) {
    all.pixels += one.pixels;
    append(all.frames, one.frames);
    all.not_finite += one.not_finite;
    append(all.not_finite_frames, one.not_finite_frames);
    all.out_of_range += one.out_of_range;
    if (all.range.empty()) {
        all.range = one.range;
    }
    for (std::size_t d = 0; d < one.range.size(); ++d) {
        all.range[d] = {std::min(all.range[d][0], one.range[d][0]), std::max(all.range[d][1], one.range[d][1])};
    }
}

/// Adds the counts of the sample of one frame.
inline void add_sample(object_check& all, object_check const& one) {
    all.looked_at += one.looked_at;
    all.without_footprint += one.without_footprint;
    all.pairs += one.pairs;
    all.seams += one.seams;
    all.edges += one.edges;
    all.blended_edges += one.blended_edges;
    all.asked += one.asked;
    all.overlapping += one.overlapping;
    all.mirrored += one.mirrored;
}

} // namespace detail

/// Looks at maps without judging them: never throws for what they hold, and does not depend on the threads of `loop`.
/// Time grows with the number of pixels only as counting does; memory beyond the maps does not.
template <canonical_maps Maps>
map_check check_maps(Maps const& maps, map_check_settings const& settings = {}, any_loop const& loop = {}) {
    constexpr auto D = Maps::dimensions;
    using inspection = frame_inspection<Maps>;
    std::size_t const count = maps.frame_count();
    map_check result{D, maps.grid(), {}, {}, spread_frames(count, settings.frames)};
    std::map<object_index, object_check> objects;

    // Count all pixels
    std::vector<inspection> frames(count);
    loop(count, [&](std::size_t i) { frames[i].count(maps, {static_cast<std::uint32_t>(i)}); });
    std::map<object_index, texture_tiles> tiles;
    for (auto& one : frames) {
        for (auto const& [number, object] : one.objects) {
            objects[number].object = number;
            detail::add_counts(objects[number], object);
            tiles[number].add(one.tiles[number]);
        }
        result.frames.push_back(one.frame);
    }

    // Gather what medians are taken of
    auto const& sample = result.looked_at;
    loop(sample.size(), [&](std::size_t k) { frames[sample[k].value].gather(maps, sample[k], settings.pixels); });
    std::map<object_index, typename inspection::object_values> values;
    for (auto const i : sample) {
        for (auto const& [number, one] : frames[i.value].values) {
            auto& all = values[number];
            detail::append(all.sides, one.sides);
            detail::append(all.long_sides, one.long_sides);
            for (std::size_t d = 0; d < D; ++d) {
                detail::append(all.values[d], one.values[d]);
                detail::append(all.bends[d], one.bends[d]);
                detail::append(all.slopes[d], one.slopes[d]);
            }
        }
    }
    for (auto& [number, object] : objects) {
        auto& of = values[number];
        // Where most pixels have no footprint, those that have tell of leaps between levels.
        auto const is_flat = 2 * of.sides.size() < of.values[0].size() && !of.long_sides.empty();
        object.side = is_flat ? detail::middle_mean_of(of.long_sides) : detail::median_of(of.sides);
        object.tiled = tiles[number].repeated();
        for (std::size_t d = 0; d < D; ++d) {
            auto const slope = of.slopes[d].empty() ? object.side : detail::middle_mean_of(of.slopes[d]);
            auto const has_range = !object.range.empty();
            auto const origin = D == 2 || !has_range ? 0.0 : object.range[d][0];
            auto const extent = D == 2 || !has_range ? 1.0 : object.range[d][1] - object.range[d][0];
            object.levels.push_back(levels_of(std::move(of.values[d]), of.bends[d], slope, origin, extent));
        }
    }

    // Compare neighbours and search for points shown twice
    std::vector<std::map<object_index, object_check>> compared(sample.size());
    loop(sample.size(), [&](std::size_t k) {
        compared[k] = compare_pixels(maps, sample[k], settings, result.frames[sample[k].value], objects);
    });
    for (auto const& one : compared) {
        for (auto const& [number, object] : one) {
            detail::add_sample(objects[number], object);
        }
    }
    for (auto& [number, object] : objects) {
        result.objects.push_back(std::move(object));
    }
    return result;
}

} // namespace genrender

#include <genrender/core/end_header.inl>
