// SPDX-License-Identifier: MIT
// The transform of Box and Muller, with the vectors of one target.

namespace genrender::detail::GENRENDER_TARGET {

/// Values of N(0, 1) of as many pairs of random words as a register holds doubles: radius and angle, and their cosine and sine values.
struct normal_pairs {
    using reals = lanes<double>;
    using words = lanes<std::uint64_t>;

    /// `radius_bits` and `angle_bits` are 32-bit numbers in 64 bits; made are cos * radius and sin * radius.
    GENRENDER_ALWAYS_INLINE static void of(reals (&made)[2], words const& radius_bits, words const& angle_bits) {
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
        made[0] = radius * first * first_sign;
        made[1] = radius * second * second_sign;
    }

private:
    /// Numbers below 2^52: their bits are those of the fraction of 2^52 + number.
    GENRENDER_ALWAYS_INLINE static reals as_reals(words const& numbers) {
        return as_written(bits_as<reals>(numbers | 0x4330000000000000U) - 0x1p52);
    }

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
    GENRENDER_ALWAYS_INLINE static reals series(reals const& x, std::array<double, Terms> const& terms) {
        auto sum = reals{} + terms[Terms - 1];
        for (std::size_t n = Terms - 1; n-- > 0;) {
            sum = sum * x + terms[n];
        }
        return sum;
    }

    /// The root of normal numbers above 0: Newton's method for its inverse, from half the exponent.
    GENRENDER_ALWAYS_INLINE static reals square_root(reals const& x) {
        auto inverse = bits_as<reals>(0x5FE6EB50C7B537A9U - (bits_as<words>(x) >> 1));
        for (int step = 0; step < 4; ++step) {
            inverse *= 1.5 - 0.5 * x * inverse * inverse;
        }
        return x * inverse;
    }

    /// log of normal numbers above 0: log(2^e m) = e log 2 + 2 artanh((m - 1) / (m + 1)), m around 1.
    GENRENDER_ALWAYS_INLINE static reals log(reals const& x) {
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

/// See normals_of in noise/normals.hpp.
inline void normals_of(std::array<std::uint32_t, 4> const* counters, std::size_t count,
                       std::array<std::uint32_t, 2> key, double* values) {
    constexpr auto width = lane_count<double>;
    constexpr auto pairs_at_once = 2 * normals_at_once;
    for (std::size_t begin = 0; begin < count; begin += normals_at_once) {
        alignas(64) std::uint64_t radius_bits[pairs_at_once];
        alignas(64) std::uint64_t angle_bits[pairs_at_once];
        for (std::size_t n = 0; n < normals_at_once; ++n) {
            auto const bits = philox(counters[begin + n], key);
            for (std::size_t pair = 0; pair < 2; ++pair) {
                radius_bits[2 * n + pair] = bits[2 * pair];
                angle_bits[2 * n + pair] = bits[2 * pair + 1];
            }
        }
        auto* const to = values + 4 * begin;
        for (std::size_t first = 0; first < pairs_at_once; first += width) {
            lanes<double> made[2];
            normal_pairs::of(made, load(&radius_bits[first]), load(&angle_bits[first]));
            double parts[2][width];
            std::memcpy(parts, made, sizeof parts);
            for (std::size_t lane = 0; lane < width; ++lane) {
                to[2 * (first + lane)] = parts[0][lane];
                to[2 * (first + lane) + 1] = parts[1][lane];
            }
        }
    }
}

} // namespace genrender::detail::GENRENDER_TARGET
