// SPDX-License-Identifier: MIT
// White noise at all resolutions at once: cells sum to the cell around them, and nobody shares what another looks at.
#include <genrender/noise/noise_tree.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

using namespace genrender;

namespace {

template <std::size_t D>
std::vector<double> seen(std::vector<noise_request<D>> requests, std::size_t pixels, std::size_t channels = 1,
                         std::uint64_t seed = 5, object_index object = {2}, std::uint32_t step = 0) {
    std::vector<double> sums(pixels * channels);
    noise_tree<D>(seed, random_stream::test, object, step).add(sums, channels, requests);
    return sums;
}

template <std::size_t D>
noise_request<D> look_at(std::array<double, D> const& point, std::uint32_t level, std::uint32_t pixel,
                         double share = 1) {
    return {noise_tree<D>::place_of(point), level, pixel, share};
}

} // namespace

TEST_SUITE("noise/noise_tree") {
    TEST_CASE("places and levels are those of a cube of 2^17 units") {
        CHECK(noise_tree<2>::place_of({-65536.0, 0.0}) == std::array<std::uint64_t, 2>{0, std::uint64_t{1} << 47});
        CHECK(noise_tree<2>::level_of(131072) == 0);
        CHECK(noise_tree<2>::level_of(1) == 17);
        CHECK(noise_tree<2>::level_of(0.6) == 17);
        CHECK(noise_tree<2>::level_of(0.5) == 18);
        CHECK(noise_tree<2>::level_of(1e9) == 0);
        CHECK(noise_tree<2>::level_of(0) == noise_tree<2>::deepest);
    }

    TEST_CASE("coordinates out of range are refused with a sentence") {
        CHECK_THROWS_WITH_AS(noise_tree<2>::place_of({0.0, 65536.0}),
                             "noise_tree: canonical coordinate is 65536.000000, expected a number in [-65536, 65536)",
                             value_error);
        CHECK_THROWS_AS(noise_tree<3>::place_of({0.0, 0.0, std::numeric_limits<double>::quiet_NaN()}), value_error);
    }

    TEST_CASE_TEMPLATE("a cell is half the sum of its children in the plane and less in space", D,
                       std::integral_constant<std::size_t, 2>, std::integral_constant<std::size_t, 3>) {
        constexpr std::size_t d = D::value;
        constexpr std::size_t children = std::size_t{1} << d;
        std::array<double, d> middle{};
        middle.fill(0.375);
        auto const whole = seen<d>({look_at<d>(middle, 19, 0)}, 1)[0]; // [0.25, 0.5)^d
        double sum = 0;
        for (std::size_t child = 0; child < children; ++child) {
            auto corner = middle;
            for (std::size_t axis = 0; axis < d; ++axis) {
                corner[axis] += (child >> axis & 1U) != 0 ? 0.0625 : -0.0625;
            }
            sum += seen<d>({look_at<d>(corner, 20, 0)}, 1)[0];
        }
        CHECK(sum / std::sqrt(double{children}) == doctest::Approx(whole).epsilon(1e-12));
    }

    TEST_CASE("pixels that share a cell divide it by their shares") {
        auto const whole = seen<2>({look_at<2>({0.1, 0.1}, 20, 0)}, 1)[0];
        auto const parts = seen<2>({look_at<2>({0.1, 0.1}, 20, 0, 0.25), look_at<2>({0.11, 0.1}, 20, 1, 0.75)}, 2);
        CHECK(parts[0] + parts[1] == doctest::Approx(whole).epsilon(1e-12));
    }

    TEST_CASE("looking twice at a cell is looking once with both shares") {
        auto const once = seen<2>({look_at<2>({0.1, 0.1}, 20, 0, 0.5)}, 1, 3);
        auto const twice = seen<2>({look_at<2>({0.1, 0.1}, 20, 0, 0.2), look_at<2>({0.101, 0.1}, 20, 0, 0.3)}, 1, 3);
        for (std::size_t c = 0; c < 3; ++c) {
            CHECK(twice[c] == doctest::Approx(once[c]));
        }
    }

    TEST_CASE("one who looks at a cell and one who looks at its child share no noise") {
        constexpr std::size_t channels = 20000;
        // The large cell belongs to pixel 0 alone but for the child, which both share.
        auto const sums = seen<2>({look_at<2>({0.1, 0.1}, 18, 0), look_at<2>({0.1, 0.1}, 21, 1)}, 2, channels);
        double squares_0 = 0;
        double squares_1 = 0;
        double product = 0;
        for (std::size_t c = 0; c < channels; ++c) {
            squares_0 += sums[c] * sums[c] / channels;
            squares_1 += sums[channels + c] * sums[channels + c] / channels;
            product += sums[c] * sums[channels + c] / channels;
        }
        CHECK(std::abs(squares_0 - 1) < 4 * std::sqrt(2.0 / channels));
        CHECK(std::abs(squares_1 - 1) < 4 * std::sqrt(2.0 / channels));
        CHECK(std::abs(product) < 4 * std::sqrt(1.0 / channels));
    }

    TEST_CASE("what is seen does not depend on the order of the requests nor on other cells") {
        std::vector<noise_request<2>> requests;
        for (std::uint32_t n = 0; n < 200; ++n) {
            auto const u = uniform_value(1, random_stream::test, {n, 0, 0});
            auto const v = uniform_value(1, random_stream::test, {n, 1, 0});
            requests.push_back(look_at<2>({u, v}, 20 + n % 4, n % 17, 0.1));
        }
        auto reversed = requests;
        std::reverse(reversed.begin(), reversed.end());
        auto const a = seen(requests, 17, 2);
        auto const b = seen(reversed, 17, 2);
        for (std::size_t e = 0; e < a.size(); ++e) {
            CHECK(a[e] == doctest::Approx(b[e]).epsilon(1e-12));
        }
        auto const alone = seen<2>({look_at<2>({0.9, 0.9}, 22, 0)}, 1);
        auto const beside = seen<2>({look_at<2>({0.1, 0.1}, 24, 1), look_at<2>({0.9, 0.9}, 22, 0)}, 2);
        CHECK(beside[0] == alone[0]);
    }

    TEST_CASE("seeds objects and steps have noise of their own") {
        std::vector<noise_request<2>> const request{look_at<2>({0.1, 0.1}, 20, 0)};
        auto const value = seen(request, 1)[0];
        CHECK(seen(request, 1)[0] == value);
        CHECK(seen(request, 1, 1, 6)[0] != value);
        CHECK(seen(request, 1, 1, 5, {3})[0] != value);
        CHECK(seen(request, 1, 1, 5, {2}, 1)[0] != value);
    }

    TEST_CASE("no requests are no work") { CHECK(seen<2>({}, 3) == std::vector<double>(3, 0.0)); }
}
