// SPDX-License-Identifier: MIT
// A frame counts all its pixels, object by object, and compares no more of them than it is told to.
#include <genrender/inspection/frame_inspection.hpp>

#include <genrender/maps/uv_maps.hpp>
#include <support/slanted_maps.hpp>

#include <doctest/doctest.h>

#include <cstddef>
#include <limits>
#include <map>

TEST_SUITE("inspection/frame_inspection") {
    using namespace genrender;
    using testing::slanted_maps;

    TEST_CASE("all pixels are counted by object") {
        auto maps = slanted_maps(2);
        maps.object(1, 30, 30) = 9;
        maps.uv(1, 30, 30, 0) = std::numeric_limits<float>::quiet_NaN();
        auto const view = to_uv_view(maps);
        frame_inspection<uv_maps_view> second;
        second.count(view, {1});
        CHECK(second.frame.pixels == 4096);
        CHECK(second.frame.covered == 56 * 56);
        CHECK_FALSE(second.frame.same_as_previous);
        REQUIRE(second.objects.size() == 2);
        CHECK(second.objects.at({0}).pixels == 56 * 56 - 1);
        CHECK(second.objects.at({9}).not_finite == 1);
        CHECK(second.objects.at({9}).range.empty());
    }

    TEST_CASE("a frame that shows what the one before shows is known and the first has none before") {
        auto maps = slanted_maps(1);
        uv_maps twice(2, maps.grid());
        testing::visit_slanted(maps, [&](std::size_t row, std::size_t column) {
            for (std::size_t i = 0; i < 2; ++i) {
                twice.coverage(i, row, column) = 1;
                twice.uv(i, row, column, 0) = maps.uv(0, row, column, 0);
            }
        });
        auto const view = to_uv_view(twice);
        frame_inspection<uv_maps_view> first;
        frame_inspection<uv_maps_view> second;
        first.count(view, {0});
        second.count(view, {1});
        CHECK_FALSE(first.frame.same_as_previous);
        CHECK(second.frame.same_as_previous);
    }

    TEST_CASE("neighbours and questions keep to their limits") {
        auto const maps = slanted_maps(1);
        auto const view = to_uv_view(maps);
        frame_inspection<uv_maps_view> one;
        one.count(view, {0});
        std::map<object_index, object_check> objects;
        objects[{0}].side = 0.0093;
        auto const all = compare_pixels(view, {0}, {}, one.frame, objects);
        CHECK(all.at({0}).looked_at == 56 * 56);
        CHECK(all.at({0}).pairs == 2 * 56 * 55);
        CHECK(all.at({0}).asked == 56 * 56);
        auto const some = compare_pixels(view, {0}, {.pixels = 1024, .questions = 200}, one.frame, objects);
        CHECK(some.at({0}).looked_at <= 1024);
        CHECK(some.at({0}).looked_at >= 700);
        CHECK(some.at({0}).asked <= 230);
        CHECK(some.at({0}).asked >= 100);
    }
}
