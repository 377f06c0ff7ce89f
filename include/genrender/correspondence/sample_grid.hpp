// SPDX-License-Identifier: MIT
// The fast way through a frame's kept pixels: only those around a point are looked at, in single precision.
#pragma once

#include <genrender/correspondence/sample_bins.hpp>
#include <genrender/correspondence/sample_distances.hpp>
#include <genrender/correspondence/sample_tree.hpp>

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

namespace genrender {

/// Which kept pixel of a frame shows a point: of sample_tree's nearest few the one closest on the screen, where single
/// precision is enough to be sure of it. The rest it leaves to who asks.
template <std::size_t D>
class sample_grid {
public:
    enum class verdict : std::uint8_t { shown, not_shown, unsure };
    struct answer {
        verdict is;
        std::uint32_t number; ///< of the pixel that shows it, in the order that sample_bins brings them in
    };

    sample_grid() = default;

    /// The arguments are those of sample_bins, which brings the samples in order.
    template <std::derived_from<grid_sample<D>> Sample>
    sample_grid(std::vector<Sample>& samples, double reach, double rows, double columns, double spacing)
        : bins_(samples, reach, rows, columns, spacing) {}

    /// The pixel that shows a point which was seen with a footprint.
    answer find([[maybe_unused]] std::array<float, D> const& place,
                [[maybe_unused]] surface_footprint<D> const& footprint) const {
#if defined(__GNUC__)
        auto const bin = bins_.bin_at(place);
        if (bins_.is_beyond_reach(place, bin, footprint)) {
            return {verdict::not_shown, 0};
        }
        for (std::int64_t around = 1; bin && bins_.is_precise(); around *= 2) {
            block const near(bins_, *bin, around);
            if (near.count >= enough || near.is_everything) {
                if (near.count > distances::most || near.row_count > block::most_rows) {
                    break;
                }
                distances const found(bins_, near, place, footprint);
                if (near.is_everything || found.count_inside() >= visited) {
                    return judge(found);
                }
            }
        }
#endif
        return {verdict::unsure, 0};
    }

private:
    using block = typename sample_bins<D>::block;

    /// Pixels around a point to look at: most often the nearest few are among so many.
    static constexpr std::size_t enough = 20;

#if defined(__GNUC__)
    using distances = sample_distances<D>;

    static constexpr auto infinity = std::numeric_limits<float>::infinity();
    static constexpr auto visited = static_cast<std::int32_t>(sample_tree<D>::visited);
    /// How far squares of canonical distances may be off.
    static constexpr float square_tolerance = 1e-5F;

    /// Of all pixels measured, if that is the same as of the nearest few, else of these.
    answer judge(distances const& found) const {
        auto const of_all = judge_within(found, infinity);
        if (of_all.given.is == verdict::not_shown) {
            return of_all.given;
        }
        if (of_all.given.is == verdict::shown &&
            found.count_within(of_all.canonical * (1 + square_tolerance)) <= visited) {
            return of_all.given;
        }
        auto const radius = radius_of_visited(found);
        return radius ? judge_within(found, *radius).given : answer{verdict::unsure, 0};
    }

    struct judgement {
        answer given;
        float canonical; ///< square of the canonical distance of the pixel that shows the point
    };

    /// Of the pixels whose squares of the canonical distance are at most `radius`.
    judgement judge_within(distances const& found, float radius) const {
        auto const best = found.closest_within(radius);
        if (best > bins_.reach() + distances::tolerance) {
            return {{verdict::not_shown, 0}, 0};
        }
        if (best >= 0 && best < bins_.reach() - distances::tolerance) {
            // There must be one alone that is as close.
            if (auto const only = found.only_one_within(radius, best + distances::tolerance)) {
                return {{verdict::shown, only->first}, only->second};
            }
        }
        return {{verdict::unsure, 0}, 0};
    }

    /// Square of a canonical distance within which lie as many pixels as the tree visits; none if two are about as far
    /// and only one is among them.
    static std::optional<float> radius_of_visited(distances const& found) {
        auto radius = -1.0F;
        for (std::int32_t within = 0; within < visited;) {
            radius = found.next_beyond(radius);
            if (radius == infinity) {
                return infinity;
            }
            within = found.count_within(radius);
            if (within > visited) {
                return std::nullopt;
            }
        }
        return found.next_beyond(radius) > radius * (1 + square_tolerance) ? std::optional(radius) : std::nullopt;
    }
#endif

    sample_bins<D> bins_;
};

} // namespace genrender
