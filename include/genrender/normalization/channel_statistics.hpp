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
#include <memory>
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

/// Writes all bits to `kept` where a pixel of the mask is not 0, and none where it is; counts such pixels in `pixels`,
/// 0 before, and returns the first of them, `count` if there is none.
template <class Bits>
std::size_t keep_bits(Bits* kept, std::size_t& pixels, std::uint8_t const* mask, std::size_t count) {
    auto first = count;
    constexpr std::size_t block = 128;
    for (std::size_t begin = 0; begin < count; begin += block) {
        auto const end = std::min(count, begin + block);
        Bits minus_pixels = 0;
        for (auto e = begin; e < end; ++e) {
            auto const bits = Bits{0} - Bits{mask[e] != 0};
            kept[e] = bits;
            minus_pixels += bits;
        }
        if (pixels == 0 && minus_pixels != 0) {
            first = static_cast<std::size_t>(std::find(kept + begin, kept + end, ~Bits{0}) - kept);
        }
        pixels += Bits{0} - minus_pixels;
    }
    return first;
}

/// Sums of (value - origin) and of its square over the values whose bits are kept, in double precision one by one.
template <class Real, class Bits>
std::array<double, 2> exact_moments_of_kept(Real const* values, Bits const* kept, std::size_t count, double origin) {
    std::array<double, 2> sums{};
    for (std::size_t e = 0; e < count; ++e) {
        if (kept[e] != 0) {
            auto const difference = static_cast<double>(values[e]) - origin;
            sums[0] += difference;
            sums[1] += difference * difference;
        }
    }
    return sums;
}

/// The same in the precision of the values, where differences are exact to their own last bit, and no more than a few
/// added up before the sums go on in double precision.
template <class Real, class Bits>
std::array<double, 2> moments_of_kept(Real const* values, Bits const* kept, std::size_t count, Real origin) {
    std::size_t e = 0;
    std::array<double, 2> sums{};
#if defined(__GNUC__)
    constexpr auto lanes = register_lanes<Real>;
    using reals = register_vector<Real>;
    using bits = register_vector<Bits>;
    // An addition takes longer than the rest: several sums of each, as many as there are registers for.
    constexpr std::size_t parts = 4;
    constexpr std::size_t rounds = 8;
    std::array<double, lanes> first_sums{};
    std::array<double, lanes> second_sums{};
    while (e + parts * lanes <= count) {
        auto const last = std::min(count - parts * lanes + 1, e + rounds * parts * lanes);
        reals first_0{}, first_1{}, first_2{}, first_3{};
        reals second_0{}, second_1{}, second_2{}, second_3{};
        auto const add = [&](std::size_t at, reals& first, reals& second) {
            reals const apart = load_as<reals>(values + at) - origin;
            // What is hidden may be no number: its difference becomes 0.
            auto const difference = bits_as<reals>(bits_as<bits>(apart) & load_as<bits>(kept + at));
            first += difference;
            second += difference * difference;
        };
        for (; e < last; e += parts * lanes) {
            add(e, first_0, second_0);
            add(e + lanes, first_1, second_1);
            add(e + 2 * lanes, first_2, second_2);
            add(e + 3 * lanes, first_3, second_3);
        }
        auto const first = bits_as<std::array<Real, lanes>>(reals((first_0 + first_1) + (first_2 + first_3)));
        auto const second = bits_as<std::array<Real, lanes>>(reals((second_0 + second_1) + (second_2 + second_3)));
        for (std::size_t lane = 0; lane < lanes; ++lane) {
            first_sums[lane] += static_cast<double>(first[lane]);
            second_sums[lane] += static_cast<double>(second[lane]);
        }
    }
    for (std::size_t lane = 0; lane < lanes; ++lane) {
        sums[0] += first_sums[lane];
        sums[1] += second_sums[lane];
    }
#endif
    auto const rest = exact_moments_of_kept(values + e, kept + e, count - e, static_cast<double>(origin));
    return {sums[0] + rest[0], sums[1] + rest[1]};
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
    auto const kept = std::make_unique_for_overwrite<bits[]>(mask.size());
    auto const first = detail::keep_bits(kept.get(), result.pixels, mask_values, mask.size());
    if (result.pixels < 2) {
        return result;
    }
    auto const n = static_cast<double>(result.pixels);
    std::vector<Real> gathered;
    for (std::size_t c = 0; c < channels; ++c) {
        auto const* const values = detail::neighbouring_values(z[c], gathered);
        auto const moments_around = [&](Real origin) {
            return detail::moments_of_kept(values, kept.get(), mask.size(), origin);
        };
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
            moments = detail::exact_moments_of_kept(values, kept.get(), mask.size(), static_cast<double>(origin));
        }
        auto const [sum, squares] = moments;
        auto const variance = std::max(0.0, squares - sum * sum / n) / (n - 1);
        result.mean[c] = static_cast<Real>(static_cast<double>(origin) + sum / n);
        result.deviation[c] = static_cast<Real>(std::sqrt(variance + static_cast<double>(epsilon)));
    }
    return result;
}

} // namespace genrender
