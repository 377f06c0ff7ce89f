// SPDX-License-Identifier: MIT
// A surface point is found where it is seen, to a fraction of a pixel, however few pixels are remembered.
#include <genrender/inspection/screen_search.hpp>

#include <genrender/maps/uv_maps.hpp>
#include <support/slanted_maps.hpp>

#include <doctest/doctest.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>

TEST_SUITE("inspection/screen_search") {
    using namespace genrender;
    using testing::slanted_maps;
    using testing::visit_slanted;

    TEST_CASE("every pixel finds itself with few pixels remembered") {
        auto const maps = slanted_maps(1);
        auto const view = to_uv_view(maps);
        for (std::size_t const most : {std::size_t{4096}, std::size_t{64}}) {
            screen_search const search(view, {0}, most);
            visit_slanted(maps, [&](std::size_t row, std::size_t column) {
                pixel const p{static_cast<std::uint32_t>(row), static_cast<std::uint32_t>(column)};
                auto const footprint = footprint_at(view, {0}, p);
                REQUIRE(footprint);
                auto const place = search.place_of({0}, view.point_at({0}, p), *footprint);
                REQUIRE(place);
                CHECK(place->at == p);
                CHECK(place->row == doctest::Approx(p.row + 0.5).epsilon(1e-3));
                CHECK(place->column == doctest::Approx(p.column + 0.5).epsilon(1e-3));
            });
        }
    }

    TEST_CASE("a surface that moved is found where it moved to") {
        auto const maps = slanted_maps(2); // 1.25 pixels to the left
        auto const view = to_uv_view(maps);
        screen_search const search(view, {1}, 256);
        auto const footprint = footprint_at(view, {0}, {30, 30});
        auto const place = search.place_of({0}, view.point_at({0}, {30, 30}), *footprint);
        REQUIRE(place);
        CHECK(place->row == doctest::Approx(30.5).epsilon(1e-3));
        CHECK(place->column == doctest::Approx(29.25).epsilon(1e-3));
        CHECK(place->offset == doctest::Approx(0.25).epsilon(1e-2));
    }

    TEST_CASE("what left the view and other objects and what is not finite are not found") {
        auto const maps = slanted_maps(2);
        auto const view = to_uv_view(maps);
        screen_search const search(view, {1}, 256);
        auto const footprint = *footprint_at(view, {0}, {30, 30});
        CHECK_FALSE(search.place_of({0}, view.point_at({0}, {30, 4}), footprint)); // now on the background
        CHECK_FALSE(search.place_of({1}, view.point_at({0}, {30, 30}), footprint));
        CHECK_FALSE(search.place_of({0}, {std::numeric_limits<float>::quiet_NaN(), 0}, footprint));
    }

    TEST_CASE("the other side of a surface is another place") {
        auto const maps = slanted_maps(1);
        auto const view = to_uv_view(maps);
        screen_search const search(view, {0});
        auto footprint = *footprint_at(view, {0}, {30, 30});
        std::swap(footprint.across, footprint.down);
        CHECK_FALSE(search.place_of({0}, view.point_at({0}, {30, 30}), footprint));
    }

    TEST_CASE("maps that show nothing or nothing finite are searched in vain") {
        auto maps = slanted_maps(1);
        maps.uv.fill(std::numeric_limits<float>::quiet_NaN());
        auto const view = to_uv_view(maps);
        surface_footprint<2> const footprint{{0.01F, 0}, {0, 0.01F}};
        CHECK_FALSE(screen_search(view, {0}).place_of({0}, {0.5F, 0.5F}, footprint));
        uv_maps const empty(1, {8, 8});
        auto const nothing = to_uv_view(empty);
        CHECK_FALSE(screen_search(nothing, {0}).place_of({0}, {0.5F, 0.5F}, footprint));
    }
}
