// SPDX-License-Identifier: MIT
// Tests of what the reference network is told.
#include <genrender/reference/network_conditioning.hpp>

#include <doctest/doctest.h>

#include <limits>

using namespace genrender;

using namespace genrender::reference;

TEST_SUITE("reference/network_conditioning") {
    TEST_CASE_TEMPLATE("inverse depth is repeated over the channels of the hint", Real, float, double) {
        stack<float, 3> depth({2, 1, 3});
        depth(1, 0, 2) = 0.5f;
        auto const hint = depth_hint<Real>(depth, 4);
        CHECK(hint.extents() == std::array<std::size_t, 4>{2, 4, 1, 3});
        for (std::size_t channel = 0; channel < 4; ++channel) {
            CHECK(hint(1, channel, 0, 2) == Real(0.5));
            CHECK(hint(0, channel, 0, 2) == 0);
        }
        depth(0, 0, 1) = std::numeric_limits<float>::infinity();
        CHECK_THROWS_WITH_AS(depth_hint<Real>(depth), "depth_hint: inverse_depth is inf, expected finite numbers",
                             value_error);
    }

    TEST_CASE_TEMPLATE("Haar bands of inverse depth are its mean and its slopes", Real, float, double) {
        stack<float, 3> depth({2, 2, 4});
        depth(1, 0, 0) = 0.5f;
        depth(1, 1, 0) = 0.25f;
        depth(1, 0, 2) = depth(1, 0, 3) = depth(1, 1, 2) = depth(1, 1, 3) = 1;
        auto const hint = haar_hint<Real>(depth);
        CHECK(hint.extents() == std::array<std::size_t, 4>{2, 4, 1, 2});
        auto const check = [&](std::size_t frame, std::size_t column, std::array<double, 4> const& expected) {
            for (std::size_t band = 0; band < 4; ++band) {
                CHECK(static_cast<double>(hint(frame, band, 0, column)) == doctest::Approx(expected[band]));
            }
        };
        check(0, 0, {-1, 0, 0, 0});
        // a = 1/2, c = 1/4: left minus right is 3/8, times 12 is clamped; the other two are 1/8.
        check(1, 0, {2 * 0.75 / 4 - 1, 4, 1.5, 1.5});
        check(1, 1, {1, 0, 0, 0});
        depth(1, 0, 0) = 0;
        depth(1, 0, 1) = depth(1, 1, 1) = 1;
        CHECK(haar_hint<Real>(depth)(1, 1, 0, 0) == -4);
    }

    TEST_CASE("a hint of the size of the latents is made of Haar bands and others are depth") {
        stack<float, 3> const depth({1, 8, 4});
        unet_config config;
        CHECK(hint_of<float>(config, depth).extents() == std::array<std::size_t, 4>{1, 4, 4, 2});
        CHECK(hint_of<float>(config, depth)(0, 0, 0, 0) == -1);
        config.conditioning_embedding_out_channels = {3, 5};
        config.conditioning_channels = 3;
        CHECK(hint_of<float>(config, depth).extents() == std::array<std::size_t, 4>{1, 3, 8, 4});
        CHECK(hint_of<float>(config, depth)(0, 0, 0, 0) == 0);
    }

    TEST_CASE("depth without Haar bands is refused by name") {
        CHECK_THROWS_WITH_AS(haar_hint<float>(stack<float, 3>({1, 5, 4})),
                             "haar_hint: height of inverse_depth is 5, expected an even number", value_error);
        CHECK_THROWS_WITH_AS(haar_hint<float>(stack<float, 3>({1, 4, 3})),
                             "haar_hint: width of inverse_depth is 3, expected an even number", value_error);
        stack<float, 3> depth({1, 2, 2});
        depth(0, 1, 1) = std::numeric_limits<float>::quiet_NaN();
        CHECK_THROWS_WITH_AS(haar_hint<float>(depth), "haar_hint: inverse_depth is nan, expected finite numbers",
                             value_error);
    }
}
