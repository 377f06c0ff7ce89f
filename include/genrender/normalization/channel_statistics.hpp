// SPDX-License-Identifier: MIT
// [GR sec. 3.4] Mean and deviation of each channel of a frame's latents over the background.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/instance.hpp>
#include <genrender/core/strided_view.hpp>
#include <genrender/core/vectors.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <type_traits>
#include <vector>

namespace genrender {

/// Mean and standard deviation per channel, and the number of pixels they come from.
template <class Real>
struct channel_statistics {
    std::vector<Real> mean;      ///< [channels]
    std::vector<Real> deviation; ///< [channels], > 0
    std::size_t pixels = 0;      ///< how many they come from
};

namespace detail {

/// The elements of a view row by row: where they are if they are so already, else copied to `room`.
template <class T>
T const* neighbouring_values(strided_view<T const, 2> const& view, std::vector<T>& room) {
    if (view.is_contiguous()) {
        return view.data();
    }
    room.resize(view.size());
    copy(strided_view<T, 2>(room.data(), view.extents()), view);
    return room.data();
}

} // namespace detail

} // namespace genrender

#define GENRENDER_KERNELS <genrender/normalization/channel_statistics.inl>
#include <genrender/core/each_target.inl>

namespace genrender {

inline namespace GENRENDER_UNIT {

/// Statistics of z [channels, height, width] over the pixels whose `mask` [height, width] is not 0: mean and
/// sqrt(unbiased variance + epsilon). With fewer than 2 pixels there is no variance: `pixels` says so and means and
/// deviations are 0 and 1. Throws shape_error if the mask does not fit.
template <class Real>
channel_statistics<Real> masked_statistics(strided_view<Real const, 3> z, strided_view<std::uint8_t const, 2> mask,
                                           std::type_identity_t<Real> epsilon = Real(1e-5)) {
    auto const channels = z.extent(0);
    require_shape("masked_statistics", "mask", mask, {z.extent(1), z.extent(2)});
    channel_statistics<Real> result{std::vector<Real>(channels, Real{0}), std::vector<Real>(channels, Real{1}), 0};
    // The mask as bits to keep of each value: what is hidden is not read as a number, and the same for all channels.
    using bits = std::conditional_t<sizeof(Real) == 8, std::uint64_t, std::uint32_t>;
    std::vector<std::uint8_t> gathered_mask;
    auto const* const mask_values = detail::neighbouring_values(mask, gathered_mask);
    auto const kept = std::make_unique_for_overwrite<bits[]>(mask.size());
    auto const first = GENRENDER_KERNEL(detail, keep_bits<bits>)(kept.get(), result.pixels, mask_values, mask.size());
    if (result.pixels < 2) {
        return result;
    }
    auto const n = static_cast<double>(result.pixels);
    std::vector<Real> gathered;
    auto const add_up = GENRENDER_KERNEL(detail, moments_of_kept<Real, bits>);
    for (std::size_t c = 0; c < channels; ++c) {
        auto const* const values = detail::neighbouring_values(z[c], gathered);
        auto const moments_around = [&](Real origin) { return add_up(values, kept.get(), mask.size(), origin); };
        // One pass around a value of the background, and where that lies far off another around the mean: the variance
        // of a nearly constant background must not drown in its mean.
        auto origin = values[first];
        auto moments = moments_around(origin);
        if (moments[0] * moments[0] / n > 0.9 * moments[1]) {
            origin += static_cast<Real>(moments[0] / n);
            moments = moments_around(origin);
        }
        // Squares of very small and very large numbers have no place among numbers of single precision.
        if (!(moments[1] > 1e-30 * n && moments[1] < 1e30)) {
            origin = values[first];
            moments =
                detail::baseline::exact_moments_of_kept(values, kept.get(), mask.size(), static_cast<double>(origin));
        }
        auto const [sum, squares] = moments;
        auto const variance = std::max(0.0, squares - sum * sum / n) / (n - 1);
        result.mean[c] = static_cast<Real>(static_cast<double>(origin) + sum / n);
        result.deviation[c] = static_cast<Real>(std::sqrt(variance + static_cast<double>(epsilon)));
    }
    return result;
}

GENRENDER_INSTANCE(masked_statistics<float>);
GENRENDER_INSTANCE(masked_statistics<double>);

} // namespace GENRENDER_UNIT

} // namespace genrender

#include <genrender/core/end_header.inl>
