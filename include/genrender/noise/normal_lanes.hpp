// SPDX-License-Identifier: MIT
// The transform of Box and Muller for many values at once: what core/random.hpp's four_normals_of gives, to a few units
// in the last place.
#pragma once

#include <genrender/core/random.hpp>
#include <genrender/core/register_vector.hpp>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <numbers>

namespace genrender {

namespace detail {

#if defined(__GNUC__)

/// Values of N(0, 1) of `lanes` pairs of random words: radius and angle, and their cosine and sine values.
struct normal_pairs {
    static constexpr std::size_t lanes = register_lanes<double>;
    using reals = register_vector<double>;
    using words = register_vector<std::uint64_t>;

    /// `radius_bits` and `angle_bits` are 32-bit numbers in 64 bits. cos * radius and sin * radius.
    static std::array<reals, 2> of(words const& radius_bits, words const& angle_bits) {
        // u = (bits + 0.5) 2^-32 lies strictly between 0 and 1.
        reals const u = (as_reals(radius_bits) + 0.5) * 0x1p-32;
        auto const radius = square_root(-2 * log(u));

        // Whole quarters of a turn are taken off exactly; the rest is an eighth at most.
        words const quarter = (angle_bits + (1U << 29)) >> 30;
        reals const angle =
            ((as_reals(angle_bits) + 0.5) * 0x1p-32 - as_reals(quarter) * 0.25) * (2 * std::numbers::pi);
        auto const square_of_angle = angle * angle;
        auto const sine = angle * series(square_of_angle, odd);
        auto const cosine = series(square_of_angle, even);
        auto const is_turned = (quarter & 1U) != 0;
        reals const first = is_turned ? sine : cosine;
        reals const second = is_turned ? cosine : sine;
        // Quarters 1 and 2 turn the first around, 2 and 3 the second.
        reals const first_sign = ((quarter + 1) & 2U) != 0 ? reals{} - 1 : reals{} + 1;
        reals const second_sign = (quarter & 2U) != 0 ? reals{} - 1 : reals{} + 1;
        return {radius * first * first_sign, radius * second * second_sign};
    }

private:
    /// Numbers below 2^52: their bits are those of the fraction of 2^52 + number.
    static reals as_reals(words const& numbers) { return bits_as<reals>(numbers | 0x4330000000000000U) - 0x1p52; }

    /// The terms of the series of sin(x) / x and cos(x) in x^2, which beyond are below 1e-16 for x <= pi / 4.
    static constexpr std::array<double, 9> odd{1.0,
                                               -1.0 / 6,
                                               1.0 / 120,
                                               -1.0 / 5040,
                                               1.0 / 362880,
                                               -1.0 / 39916800,
                                               1.0 / 6227020800.0,
                                               -1.0 / 1307674368000.0,
                                               1.0 / 355687428096000.0};
    static constexpr std::array<double, 9> even{1.0,
                                                -1.0 / 2,
                                                1.0 / 24,
                                                -1.0 / 720,
                                                1.0 / 40320,
                                                -1.0 / 3628800,
                                                1.0 / 479001600,
                                                -1.0 / 87178291200.0,
                                                1.0 / 20922789888000.0};

    template <std::size_t Terms>
    static reals series(reals const& x, std::array<double, Terms> const& terms) {
        auto sum = reals{} + terms[Terms - 1];
        for (std::size_t n = Terms - 1; n-- > 0;) {
            sum = sum * x + terms[n];
        }
        return sum;
    }

    /// The root of normal numbers above 0: Newton's method for its inverse, from half the exponent.
    static reals square_root(reals const& x) {
        auto inverse = bits_as<reals>(0x5FE6EB50C7B537A9U - (bits_as<words>(x) >> 1));
        for (int step = 0; step < 4; ++step) {
            inverse *= 1.5 - 0.5 * x * inverse * inverse;
        }
        return x * inverse;
    }

    /// log of normal numbers above 0: log(2^e m) = e log 2 + 2 artanh((m - 1) / (m + 1)), m around 1.
    static reals log(reals const& x) {
        constexpr std::uint64_t one = 0x3FF0000000000000U;
        constexpr std::uint64_t root_half = 0x3FE6A09E667F3BCDU;
        auto const bits = bits_as<words>(x);
        words const exponent = (bits + (one - root_half)) >> 52;
        auto const m = bits_as<reals>(bits - (exponent << 52) + one);
        auto const s = (m - 1) / (m + 1);
        constexpr std::array<double, 11> terms{2.0,      2.0 / 3,  2.0 / 5,  2.0 / 7,  2.0 / 9, 2.0 / 11,
                                               2.0 / 13, 2.0 / 15, 2.0 / 17, 2.0 / 19, 2.0 / 21};
        return (as_reals(exponent) - 1023) * std::numbers::ln2 + s * series(s * s, terms);
    }
};

#endif

} // namespace detail

/// Four values of N(0, 1) for each of `Count` counters under one key: values 4 n ... 4 n + 3 are those of
/// four_normals_of(philox(counters[n], key)).
template <std::size_t Count>
void normals_of(std::array<std::array<std::uint32_t, 4>, Count> const& counters,
                std::array<std::uint32_t, 2> const& key, double* values) {
#if defined(__GNUC__)
    using pairs = detail::normal_pairs;
    constexpr auto lanes = pairs::lanes;
    static_assert(2 * Count % lanes == 0, "normals_of: counters that do not fill a register");
    alignas(64) std::array<std::uint64_t, 2 * Count> radius_bits;
    alignas(64) std::array<std::uint64_t, 2 * Count> angle_bits;
    for (std::size_t n = 0; n < Count; ++n) {
        auto const bits = philox(counters[n], key);
        for (std::size_t pair = 0; pair < 2; ++pair) {
            radius_bits[2 * n + pair] = bits[2 * pair];
            angle_bits[2 * n + pair] = bits[2 * pair + 1];
        }
    }
    for (std::size_t first = 0; first < 2 * Count; first += lanes) {
        auto const made = pairs::of(detail::load_as<pairs::words>(&radius_bits[first]),
                                    detail::load_as<pairs::words>(&angle_bits[first]));
        alignas(64) std::array<std::array<double, lanes>, 2> parts;
        std::memcpy(parts.data(), made.data(), sizeof(parts));
        for (std::size_t lane = 0; lane < lanes; ++lane) {
            values[2 * (first + lane)] = parts[0][lane];
            values[2 * (first + lane) + 1] = parts[1][lane];
        }
    }
#else
    for (std::size_t n = 0; n < Count; ++n) {
        auto const made = four_normals_of(philox(counters[n], key));
        for (std::size_t j = 0; j < 4; ++j) {
            values[4 * n + j] = made[j];
        }
    }
#endif
}

} // namespace genrender
