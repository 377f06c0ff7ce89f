// SPDX-License-Identifier: MIT
// Low bands by hand, by their laws, and against the kernel written out.
#include <genrender/normalization/low_band.hpp>

#include <genrender/core/random.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

using namespace genrender;

TEST_SUITE("normalization/low_band") {
    namespace {

    std::vector<double> random_image(std::size_t size, std::uint32_t which) {
        std::vector<double> image;
        for (std::uint32_t e = 0; e < size; ++e) {
            image.push_back(normal_value(6, random_stream::test, {which, e, 0}));
        }
        return image;
    }

    /// The kernel of all levels written out: paths of one step a level and axis.
    double weight_of(std::ptrdiff_t apart, std::size_t levels) {
        if (levels == 0) {
            return apart == 0 ? 1.0 : 0.0;
        }
        auto const step = std::ptrdiff_t{1} << (levels - 1);
        return weight_of(apart, levels - 1) / 2 + weight_of(apart - step, levels - 1) / 4 +
               weight_of(apart + step, levels - 1) / 4;
    }

    } // namespace

    TEST_CASE("three pixels by hand") {
        low_band const low({1, 3}, {1, 1, 1}, 1);
        // Along the row [2 1 0; 1 2 1; 0 1 2] / 4; across it the half that stays.
        auto const result = low({4, 8, -4});
        auto const mean = 8.0 / 3;
        CHECK(result[0] == doctest::Approx((16.0 / 8 + 0.01 * mean) / (3.0 / 8 + 0.01)));
        CHECK(result[1] == doctest::Approx((16.0 / 8 + 0.01 * mean) / (4.0 / 8 + 0.01)));
        CHECK(result[2] == doctest::Approx((0.0 / 8 + 0.01 * mean) / (3.0 / 8 + 0.01)));
    }
    TEST_CASE("away from the edges it is the kernel written out") {
        // A long row: the kernel across it is the same factor everywhere, the sum of no other row.
        for (std::size_t const levels : {1U, 2U, 3U}) {
            std::size_t const n = 41;
            auto const image = random_image(n, 1);
            low_band const low({1, n}, std::vector<std::uint8_t>(n, 1), levels);
            auto const result = low(image);
            auto const across = std::pow(0.5, static_cast<double>(levels));
            double mean = 0;
            double sum = 0;
            for (std::size_t e = 0; e < n; ++e) {
                mean += image[e] / static_cast<double>(n);
                sum += weight_of(static_cast<std::ptrdiff_t>(e) - 20, levels) * image[e];
            }
            CHECK(result[20] == doctest::Approx((across * sum + 0.01 * mean) / (across + 0.01)).epsilon(1e-12));
        }
    }
    TEST_CASE("a constant stays one whatever is known and what is hidden is not read") {
        std::vector<std::uint8_t> mask(6 * 8, 0);
        mask[3] = mask[4] = mask[20] = 1;
        low_band const low({6, 8}, mask, 4);
        CHECK(low.pixels() == 3);
        std::vector<double> image(48, std::numeric_limits<double>::quiet_NaN());
        image[3] = image[4] = image[20] = -2.5;
        for (auto const value : low(image)) {
            CHECK(value == doctest::Approx(-2.5));
        }
    }
    TEST_CASE("it is linear and a constant more is a constant more") {
        std::vector<std::uint8_t> mask(48, 1);
        mask[0] = mask[9] = mask[30] = 0;
        low_band const low({6, 8}, mask, 2);
        auto const a = random_image(48, 2);
        auto const b = random_image(48, 3);
        auto sum = a;
        auto more = a;
        for (std::size_t e = 0; e < 48; ++e) {
            sum[e] = 2 * a[e] - b[e];
            more[e] = a[e] + 7;
        }
        auto const low_a = low(a);
        auto const low_b = low(b);
        auto const low_sum = low(sum);
        auto const low_more = low(more);
        for (std::size_t e = 0; e < 48; ++e) {
            CHECK(low_sum[e] == doctest::Approx(2 * low_a[e] - low_b[e]).epsilon(1e-12));
            CHECK(low_more[e] == doctest::Approx(low_a[e] + 7).epsilon(1e-12));
        }
    }
    TEST_CASE("fine patterns are not in it and ramps are") {
        std::size_t const n = 32;
        std::vector<double> checker(n * n);
        std::vector<double> ramp(n * n);
        for (std::size_t e = 0; e < n * n; ++e) {
            checker[e] = (e / n + e % n) % 2 == 0 ? 1 : -1;
            ramp[e] = static_cast<double>(e % n);
        }
        low_band const low({n, n}, std::vector<std::uint8_t>(n * n, 1), 2);
        auto const centre = n / 2 * n + n / 2;
        CHECK(std::abs(low(checker)[centre]) < 0.01);
        CHECK(low(ramp)[centre] == doctest::Approx(ramp[centre]).epsilon(1e-3));
    }
    TEST_CASE("where nothing is near the mean of all stands in") {
        std::vector<std::uint8_t> mask(64, 0);
        mask[0] = mask[1] = 1;
        low_band const low({1, 64}, mask, 1);
        std::vector<double> image(64, 100);
        image[0] = 1;
        image[1] = 5;
        CHECK(low(image)[63] == doctest::Approx(3));
        CHECK(low(image)[0] < 2.5);
    }
    TEST_CASE("masks and levels that say nothing are refused") {
        CHECK_THROWS_WITH_AS(low_band({1, 2}, {1, 1}, 0), "low_band: levels is 0, expected 1 to 12", value_error);
        CHECK_THROWS_WITH_AS(low_band({1, 2}, {0, 0}, 1), "low_band: mask is empty, expected at least one known pixel",
                             value_error);
        CHECK_THROWS_AS(low_band({1, 2}, {1, 1, 1}, 1), value_error);
        low_band const low({1, 2}, {1, 1}, 1);
        CHECK_THROWS_AS(low({1, 2, 3}), value_error);
    }
}
