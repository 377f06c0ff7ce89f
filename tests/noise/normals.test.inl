// SPDX-License-Identifier: MIT
// What is checked of the transform of Box and Muller of one target.

namespace genrender::testing::GENRENDER_TARGET {

using namespace genrender::detail;
using namespace genrender::detail::GENRENDER_TARGET_NAME;

inline void check_values() {
    double worst = 0;
    std::array<double, 16> values{};
    for (std::uint32_t number = 0; number < 20000; ++number) {
        std::array<std::array<std::uint32_t, 4>, 4> counters{};
        for (std::uint32_t n = 0; n < 4; ++n) {
            counters[n] = {number, n, 2, 0};
        }
        genrender::normals_of(counters, {number * 7, 11}, values.data());
        for (std::size_t n = 0; n < 4; ++n) {
            auto const expected = four_normals_of(philox(counters[n], {number * 7, 11}));
            for (std::size_t j = 0; j < 4; ++j) {
                worst = std::max(worst, std::abs(values[4 * n + j] - expected[j]));
            }
        }
    }
    CHECK(worst < 2e-14);
}

inline void check_ends() {
    using words = normal_pairs::words;
    std::array<std::uint32_t, 4> const radii{0, 1, 0x7FFFFFFFU, 0xFFFFFFFFU};
    for (auto const radius : radii) {
        for (std::uint64_t angle = 0; angle < 0x100000000U; angle += 0x0FFFFFFFU) {
            lanes<double> made[2];
            normal_pairs::of(made, words{} + std::uint64_t{radius}, words{} + angle);
            double parts[2][lane_count<double>];
            std::memcpy(parts, made, sizeof parts);
            auto const bits = static_cast<std::uint32_t>(angle);
            auto const expected = four_normals_of({radius, bits, radius, bits});
            CHECK(parts[0][0] == doctest::Approx(expected[0]).epsilon(1e-13));
            CHECK(parts[1][lane_count<double> - 1] == doctest::Approx(expected[1]).epsilon(1e-13));
        }
    }
}

} // namespace genrender::testing::GENRENDER_TARGET
