// SPDX-License-Identifier: MIT
// Invented scenes: the same for the same number, well filled, their paints of the set that was asked for.
#include <examples/miniature/world_scene.hpp>

#include <doctest/doctest.h>

using namespace genrender;
using namespace genrender::examples;
using namespace genrender::examples::miniature;

namespace {

lit_picture small_picture(world_scene const& drawn) {
    return draw_lit(drawn.scene, drawn.paint, {16, 16}, 1, drawn.target, drawn.shadow_radius);
}

} // namespace

TEST_SUITE("miniature/world_scene") {
    TEST_CASE("scenes are the same for the same number and fill a good part of the picture") {
        double filled = 0;
        for (std::uint32_t number = 0; number < 12; ++number) {
            auto const drawn = draw_world(4, number);
            auto const picture = small_picture(drawn);
            CHECK(picture.image == small_picture(draw_world(4, number)).image);
            for (auto const share : picture.subject_share) {
                filled += double{share} / (12 * 256);
            }
        }
        CHECK(filled > 0.15);
        CHECK(filled < 0.7);
    }

    TEST_CASE("training never shows a held-out paint and the held-out set no other") {
        for (std::uint32_t number = 0; number < 300; ++number) {
            for (auto const set : {picture_set::training, picture_set::held_out}) {
                auto const found = draw_world(5, number, set).description;
                if (found.pattern != surface_pattern::plain) {
                    CHECK(found.first != found.second);
                    CHECK(is_held_out(static_cast<std::size_t>(found.pattern), found.first, found.second) ==
                          (set == picture_set::held_out));
                }
            }
        }
    }

    TEST_CASE("a room has walls behind its things, so that no sky is seen past them") {
        std::size_t rooms = 0;
        for (std::uint32_t number = 0; number < 60; ++number) {
            auto const drawn = draw_world(6, number);
            if (!drawn.description.is_room()) {
                continue;
            }
            ++rooms;
            CHECK(drawn.description.has_ground);
            auto const seen = examples::miniature::detail::draw_surfaces(drawn.scene, {16, 16});
            std::size_t covered = 0;
            for (auto const is_covered : seen.uv.coverage) {
                covered += is_covered;
            }
            CHECK(covered > 250);
        }
        CHECK(rooms > 8);
    }

    TEST_CASE("every pattern, colour, shape and light occurs") {
        std::array<int, 6> patterns{}, colours{}, shapes{};
        std::array<int, 7> lights{};
        for (std::uint32_t number = 0; number < 300; ++number) {
            auto const found = draw_world(7, number).description;
            ++patterns[static_cast<std::size_t>(found.pattern)];
            ++colours[static_cast<std::size_t>(found.first)];
            ++shapes[static_cast<std::size_t>(found.shapes.front())];
            ++lights[static_cast<std::size_t>(found.light)];
        }
        for (auto const count : patterns) {
            CHECK(count >= 10);
        }
        for (auto const count : colours) {
            CHECK(count >= 20);
        }
        for (auto const count : shapes) {
            CHECK(count >= 20);
        }
        for (auto const count : lights) {
            CHECK(count >= 10);
        }
    }
}
