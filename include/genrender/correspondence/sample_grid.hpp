// SPDX-License-Identifier: MIT
// The fast way through a frame's kept pixels: only those around a point are looked at, in single precision.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/vectors.hpp>
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

namespace genrender::detail {

/// Whether a pixel shows a point, as far as single precision can tell.
enum class sample_verdict : std::uint8_t { shown, not_shown, unsure };

struct sample_answer {
    sample_verdict is;
    std::uint32_t number; ///< of the pixel that shows it, in the order that sample_bins brings them in
};

struct sample_judgement {
    sample_answer given;
    float canonical; ///< square of the canonical distance of the pixel that shows the point
};

/// Pixels that sample_tree visits.
inline constexpr auto visited_samples = static_cast<std::int32_t>(sample_tree<2>::visited);
/// How far squares of canonical distances may be off.
inline constexpr float square_tolerance = 1e-5F;

} // namespace genrender::detail

#define GENRENDER_KERNELS <genrender/correspondence/sample_grid.inl>
#include <genrender/core/each_target.inl>

namespace genrender {

/// Which kept pixel of a frame shows a point: of sample_tree's nearest few the one closest on the screen, where single
/// precision is enough to be sure of it. The rest it leaves to who asks.
template <std::size_t D>
class sample_grid {
public:
    using verdict = detail::sample_verdict;
    using answer = detail::sample_answer;

    sample_grid() = default;

    /// The arguments are those of sample_bins, which brings the samples in order.
    template <std::derived_from<grid_sample<D>> Sample>
    sample_grid(std::vector<Sample>& samples, double reach, double rows, double columns, double spacing)
        : bins_(samples, reach, rows, columns, spacing) {}

    /// The pixel that shows a point which was seen with a footprint.
    answer find(std::array<float, D> const& place, surface_footprint<D> const& footprint) const {
        auto const bin = bins_.bin_at(place);
        if (bins_.is_beyond_reach(place, bin, footprint)) {
            return {verdict::not_shown, 0};
        }
        auto const judge_block = GENRENDER_KERNEL(detail, judge_block<D>);
        for (std::int64_t around = 1; bin && bins_.is_precise(); around *= 2) {
            block const near(bins_, *bin, around);
            if (near.count < enough && !near.is_everything) {
                continue;
            }
            if (near.count > detail::most_measured || near.row_count > block::most_rows) {
                break;
            }
            if (auto const given = judge_block(bins_, near, place, footprint)) {
                return *given;
            }
        }
        return {verdict::unsure, 0};
    }

private:
    using block = typename sample_bins<D>::block;

    /// Pixels around a point to look at: most often the nearest few are among so many.
    static constexpr std::size_t enough = 20;

    sample_bins<D> bins_;
};

} // namespace genrender

#include <genrender/core/end_header.inl>
