// SPDX-License-Identifier: MIT
// [GR sec. 3.2] The table of visible texels.
#include <genrender/correspondence/visible_texels.hpp>

#include <doctest/doctest.h>

using namespace genrender;

TEST_SUITE("correspondence/visible_texels") {
    TEST_CASE("the nearest sample shows a texel and the first offered wins a tie") {
        visible_texels::builder builder(200);
        builder.offer(3, {10}, 0.5, true, false);
        builder.offer(3, {11}, 0.2, true, false);
        builder.offer(3, {12}, 0.2, true, false);
        builder.offer(130, {13}, 0.9, true, false);
        auto const table = std::move(builder).finish();
        REQUIRE(table.entries(3).size() == 1);
        CHECK(table.entries(3)[0].token.value == 11);
        CHECK(table.entries(130)[0].token.value == 13);
        CHECK(table.entries(0).empty());
        CHECK(table.entries(199).empty());
    }
    TEST_CASE("a texel's own sample beats a nearer one from its neighbour") {
        visible_texels::builder builder(1);
        builder.offer(0, {1}, 0.4, true, false);
        builder.offer(0, {2}, 0.1, false, false);
        CHECK(std::move(builder).finish().entries(0)[0].token.value == 1);
    }
    TEST_CASE("the average shares a texel among its samples by their number") {
        visible_texels::builder builder(70);
        builder.offer(65, {4}, 0.1, true, true);
        builder.offer(65, {2}, 0.2, true, true);
        builder.offer(65, {4}, 0.3, true, true);
        builder.offer(65, {9}, 0.0, false, true);
        builder.offer(66, {9}, 1.0, false, true);
        auto const table = std::move(builder).finish();
        auto const shared = table.entries(65);
        REQUIRE(shared.size() == 2);
        CHECK(shared[0].token.value == 2);
        CHECK(shared[0].weight == doctest::Approx(1.0 / 3));
        CHECK(shared[1].token.value == 4);
        CHECK(shared[1].weight == doctest::Approx(2.0 / 3));
        REQUIRE(table.entries(66).size() == 1);
        CHECK(table.entries(66)[0].weight == 1);
    }
}
