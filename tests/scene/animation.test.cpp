// SPDX-License-Identifier: MIT
// Rigid poses, the concept of an animation and its laws.
#include <genrender/scene/animation.hpp>

#include <doctest/doctest.h>

#include <genrender/testing/animation_laws.hpp>

#include <glm/ext/matrix_transform.hpp>

namespace {

using namespace genrender;

/// One triangle that goes up by one unit a frame.
struct rising_triangle {
    std::shared_ptr<mesh const> surface = std::make_shared<mesh const>(
        mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {}, {{0, 0}, {1, 0}, {0, 1}}, {{0, 1, 2}}});
    std::size_t frame_count() const { return 5; }
    posed_scene frame(frame_index i) const {
        return {{}, {pose({0}, surface, glm::translate(glm::mat4(1), {0, static_cast<float>(i.value), 0}))}};
    }
};

struct forgetful_animation {
    std::size_t frame_count() const { return 1; }
    posed_scene frame(frame_index) { return {}; } // not const: it may depend on what was asked before
};

struct still_picture {
    posed_scene frame(frame_index) const { return {}; }
};

static_assert(animation<rising_triangle>);
static_assert(!animation<forgetful_animation>);
static_assert(!animation<still_picture>);
static_assert(!animation<int>);

} // namespace

TEST_SUITE("scene/animation") {
    TEST_CASE("a rigid object's positions are its rest pose moved") {
        rising_triangle const scene;
        auto const posed = scene.frame({3}).objects[0];
        CHECK(posed.surface == scene.surface);
        REQUIRE(posed.positions.size() == 3);
        CHECK(posed.positions[0] == glm::vec3(0, 3, 0));
        CHECK(posed.positions[2] == glm::vec3(0, 4, 0));
        CHECK(scene.surface->positions[0] == glm::vec3(0, 0, 0));
    }

    TEST_CASE("a transform turns about its axis before it moves") {
        auto const turn = glm::rotate(glm::translate(glm::mat4(1), {10, 0, 0}), 1.57079633f, glm::vec3(0, 1, 0));
        auto const moved = transformed({{0, 0, 1}}, turn);
        CHECK(moved[0].x == doctest::Approx(11));
        CHECK(moved[0].z == doctest::Approx(0).epsilon(1e-6));
    }

    TEST_CASE("a formula fulfils the laws of an animation") {
        CHECK(testing::check_animation_laws(rising_triangle{}).text() == "");
    }
}
