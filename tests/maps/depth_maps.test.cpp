// SPDX-License-Identifier: MIT
// One scale of inverse depth for the whole sequence.
#include <genrender/maps/depth_maps.hpp>

#include <doctest/doctest.h>

#include <limits>

TEST_SUITE("maps/depth_maps") {
    using namespace genrender;

    TEST_CASE("new maps show nothing") {
        depth_maps const maps(2, {3, 4});
        CHECK(maps.frame_count() == 2);
        CHECK(maps.grid() == grid_extents{3, 4});
        for (auto const value : sequence_inverse_depth(maps)) {
            REQUIRE(value == 0);
        }
    }

    TEST_CASE("[GR sec. 3] frames at different distances share one scale") {
        // Inverse depths 1, 1/2 in the near frame and 1/2, 1/4 in the far one: a scale per frame would make both 1 and
        // 0.
        depth_maps maps(2, {1, 3});
        maps.depth = {{{1, 2, 9}}, {{2, 4, 9}}};
        maps.coverage = {{{1, 1, 0}}, {{1, 1, 0}}};
        auto const inverse = sequence_inverse_depth(maps);
        CHECK(inverse(0, 0, 0) == 1);
        CHECK(inverse(0, 0, 1) == doctest::Approx(1.0 / 3));
        CHECK(inverse(1, 0, 0) == inverse(0, 0, 1)); // equally far, equally grey, whatever the frame
        CHECK(inverse(1, 0, 1) == 0);
    }

    TEST_CASE("the background is 0 and its depth is not looked at") {
        depth_maps maps(1, {1, 3});
        maps.depth = {{{3, std::numeric_limits<float>::quiet_NaN(), 5}}};
        maps.coverage = {{{1, 0, 1}}};
        auto const inverse = sequence_inverse_depth(maps);
        CHECK(inverse(0, 0, 0) == 1);
        CHECK(inverse(0, 0, 1) == 0);
        CHECK(inverse(0, 0, 2) == 0);
    }

    TEST_CASE("a scene that is equally far everywhere is 1") {
        depth_maps maps(2, {2, 2});
        maps.depth.fill(7);
        maps.coverage.fill(1);
        maps.coverage(0, 0, 0) = 0;
        auto const inverse = sequence_inverse_depth(maps);
        CHECK(inverse(0, 0, 0) == 0);
        CHECK(inverse(0, 0, 1) == 1);
        CHECK(inverse(1, 1, 1) == 1);
    }

    TEST_CASE("impossible depths are refused by name") {
        depth_maps maps(1, {1, 2});
        maps.coverage.fill(1);
        maps.depth = {{{1, 0}}};
        CHECK_THROWS_WITH_AS(
            sequence_inverse_depth(maps),
            "sequence_inverse_depth: maps.depth is 0.000000, expected finite depths above 0 where covered",
            value_error);
        maps.depth = {{{1, -2}}};
        CHECK_THROWS_AS(sequence_inverse_depth(maps), value_error);
        maps.depth = {{{1, std::numeric_limits<float>::quiet_NaN()}}};
        CHECK_THROWS_AS(sequence_inverse_depth(maps), value_error);
        maps.depth = {{{1, std::numeric_limits<float>::infinity()}}};
        CHECK_THROWS_AS(sequence_inverse_depth(maps), value_error);
    }

    TEST_CASE("maps that differ in extents are refused by name") {
        depth_maps maps(1, {1, 2});
        maps.coverage = tensor<std::uint8_t, 3>::from_shape({1, 2, 2});
        CHECK_THROWS_WITH_AS(sequence_inverse_depth(maps),
                             "sequence_inverse_depth: maps.depth is [1, 1, 2], expected [1, 2, 2]", shape_error);
    }
    TEST_CASE("cell means are the means of the pixels under a cell") {
        auto map = tensor<float, 3>::from_shape({1, 2, 4});
        for (std::size_t e = 0; e < 8; ++e) {
            map.data()[e] = static_cast<float>(e);
        }
        auto const means = cell_means(map, {1, 2});
        CHECK(means(0, 0, 0) == doctest::Approx((0 + 1 + 4 + 5) / 4.0));
        CHECK(means(0, 0, 1) == doctest::Approx((2 + 3 + 6 + 7) / 4.0));
        CHECK_THROWS_WITH_AS(cell_means(map, {2, 3}),
                             "cell_means: grid is [2, 3], expected extents that divide the maps' [2, 4]", value_error);
    }
}
