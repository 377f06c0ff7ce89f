// SPDX-License-Identifier: MIT
// Light, shadow, air and inverse depth of painted pictures.
#include <examples/miniature/lit_picture.hpp>
#include <genrender/scene/primitives.hpp>

#include <doctest/doctest.h>

#include <glm/ext/matrix_transform.hpp>

using namespace genrender;
using namespace genrender::examples;
using namespace genrender::examples::miniature;

namespace {

/// An eye above a grey ground, and whatever floats between them.
struct grey_world {
    posed_scene scene;
    picture_paint paint;

    explicit grey_world(bool with_ball) {
        scene.camera = look_at({0, 8, 6}, {0, 0, 0}, 0.8f);
        add(make_plane({40, 40}, 2), {0, 0, 0}, 0);
        if (with_ball) {
            add(make_sphere(0.8f), {0, 2.5f, 0}, 1);
        }
        paint.horizon = paint.zenith = {0, 0, 1};
    }

    void add(mesh surface, glm::vec3 at, std::uint8_t is_subject) {
        random_draw draw(1, 0);
        auto const shared = std::make_shared<mesh const>(std::move(surface));
        object_index const number{static_cast<std::uint32_t>(scene.objects.size())};
        scene.objects.push_back(pose(number, shared, glm::translate(glm::mat4(1), at)));
        paint_recipe recipe;
        recipe.first = glm::vec3(0.5f);
        paint.surfaces.emplace_back(draw, recipe, *shared);
        paint.is_subject.push_back(is_subject);
    }

    lit_picture picture() const { return draw_lit(scene, paint, {16, 16}, 2, {0, 1, 0}, 5); }
};

} // namespace

TEST_SUITE("miniature/lit_picture") {
    TEST_CASE("a level ground in full light has its own colour but for the air before it") {
        auto const picture = grey_world(false).picture();
        // Seen 53 degrees from below the horizontal at a distance of ten, through air that keeps 1 / e of 40 units
        auto const clear = std::exp(-10.0f / 40);
        auto const ground = 0.5f * (0.84f + 0.16f * 0.8f);
        CHECK(picture.image(0, 8, 8) == doctest::Approx(ground * clear).epsilon(0.03));
        CHECK(picture.image(2, 8, 8) == doctest::Approx(ground * clear + 1 - clear).epsilon(0.03));
        CHECK(picture.subject_share(8, 8) == 0);
    }

    TEST_CASE("the light's colour multiplies the surface's") {
        grey_world world(true);
        auto const white = world.picture();
        world.paint.tint = {1, 0.5f, 1};
        auto const tinted = world.picture();
        auto found = false;
        for (std::size_t p = 0; p < 256; ++p) {
            if (white.subject_share(p / 16, p % 16) == 1) {
                found = true;
                CHECK(tinted.image(1, p / 16, p % 16) == doctest::Approx(0.5f * white.image(1, p / 16, p % 16)));
                CHECK(tinted.image(0, p / 16, p % 16) == white.image(0, p / 16, p % 16));
            }
        }
        CHECK(found);
    }

    TEST_CASE("what floats throws a shadow straight down") {
        auto const bright = grey_world(false).picture();
        auto const shaded = grey_world(true).picture();
        auto darkest = 1.0f;
        for (std::size_t row = 0; row < 16; ++row) {
            for (std::size_t column = 0; column < 16; ++column) {
                if (shaded.subject_share(row, column) == 0) {
                    darkest = std::min(darkest, shaded.image(0, row, column) / bright.image(0, row, column));
                }
            }
        }
        CHECK(darkest == doctest::Approx(0.6f).epsilon(0.08));
    }

    TEST_CASE("surfaces that face up are brighter than those that face down") {
        grey_world world(true);
        world.scene.camera = look_at({0, 2.5f, 6}, {0, 2.5f, 0}, 0.4f);
        auto const picture = world.picture();
        REQUIRE(picture.subject_share(4, 8) == 1);
        REQUIRE(picture.subject_share(11, 8) == 1);
        CHECK(picture.image(0, 4, 8) > 1.2f * picture.image(0, 11, 8));
    }

    TEST_CASE("clouds whiten parts of the sky and leave others") {
        grey_world world(false);
        world.scene.objects.clear();
        world.paint.surfaces.clear();
        world.paint.is_subject.clear();
        world.scene.camera = look_at({0, 1, 0}, {0, 1.3f, -1}, 0.9f);
        world.paint.clouds = 1;
        auto const picture = world.picture();
        auto lowest = 1.0f;
        auto highest = 0.0f;
        for (std::size_t p = 0; p < 256; ++p) {
            lowest = std::min(lowest, picture.image(0, p / 16, p % 16));
            highest = std::max(highest, picture.image(0, p / 16, p % 16));
        }
        CHECK(lowest < 0.1f);
        CHECK(highest > 0.9f);
    }

    TEST_CASE("inverse depth is one at the nearest point") {
        auto const near = grey_world(true).picture().inverse_depth;
        auto highest = 0.0f;
        for (auto const value : near) {
            CHECK(value >= 0);
            CHECK(value <= 1);
            highest = std::max(highest, value);
        }
        CHECK(highest > 0.9f);
    }

    TEST_CASE("paint for another number of objects is refused") {
        grey_world world(true);
        world.paint.surfaces.pop_back();
        CHECK_THROWS_WITH_AS(world.picture(), "draw_lit: paint.surfaces is [1], expected [2]", shape_error);
    }
}
