// SPDX-License-Identifier: MIT
// The measures of a pack say where places lie on the screen, as offset_on does.
#include <genrender/correspondence/sample_pack.hpp>

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <cstddef>

using namespace genrender;

TEST_SUITE("correspondence/sample_pack") {
    TEST_CASE("a normal stands on both sides of the footprint and is as long as its area") {
        surface_footprint<3> const footprint{{1, 2, 0}, {0, 1, 3}};
        auto const normal = normal_of(footprint);
        CHECK(normal == std::array<double, 3>{6, -3, 1});
        CHECK(std::hypot(normal[0], normal[1], normal[2]) == doctest::Approx(footprint.area()));
    }

    TEST_CASE("ways right and down are in half cells") {
        // Cells of 4 rows and 8 columns; a pixel is 1/2 wide and 1/4 high.
        sample_pack<2> pack;
        pack.set(3, {{1, 2}, surface_footprint<2>{{0.5F, 0}, {0, 0.25F}}}, 4, 8);
        CHECK(pack.places[0][3] == 1);
        CHECK(pack.places[1][3] == 2);
        CHECK(pack.measures[0][3] == 0.5F); // 2 pixels a unit, 4 pixels a half cell
        CHECK(pack.measures[1][3] == 0);
        CHECK(pack.measures[2][3] == 0);
        CHECK(pack.measures[3][3] == 2); // 4 pixels a unit, 2 pixels a half cell
    }

    TEST_CASE("measures in space are those of offset_on") {
        surface_footprint<3> const footprint{{0.1F, 0.02F, -0.03F}, {-0.01F, 0.2F, 0.05F}};
        std::array<float, 3> const origin{1, -2, 3};
        std::array<float, 3> const place{1.25F, -1.75F, 3.125F};
        sample_pack<3> pack;
        pack.set(0, {origin, footprint}, 4, 4);
        std::array<double, 3> found{};
        for (std::size_t which = 0; which < 3; ++which) {
            for (std::size_t d = 0; d < 3; ++d) {
                found[which] += double{pack.measures[3 * which + d][0]} * double{place[d] - origin[d]};
            }
        }
        auto const expected = offset_on(footprint, origin, place);
        CHECK(found[0] == doctest::Approx(expected.right / 2).epsilon(1e-5));
        CHECK(found[1] == doctest::Approx(expected.down / 2).epsilon(1e-5));
        auto const limit = 0.5 * std::sqrt(footprint.area() * 16);
        CHECK(std::abs(found[2]) == doctest::Approx(expected.off_plane / limit).epsilon(1e-4));
    }

    TEST_CASE("pixels without footprint and very thin ones have no measures") {
        sample_pack<2> pack;
        pack.set(0, {{0, 0}, {}}, 4, 4);
        pack.set(1, {{0, 0}, surface_footprint<2>{{1, 0}, {1, 1e-4F}}}, 4, 4);
        pack.set(2, {{0, 0}, surface_footprint<2>{{1, 0}, {0, 0.01F}}}, 4, 4);
        for (auto const& measure : pack.measures) {
            CHECK(std::isnan(measure[0]));
            CHECK(std::isnan(measure[1]));
            CHECK_FALSE(std::isnan(measure[2]));
        }
    }
}
