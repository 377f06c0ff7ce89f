// SPDX-License-Identifier: MIT
// [GR sec. 3.4] Mean and deviation of each channel of a frame's latents over the background.
#pragma once

#include <genrender/core/register_vector.hpp>
#include <genrender/core/strided_view.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <vector>

namespace genrender {

/// Mean and standard deviation per channel, and the number of pixels they come from.
template <class Real>
struct channel_statistics {
    std::vector<Real> mean;
    std::vector<Real> deviation;
    std::size_t pixels = 0;
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

/// Sums of (value - origin) and of its square over the values whose bits are kept, in double precision.
template <class Real, class Bits>
std::array<double, 2> moments_of_kept(Real const* values, Bits const* kept, std::size_t count, double origin) {
    std::array<double, 2> sums{};
    std::size_t e = 0;
#if defined(__GNUC__)
    constexpr auto lanes = register_lanes<double>;
    using doubles = register_vector<double, lanes>;
    using whole = register_vector<std::int64_t, lanes>;
    using narrow = register_vector<std::make_signed_t<Bits>, lanes>;
    auto const differences = [&](std::size_t at) {
        auto const mask = load_as<narrow>(kept + at);
        // What is hidden may be no number: first it becomes 0, then its difference does.
        auto const value = bits_as<register_vector<Real, lanes>>(load_as<narrow>(values + at) & mask);
        doubles const difference = __builtin_convertvector(value, doubles) - origin;
        whole const wide = __builtin_convertvector(mask, whole);
        return bits_as<doubles>(bits_as<whole>(difference) & wide);
    };
    // Two sums of each, since an addition takes longer than the rest.
    std::array<doubles, 2> first{};
    std::array<doubles, 2> second{};
    for (; e + 2 * lanes <= count; e += 2 * lanes) {
        for (std::size_t half = 0; half < 2; ++half) {
            auto const difference = differences(e + half * lanes);
            first[half] += difference;
            second[half] += difference * difference;
        }
    }
    first[0] += first[1];
    second[0] += second[1];
    for (std::size_t lane = 0; lane < lanes; ++lane) {
        sums[0] += first[0][lane];
        sums[1] += second[0][lane];
    }
#endif
    for (; e < count; ++e) {
        if (kept[e] != 0) {
            auto const difference = static_cast<double>(values[e]) - origin;
            sums[0] += difference;
            sums[1] += difference * difference;
        }
    }
    return sums;
}

} // namespace detail

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
    std::vector<bits> kept(mask.size());
    for (std::size_t e = 0; e < kept.size(); ++e) {
        bits const is_kept = mask_values[e] != 0 ? 1 : 0;
        kept[e] = bits{0} - is_kept;
        result.pixels += is_kept;
    }
    if (result.pixels < 2) {
        return result;
    }
    auto const n = static_cast<double>(result.pixels);
    auto const first = static_cast<std::size_t>(std::find(kept.begin(), kept.end(), ~bits{0}) - kept.begin());
    std::vector<Real> gathered;
    for (std::size_t c = 0; c < channels; ++c) {
        auto const* const values = detail::neighbouring_values(z[c], gathered);
        // One pass around a value of the background, and where that lies far off another around the mean: the variance
        // of a nearly constant background must not drown in its mean.
        auto origin = static_cast<double>(values[first]);
        auto [sum, squares] = detail::moments_of_kept(values, kept.data(), kept.size(), origin);
        if (sum * sum / n > 0.999 * squares) {
            origin += sum / n;
            auto const again = detail::moments_of_kept(values, kept.data(), kept.size(), origin);
            sum = again[0];
            squares = again[1];
        }
        auto const mean = origin + sum / n;
        squares = std::max(0.0, squares - sum * sum / n);
        result.mean[c] = static_cast<Real>(mean);
        result.deviation[c] = static_cast<Real>(std::sqrt(squares / (n - 1) + static_cast<double>(epsilon)));
    }
    return result;
}

} // namespace genrender
