// SPDX-License-Identifier: MIT
// Light, shadow, haze and inverse depth of painted pictures.
#include <examples/reference_denoiser/lit_render.hpp>
#include <examples/reference_denoiser/training_scene.hpp>

#include <genrender/scene/primitives.hpp>

#include <doctest/doctest.h>

using namespace genrender;
using namespace genrender::examples;

namespace {

/// An eye above a grey ground, and whatever floats between them.
struct small_world {
    posed_scene scene;
    scene_paint paint;

    explicit small_world(bool with_ball) {
        scene.camera = look_at({0, 8, 6}, {0, 0, 0}, 0.8f);
        random_draw draw(1, 0);
        add(draw, make_plane({40, 40}, 2), {0, 0, 0}, 0);
        if (with_ball) {
            add(draw, make_sphere(0.8f), {0, 2.5f, 0}, 1);
        }
        paint.horizon = paint.zenith = {0, 0, 1};
    }

    void add(random_draw& draw, mesh surface, glm::vec3 at, std::uint8_t is_patterned) {
        auto const shared = std::make_shared<mesh const>(std::move(surface));
        object_index const number{static_cast<std::uint32_t>(scene.objects.size())};
        scene.objects.push_back(pose(number, shared, glm::translate(glm::mat4(1), at)));
        palette const grey{glm::vec3(0.5f), glm::vec3(0.5f), glm::vec3(0.5f)};
        paint.surfaces.emplace_back(draw, surface_style::plain, grey, *shared, 1.0f);
        paint.is_patterned.push_back(is_patterned);
    }

    lit_picture picture() const { return render_lit(scene, paint, {16, 16}, 2, {0, 1, 0}, 5); }
};

} // namespace

TEST_SUITE("reference_denoiser/lit_render") {
    TEST_CASE("a level ground in full light has its own colour but for the haze") {
        auto const picture = small_world(false).picture();
        // Haze of exp(-10 / 30) towards blue at a distance of ten
        auto const clear = std::exp(-10.0f / 30);
        CHECK(picture.image(0, 8, 8) == doctest::Approx(0.5f * clear).epsilon(0.05));
        CHECK(picture.image(2, 8, 8) == doctest::Approx(0.5f * clear + 1 - clear).epsilon(0.05));
        CHECK(picture.pattern_share(8, 8) == 0);
    }

    TEST_CASE("what floats throws a shadow straight down") {
        auto const bright = small_world(false).picture();
        auto const shaded = small_world(true).picture();
        auto darkest = 1.0f;
        for (std::size_t row = 0; row < 16; ++row) {
            for (std::size_t column = 0; column < 16; ++column) {
                if (shaded.pattern_share(row, column) == 0) {
                    darkest = std::min(darkest, shaded.image(0, row, column) / bright.image(0, row, column));
                }
            }
        }
        CHECK(darkest == doctest::Approx(0.62f).epsilon(0.08));
    }

    TEST_CASE("surfaces that face up are brighter than those that face down") {
        auto world = small_world(true);
        world.scene.camera = look_at({0, 2.5f, 6}, {0, 2.5f, 0}, 0.4f);
        auto const picture = world.picture();
        auto const up = picture.image(0, 4, 8);
        auto const down = picture.image(0, 11, 8);
        REQUIRE(picture.pattern_share(4, 8) == 1);
        REQUIRE(picture.pattern_share(11, 8) == 1);
        CHECK(up > 1.2f * down);
    }

    TEST_CASE("inverse depth is one at the nearest point") {
        auto const near = small_world(true).picture().inverse_depth;
        auto highest = 0.0f;
        for (auto const value : near) {
            CHECK(value >= 0);
            CHECK(value <= 1);
            highest = std::max(highest, value);
        }
        CHECK(highest > 0.9f);
    }

    TEST_CASE("paint for another number of objects is refused") {
        auto world = small_world(true);
        world.paint.surfaces.pop_back();
        CHECK_THROWS_WITH_AS(world.picture(), "render_lit: paint.surfaces is [1], expected [2]", shape_error);
    }

    TEST_CASE("scenes to learn from are the same for the same number and fill a good part of the picture") {
        double filled = 0;
        for (std::uint32_t number = 0; number < 12; ++number) {
            auto const drawn = draw_training_scene(4, number);
            auto const again = draw_training_scene(4, number);
            auto const picture = render_lit(drawn.scene, drawn.paint, {16, 16}, 1, drawn.target, drawn.shadow_radius);
            auto const same = render_lit(again.scene, again.paint, {16, 16}, 1, again.target, again.shadow_radius);
            CHECK(picture.image == same.image);
            for (auto const share : picture.pattern_share) {
                filled += double{share} / (12 * 256);
            }
        }
        CHECK(filled > 0.15);
    }
}
