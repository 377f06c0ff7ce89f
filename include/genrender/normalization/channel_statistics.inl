// SPDX-License-Identifier: MIT
// Which pixels count, and sums over those that do, with the vectors of one target.

namespace genrender::detail::GENRENDER_TARGET {

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
    constexpr auto width = lane_count<Real>;
    using reals = lanes<Real>;
    using bits = lanes<Bits>;
    // An addition takes longer than the rest: several sums of each, as many as there are registers for.
    constexpr std::size_t parts = 4;
    constexpr std::size_t rounds = 8;
    std::array<double, width> first_sums{};
    std::array<double, width> second_sums{};
    while (e + parts * width <= count) {
        auto const last = std::min(count - parts * width + 1, e + rounds * parts * width);
        reals first_0{}, first_1{}, first_2{}, first_3{};
        reals second_0{}, second_1{}, second_2{}, second_3{};
        auto const add = [&](std::size_t at, reals& first, reals& second) GENRENDER_ALWAYS_INLINE {
            reals const apart = load_as<reals>(values + at) - origin;
            // What is hidden may be no number: its difference becomes 0.
            auto const difference = bits_as<reals>(bits_as<bits>(apart) & load_as<bits>(kept + at));
            first += difference;
            second += difference * difference;
        };
        for (; e < last; e += parts * width) {
            add(e, first_0, second_0);
            add(e + width, first_1, second_1);
            add(e + 2 * width, first_2, second_2);
            add(e + 3 * width, first_3, second_3);
        }
        auto const first = bits_as<std::array<Real, width>>(reals((first_0 + first_1) + (first_2 + first_3)));
        auto const second = bits_as<std::array<Real, width>>(reals((second_0 + second_1) + (second_2 + second_3)));
        for (std::size_t lane = 0; lane < width; ++lane) {
            first_sums[lane] += static_cast<double>(first[lane]);
            second_sums[lane] += static_cast<double>(second[lane]);
        }
    }
    for (std::size_t lane = 0; lane < width; ++lane) {
        sums[0] += first_sums[lane];
        sums[1] += second_sums[lane];
    }
    auto const rest = exact_moments_of_kept(values + e, kept + e, count - e, static_cast<double>(origin));
    return {sums[0] + rest[0], sums[1] + rest[1]};
}

} // namespace genrender::detail::GENRENDER_TARGET
