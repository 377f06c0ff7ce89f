// SPDX-License-Identifier: MIT
// What a block of kept pixels tells of a surface point, with the vectors of one target.

namespace genrender::detail::GENRENDER_TARGET {

/// Of the pixels whose squares of the canonical distance are at most `radius`.
template <std::size_t D>
sample_judgement judge_within(sample_distances<D> const& found, float radius, float reach) {
    auto const best = found.closest_within(radius);
    if (best > reach + sample_distances<D>::tolerance) {
        return {{sample_verdict::not_shown, 0}, 0};
    }
    if (best >= 0 && best < reach - sample_distances<D>::tolerance) {
        // There must be one alone that is as close.
        if (auto const only = found.only_one_within(radius, best + sample_distances<D>::tolerance)) {
            return {{sample_verdict::shown, only->first}, only->second};
        }
    }
    return {{sample_verdict::unsure, 0}, 0};
}

/// Square of a canonical distance within which lie as many pixels as the tree visits; none if two are about as far
/// and only one is among them.
template <std::size_t D>
std::optional<float> radius_of_visited(sample_distances<D> const& found) {
    auto radius = -1.0F;
    for (std::int32_t within = 0; within < visited_samples;) {
        radius = found.next_beyond(radius);
        if (radius == std::numeric_limits<float>::infinity()) {
            return std::numeric_limits<float>::infinity();
        }
        within = found.count_within(radius);
        if (within > visited_samples) {
            return std::nullopt;
        }
    }
    return found.next_beyond(radius) > radius * (1 + square_tolerance) ? std::optional(radius) : std::nullopt;
}

/// Of all pixels measured, if that is the same as of the nearest few, else of these.
template <std::size_t D>
sample_answer judge(sample_distances<D> const& found, float reach) {
    auto const of_all = judge_within(found, std::numeric_limits<float>::infinity(), reach);
    if (of_all.given.is == sample_verdict::not_shown) {
        return of_all.given;
    }
    if (of_all.given.is == sample_verdict::shown &&
        found.count_within(of_all.canonical * (1 + square_tolerance)) <= visited_samples) {
        return of_all.given;
    }
    auto const radius = radius_of_visited(found);
    return radius ? judge_within(found, *radius, reach).given : sample_answer{sample_verdict::unsure, 0};
}

/// Measures a block of bins around a point that was seen with a footprint, and judges; nothing if fewer pixels than the
/// tree visits are sure to be the nearest ones.
template <std::size_t D>
std::optional<sample_answer> judge_block(sample_bins<D> const& bins, typename sample_bins<D>::block const& near,
                                         std::array<float, D> const& place, surface_footprint<D> const& footprint) {
    sample_distances<D> const found(bins, near, place, footprint);
    if (!near.is_everything && found.count_inside() < visited_samples) {
        return std::nullopt;
    }
    return judge(found, bins.reach());
}

} // namespace genrender::detail::GENRENDER_TARGET
