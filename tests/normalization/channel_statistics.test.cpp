// SPDX-License-Identifier: MIT
// [GR sec. 3.4] Means and deviations over a mask, by hand and where there is hardly a pixel.
#include <genrender/normalization/channel_statistics.hpp>

#include <genrender/core/stack.hpp>

#include <doctest/doctest.h>

#include <genrender/testing/random_stack.hpp>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <type_traits>
#include <utility>
#include <vector>

using namespace genrender;
using genrender::testing::random_stack;

namespace {

template <class Real>
strided_view<Real const, 3> view_of(std::vector<Real> const& values, std::array<std::size_t, 3> extents) {
    return {values.data(), extents};
}

strided_view<std::uint8_t const, 2> view_of(std::vector<std::uint8_t> const& values,
                                            std::array<std::size_t, 2> extents) {
    return {values.data(), extents};
}

} // namespace

TEST_SUITE("normalization/channel_statistics") {
    TEST_CASE_TEMPLATE("[GR sec. 3.4] unbiased variance and 1e-5 by hand", Real, float, double) {
        // Channel 0 over its mask: 1, 3, 8 with mean 4 and squares 9 + 1 + 16 = 26 over 2. Channel 1: 2, 2, 2.
        std::vector<Real> const z{1, 100, 3, 8, 2, -100, 2, 2};
        std::vector<std::uint8_t> const mask{1, 0, 255, 2};
        auto const s = masked_statistics(view_of(z, {2, 2, 2}), view_of(mask, {2, 2}));
        CHECK(s.pixels == 3);
        CHECK(s.mean[0] == Real{4});
        CHECK(s.mean[1] == Real{2});
        CHECK(s.deviation[0] == doctest::Approx(std::sqrt(13 + 1e-5)).epsilon(1e-6));
        CHECK(s.deviation[1] == doctest::Approx(std::sqrt(1e-5)).epsilon(1e-6));
        // The biased variance would be 26 / 3.
        CHECK(std::abs(s.deviation[0] - static_cast<Real>(std::sqrt(26.0 / 3))) > Real(0.5));
        auto const exact = masked_statistics(view_of(z, {2, 2, 2}), view_of(mask, {2, 2}), Real{0});
        CHECK(exact.deviation[0] == doctest::Approx(std::sqrt(13.0)).epsilon(1e-6));
        CHECK(exact.deviation[1] == Real{0});
    }

    TEST_CASE("pixels outside the mask are never read as numbers") {
        auto const NaN = std::numeric_limits<double>::quiet_NaN();
        std::vector<double> const z{1, NaN, 3, NaN};
        std::vector<std::uint8_t> const mask{1, 0, 1, 0};
        auto const s = masked_statistics(view_of(z, {1, 2, 2}), view_of(mask, {2, 2}), 0.0);
        CHECK(s.mean[0] == 2);
        CHECK(s.deviation[0] == doctest::Approx(std::sqrt(2.0)));
    }

    TEST_CASE_TEMPLATE("no pixel and one pixel have no variance and no NaN", Real, float, double) {
        std::vector<Real> const z{5, 6, 7, 8};
        for (auto const& mask : {std::vector<std::uint8_t>{0, 0, 0, 0}, {0, 1, 0, 0}}) {
            auto const s = masked_statistics(view_of(z, {1, 2, 2}), view_of(mask, {2, 2}));
            CHECK(s.pixels == mask[1]);
            CHECK(s.mean[0] == Real{0});
            CHECK(s.deviation[0] == Real{1});
        }
        auto const nothing =
            masked_statistics(view_of(std::vector<Real>{}, {2, 0, 3}), view_of(std::vector<std::uint8_t>{}, {0, 3}));
        CHECK(nothing.pixels == 0);
        CHECK(nothing.deviation.size() == 2);
    }

    TEST_CASE("two pixels are enough") {
        std::vector<double> const z{5, 7};
        auto const s = masked_statistics(view_of(z, {1, 1, 2}), view_of(std::vector<std::uint8_t>{1, 1}, {1, 2}), 0.0);
        CHECK(s.pixels == 2);
        CHECK(s.mean[0] == 6);
        CHECK(s.deviation[0] == doctest::Approx(std::sqrt(2.0)));
    }

    TEST_CASE("a small variance does not drown in a large mean") {
        // 1e6 +- 0.25 in float: the mean of squares less the square of the mean would be all rounding.
        std::vector<float> const z{1000000.25F, 999999.75F, 1000000.25F, 999999.75F};
        auto const s = masked_statistics(view_of(z, {1, 2, 2}), view_of(std::vector<std::uint8_t>(4, 1), {2, 2}), 0.0F);
        CHECK(s.mean[0] == 1000000.0F);
        CHECK(s.deviation[0] == doctest::Approx(std::sqrt(0.25 / 3)).epsilon(1e-6));
    }

    TEST_CASE_TEMPLATE("any number of values under any mask agrees with the definition", Real, float, double) {
        auto const far = [](double x) { return 300 * x; };
        auto const near_1e5 = [](double x) { return 1e5 + x; };
        auto const same = [](double x) { return x; };
        for (std::size_t const count : {2U, 3U, 15U, 64U, 127U, 129U, 1000U, 4096U, 4099U}) {
            for (std::size_t const every : {1U, 2U, 3U, 64U}) {
                for (auto const& scaled : {std::function<double(double)>(same), {far}, {near_1e5}}) {
                    CAPTURE(count);
                    CAPTURE(every);
                    auto z = random_stack<Real, 3>({2, 1, count}, 5);
                    stack<std::uint8_t, 2> mask({1, count});
                    std::size_t pixels = 0;
                    for (std::size_t e = 0; e < count; ++e) {
                        auto const is_kept = e % every == every / 2 || e + 1 == count;
                        pixels += is_kept ? 1 : 0;
                        mask.data()[e] = is_kept ? 7 : 0;
                        for (std::size_t c = 0; c < 2; ++c) {
                            auto& value = z.data()[c * count + e];
                            // The first value of channel 1 lies far from all others.
                            auto const apart = c == 1 && e == every / 2 ? 50.0 : 0.0;
                            value = is_kept ? static_cast<Real>(scaled(static_cast<double>(value) + apart))
                                            : std::numeric_limits<Real>::quiet_NaN();
                        }
                    }
                    auto const s = masked_statistics(std::as_const(z).view(), std::as_const(mask).view(), Real{0});
                    REQUIRE(s.pixels == pixels);
                    for (std::size_t c = 0; c < 2 && pixels > 1; ++c) {
                        auto const mean_of = [&](auto const& f) {
                            double sum = 0;
                            for (std::size_t e = 0; e < count; ++e) {
                                sum += mask.data()[e] != 0 ? f(static_cast<double>(z.data()[c * count + e])) : 0.0;
                            }
                            return sum / static_cast<double>(pixels);
                        };
                        auto const mean = mean_of([](double x) { return x; });
                        auto const squares = mean_of([mean](double x) { return (x - mean) * (x - mean); });
                        auto const n = static_cast<double>(pixels);
                        auto const deviation = std::sqrt(squares * n / (n - 1));
                        auto const exact = std::is_same_v<Real, float> ? 3e-7 : 1e-14;
                        REQUIRE(std::abs(static_cast<double>(s.mean[c]) - mean) <=
                                exact * (std::abs(mean) + deviation));
                        REQUIRE(std::abs(static_cast<double>(s.deviation[c]) - deviation) <= 2 * exact * deviation);
                    }
                }
            }
        }
    }

    TEST_CASE("numbers whose squares have no place in single precision count all the same") {
        for (auto const scale : {1e-30F, 1e-22F, 1e17F, 1e25F}) {
            CAPTURE(scale);
            std::vector<float> z(200);
            for (std::size_t e = 0; e < z.size(); ++e) {
                z[e] = e % 2 == 0 ? scale : 3 * scale;
            }
            auto const s =
                masked_statistics(view_of(z, {1, 10, 20}), view_of(std::vector<std::uint8_t>(200, 1), {10, 20}), 0.0F);
            CHECK(s.mean[0] / scale == doctest::Approx(2).epsilon(1e-6));
            CHECK(s.deviation[0] / scale == doctest::Approx(std::sqrt(200.0 / 199)).epsilon(1e-6));
        }
        // A constant background has none.
        std::vector<float> const flat(200, 0.1F);
        auto const s =
            masked_statistics(view_of(flat, {1, 10, 20}), view_of(std::vector<std::uint8_t>(200, 1), {10, 20}), 0.0F);
        CHECK(s.mean[0] == 0.1F);
        CHECK(s.deviation[0] == 0);
    }

    TEST_CASE("strided latents and masks give the same statistics") {
        auto const z = random_stack<double, 3>({3, 4, 5}, 2);
        stack<std::uint8_t, 2> mask({4, 5});
        for (std::size_t e = 0; e < 20; e += 3) {
            mask.data()[e] = 1;
        }
        // Channels last, and the mask by columns.
        stack<double, 3> last({4, 5, 3});
        strided_view<double, 3> const z_last(last.data(), {3, 4, 5}, {1, 15, 3});
        copy(z_last, z);
        stack<std::uint8_t, 2> columns({5, 4});
        strided_view<std::uint8_t, 2> const by_columns(columns.data(), {4, 5}, {1, 4});
        copy(by_columns, mask);
        auto const a = masked_statistics(z.view(), std::as_const(mask).view());
        auto const b =
            masked_statistics(strided_view<double const, 3>(z_last), strided_view<std::uint8_t const, 2>(by_columns));
        CHECK(a.pixels == 7);
        CHECK(b.pixels == 7);
        CHECK(a.mean == b.mean);
        CHECK(a.deviation == b.deviation);
    }

    TEST_CASE("a mask of another size is refused with a sentence") {
        stack<float, 3> const z({2, 3, 4});
        stack<std::uint8_t, 2> const mask({4, 3});
        CHECK_THROWS_WITH_AS(masked_statistics(z.view(), mask.view()),
                             "masked_statistics: mask is [4, 3], expected [3, 4]", shape_error);
    }
}
