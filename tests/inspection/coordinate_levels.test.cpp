// SPDX-License-Identifier: MIT
// Rounded coordinates are known by their levels and their rough steps; full ones and exact ones are left in peace.
#include <genrender/inspection/coordinate_levels.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <cstddef>
#include <vector>

namespace coordinate_levels_test {

/// Levels of 600 pixels in a row, `slope` apart, each stored as `stored` says.
template <class Stored>
genrender::coordinate_levels levels_along(float slope, Stored const& stored) {
    std::vector<float> values;
    for (std::size_t k = 0; k < 600; ++k) {
        values.push_back(stored(0.0137F + slope * static_cast<float>(k)));
    }
    std::vector<float> bends;
    for (std::size_t k = 1; k + 1 < values.size(); ++k) {
        bends.push_back(values[k + 1] - 2 * values[k] + values[k - 1]);
    }
    return genrender::levels_of(values, bends, slope, 0, 1);
}

} // namespace coordinate_levels_test

TEST_SUITE("inspection/coordinate_levels") {
    using namespace genrender;
    using coordinate_levels_test::levels_along;

    TEST_CASE("full floats lie on no levels") {
        auto const levels = levels_along(0.00161F, [](float x) { return x; });
        CHECK(levels.samples == 600);
        CHECK(levels.distinct == 600);
        CHECK_FALSE(levels.quantum);
        CHECK_FALSE(levels.is_quantised());
    }

    TEST_CASE("eight bits are known by name with the pixels that share a value") {
        auto const levels = levels_along(0.00161F, [](float x) { return std::round(x * 255) / 255; });
        REQUIRE(levels.quantum);
        CHECK(*levels.quantum == doctest::Approx(1 / 255.0));
        CHECK(levels.is_eight_bit);
        CHECK(levels.is_quantised());
        CHECK(levels.distinct <= 256);
        CHECK(levels.quantum_in_pixels == doctest::Approx(1 / 255.0 / 0.00161).epsilon(1e-3)); // 2.4
        CHECK(levels.histogram[8] >= 15);
        CHECK(levels.histogram[8] <= 17);
    }

    TEST_CASE("other roundings are known by their quantum") {
        auto const hundredths = levels_along(0.00161F, [](float x) { return std::round(x * 100) / 100; });
        REQUIRE(hundredths.quantum);
        CHECK(*hundredths.quantum == doctest::Approx(0.01));
        CHECK_FALSE(hundredths.is_eight_bit);
        CHECK(hundredths.is_quantised());
        auto const ten_bits = levels_along(0.00161F, [](float x) { return std::round(x * 1023) / 1023; });
        CHECK(*ten_bits.quantum == doctest::Approx(1 / 1023.0));
        CHECK(ten_bits.is_quantised()); // 0.6 of a pixel
    }

    TEST_CASE("halves are rounded where pixels are finer than they are") {
        auto const halved = [](float x) {
            return std::round(x * 0x1p16F) / 0x1p16F;
        }; // 16 bits: no rounding that shows
        CHECK_FALSE(levels_along(0.00161F, halved).is_quantised());
        auto const half = [](float x) {
            auto const unit = std::exp2(std::floor(std::log2(x)) - 10);
            return std::round(x / unit) * unit;
        };
        auto const levels = levels_along(0.00161F, half);
        REQUIRE(levels.quantum);
        CHECK(*levels.quantum <= 0x1p-11);
        CHECK(levels.is_quantised()); // a third of a pixel
        CHECK_FALSE(levels_along(0.0161F, half).is_quantised());
    }

    TEST_CASE("levels that a flat surface meets pixel by pixel are no rounding") {
        auto const levels = levels_along(1 / 1024.0F, [](float x) { return x - 0.0137F; });
        CHECK(levels.quantum); // multiples of 1 / 1024
        CHECK_FALSE(levels.is_rough);
        CHECK_FALSE(levels.is_quantised());
    }

    TEST_CASE("a constant and nothing have no quantum") {
        CHECK_FALSE(levels_along(0, [](float) { return 0.5F; }).quantum);
        auto const none = levels_of({}, {}, 0, 0, 1);
        CHECK(none.samples == 0);
        CHECK_FALSE(none.is_quantised());
    }

    TEST_CASE("levels of positions are those of their range") {
        std::vector<float> values;
        for (std::size_t k = 0; k < 600; ++k) {
            values.push_back(-2 + 8 * std::round(0.00161F * static_cast<float>(k) * 255) / 255);
        }
        auto const levels = levels_of(values, {}, 8 * 0.00161, -2, 8);
        REQUIRE(levels.quantum);
        CHECK(*levels.quantum == doctest::Approx(8 / 255.0));
        CHECK(levels.is_quantised());
    }
}
