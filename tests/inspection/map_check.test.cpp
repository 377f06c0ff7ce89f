// SPDX-License-Identifier: MIT
// Every defect is found on maps that have it alone, with its figure, and none on maps that have none.
#include <genrender/inspection/map_check.hpp>

#include <genrender/core/stack.hpp>
#include <genrender/maps/uv_maps.hpp>
#include <support/slanted_maps.hpp>

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

TEST_SUITE("inspection/map_check") {
    using namespace genrender;
    using testing::changed_maps;
    using testing::slanted_maps;
    using testing::visit_slanted;

    TEST_CASE("maps without defects have none") {
        auto const maps = slanted_maps(3);
        auto const check = check_maps(to_uv_view(maps));
        CHECK(check.dimensions == 2);
        CHECK(check.not_finite() == 0);
        REQUIRE(check.frames.size() == 3);
        CHECK(check.frames[0].background_share() == doctest::Approx(1 - 56.0 * 56 / 4096));
        CHECK_FALSE(check.frames[1].same_as_previous);
        REQUIRE(check.objects.size() == 1);
        auto const& object = check.objects[0];
        CHECK(object.pixels == 3 * 56 * 56);
        CHECK(object.frames.size() == 3);
        CHECK(object.range[0][0] == doctest::Approx(0.1307 + 4 * 0.00913 + 4 * 0.00171));
        CHECK(object.range[0][1] == doctest::Approx(0.1307 + 61.5 * 0.00913 + 59 * 0.00171));
        CHECK(object.side == doctest::Approx(std::sqrt(0.00913 * 0.00931 + 0.00171 * 0.00113)).epsilon(1e-3));
        CHECK(object.out_of_range == 0);
        CHECK(object.tiled == 0);
        CHECK(object.without_footprint == 0);
        CHECK(object.seams == 0);
        CHECK(object.edges == 3 * 4 * 55); // 220 on the rim
        CHECK(object.blended_edges == 0);
        CHECK(object.asked == 3 * 56 * 56);
        CHECK(object.overlapping == 0);
        CHECK(object.mirrored == 0);
        CHECK_FALSE(object.levels[0].is_quantised());
        CHECK_FALSE(object.levels[1].is_quantised());
    }

    TEST_CASE("a mirrored texture is mirrored everywhere but on its fold") {
        auto const maps = changed_maps(2, [](float& u, float& v, std::size_t row, std::size_t column) {
            u = 0.13F + 0.0091F * std::abs(static_cast<float>(column) - 31.5F);
            v = 0.19F + 0.0093F * static_cast<float>(row);
        });
        auto const object = check_maps(to_uv_view(maps)).objects.at(0);
        CHECK(object.without_footprint == 2 * 2 * 56); // both columns of the fold
        CHECK(object.asked == 2 * 54 * 56);
        CHECK(object.mirrored == object.asked);
        CHECK(object.overlapping == 0);
    }

    TEST_CASE("overlapping charts overlap with one seam between them") {
        auto const maps = changed_maps(1, [](float& u, float& v, std::size_t row, std::size_t column) {
            u = 0.13F + 0.0091F * static_cast<float>(column < 32 ? column : column - 28);
            v = 0.19F + 0.0093F * static_cast<float>(row);
        });
        auto const object = check_maps(to_uv_view(maps)).objects.at(0);
        CHECK(object.overlapping == 56 * 56);
        CHECK(object.mirrored == 0);
        CHECK(object.seams == 56);
        CHECK(object.pairs == 2 * 56 * 55);
    }

    TEST_CASE("a repeated texture leaves its range and uses places in several tiles") {
        auto const maps = changed_maps(1, [](float& u, float&, std::size_t, std::size_t column) {
            u = 0.13F + 0.04F * static_cast<float>(column);
        });
        auto const object = check_maps(to_uv_view(maps)).objects.at(0);
        CHECK(object.out_of_range == 38 * 56); // columns 22 to 59
        CHECK(object.tiled > 56 * 56 / 2);
        CHECK(object.seams == 0);
    }

    TEST_CASE("a texture that is only shifted leaves its range and repeats nothing") {
        auto const maps = changed_maps(1, [](float& u, float&, std::size_t, std::size_t) { u += 2; });
        auto const object = check_maps(to_uv_view(maps)).objects.at(0);
        CHECK(object.out_of_range == 56 * 56);
        CHECK(object.tiled == 0);
    }

    TEST_CASE("eight bits and other roundings are told apart from full floats") {
        auto const eight_bit = changed_maps(2, [](float& u, float& v, std::size_t, std::size_t) {
            u = std::round(u * 255) / 255;
            v = std::round(v * 255) / 255;
        });
        auto const object = check_maps(to_uv_view(eight_bit)).objects.at(0);
        for (auto const& levels : object.levels) {
            CHECK(levels.is_eight_bit);
            CHECK(levels.is_quantised());
            CHECK(levels.quantum_in_pixels == doctest::Approx(1 / 255.0 / 0.0092).epsilon(0.05));
        }
        auto const rounded =
            changed_maps(2, [](float& u, float&, std::size_t, std::size_t) { u = std::round(u * 100) / 100; });
        auto const coarse = check_maps(to_uv_view(rounded)).objects.at(0);
        CHECK(coarse.levels[0].is_quantised());
        CHECK_FALSE(coarse.levels[0].is_eight_bit);
        CHECK(coarse.levels[0].quantum_in_pixels == doctest::Approx(0.01 / 0.00913).epsilon(0.1));
        CHECK_FALSE(coarse.levels[1].is_quantised());
    }

    TEST_CASE("antialiased edges are blended and claim no other place") {
        auto const maps = changed_maps(1, [](float& u, float& v, std::size_t row, std::size_t column) {
            auto const is_rim = row == 4 || row == 59 || column == 4 || column == 59;
            u *= is_rim ? 0.5F : 1;
            v *= is_rim ? 0.5F : 1;
        });
        auto const object = check_maps(to_uv_view(maps)).objects.at(0);
        CHECK(object.edges == 220);
        CHECK(object.blended_edges > 200);
        CHECK(share_of(object.overlapping + object.mirrored, object.asked) < 0.02);
    }

    TEST_CASE("coordinates that do not change and those that are not finite are counted") {
        auto const flat = changed_maps(1, [](float& u, float& v, std::size_t, std::size_t) { u = v = 0.5F; });
        auto const object = check_maps(to_uv_view(flat)).objects.at(0);
        CHECK(object.without_footprint == 56 * 56);
        CHECK(object.asked == 0);
        CHECK(object.side == 0);

        auto broken = slanted_maps(2);
        broken.uv(1, 20, 20, 0) = std::numeric_limits<float>::quiet_NaN();
        broken.uv(1, 20, 21, 1) = -std::numeric_limits<float>::infinity();
        auto const check = check_maps(to_uv_view(broken));
        CHECK(check.not_finite() == 2);
        REQUIRE(check.objects[0].not_finite_frames.size() == 1);
        CHECK(check.objects[0].not_finite_frames[0] == frame_index{1});
        CHECK(check.objects[0].out_of_range == 0);
        broken.uv.fill(std::numeric_limits<float>::quiet_NaN());
        CHECK(check_maps(to_uv_view(broken)).not_finite() == 2 * 56 * 56);
    }

    TEST_CASE("huge coordinates are looked at like others") {
        auto const maps = changed_maps(1, [](float& u, float&, std::size_t, std::size_t column) {
            u = column % 2 == 0 ? std::numeric_limits<float>::max() : std::numeric_limits<float>::lowest();
        });
        auto const object = check_maps(to_uv_view(maps)).objects.at(0);
        CHECK(object.out_of_range == 56 * 56);
    }

    TEST_CASE("an object of one pixel and frames that show nothing and no frames are results") {
        uv_maps maps(3, {8, 8});
        maps.coverage(1, 3, 3) = 1;
        maps.object(1, 3, 3) = 7;
        auto const check = check_maps(to_uv_view(maps));
        REQUIRE(check.objects.size() == 1);
        CHECK(check.objects[0].object == object_index{7});
        CHECK(check.objects[0].pixels == 1);
        CHECK(check.objects[0].without_footprint == 1);
        CHECK(check.frames[0].covered == 0);
        CHECK(check.frames[2].background_share() == 1);
        CHECK(check_maps(to_uv_view(uv_maps(0, {8, 8}))).frames.empty());
        CHECK(check_maps(to_uv_view(uv_maps(1, {0, 0}))).objects.empty());
    }

    TEST_CASE("frames of a sample are evenly spread") {
        CHECK(spread_frames(3, 16).size() == 3);
        auto const frames = spread_frames(100, 4);
        REQUIRE(frames.size() == 4);
        CHECK(frames[1] == frame_index{25});
        CHECK(frames[3] == frame_index{75});
        CHECK(spread_frames(0, 4).empty());
    }

    TEST_CASE("rest positions have no tiles and are mirrored nowhere") {
        auto const uv = slanted_maps(1);
        stack<float, 4> position({1, 64, 64, 3});
        visit_slanted(uv, [&](std::size_t row, std::size_t column) {
            auto const x = static_cast<float>(column) - 31.5F;
            position(0, row, column, 0) = x; // a fold, as a mirrored texture would be cut from
            position(0, row, column, 1) = static_cast<float>(row) * 1.01F;
            position(0, row, column, 2) = 0.3F * std::abs(x);
        });
        position_maps_view const view(position.view(), to_view(uv.object), to_view(uv.coverage));
        auto const check = check_maps(view);
        CHECK(check.dimensions == 3);
        auto const& object = check.objects.at(0);
        CHECK(object.levels.size() == 3);
        CHECK(object.out_of_range == 0);
        CHECK(object.tiled == 0);
        CHECK(object.asked == 56 * 56);
        CHECK(object.overlapping == 0);
        CHECK(object.mirrored == 0);
    }

    TEST_CASE("threads change nothing") {
        auto const maps = slanted_maps(5);
        auto const one = check_maps(to_uv_view(maps));
        auto const many = check_maps(to_uv_view(maps), {}, threaded_loop(3));
        CHECK(one.objects[0].asked == many.objects[0].asked);
        CHECK(one.objects[0].side == many.objects[0].side);
        CHECK(one.objects[0].range == many.objects[0].range);
    }
}
