// SPDX-License-Identifier: MIT
// A mesh is refused by name or keeps what it was given.
#include <genrender/scene/mesh.hpp>

#include <doctest/doctest.h>

#include <limits>

namespace {

using namespace genrender;

mesh one_triangle() { return {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {}, {{0, 0}, {1, 0}, {0, 1}}, {{0, 1, 2}}}; }

} // namespace

TEST_SUITE("scene/mesh") {
    TEST_CASE("a mesh without normals and an empty mesh are valid") {
        CHECK_NOTHROW(validate(one_triangle()));
        CHECK_NOTHROW(validate(mesh{}));
    }

    TEST_CASE("what is wrong with a mesh is named") {
        auto const nan = std::numeric_limits<float>::quiet_NaN();
        auto surface = one_triangle();
        surface.uvs.pop_back();
        CHECK_THROWS_WITH_AS(validate(surface), "validate: mesh.uvs is [2], expected [3]", shape_error);

        surface = one_triangle();
        surface.normals.resize(2);
        CHECK_THROWS_WITH_AS(validate(surface), "validate: mesh.normals is [2], expected [3]", shape_error);

        surface = one_triangle();
        surface.positions[2].z = nan;
        CHECK_THROWS_WITH_AS(validate(surface),
                             "validate: mesh.positions[2] is not finite, expected finite coordinates", value_error);

        surface = one_triangle();
        surface.uvs[1].y = std::numeric_limits<float>::infinity();
        CHECK_THROWS_WITH_AS(validate(surface, "load"), "load: mesh.uvs[1] is not finite, expected finite coordinates",
                             value_error);

        surface = one_triangle();
        surface.triangles.push_back({0, 3, 1});
        CHECK_THROWS_WITH_AS(validate(surface), "validate: mesh.triangles[1] is [0, 3, 1], expected vertices below 3",
                             value_error);
    }

    TEST_CASE("appended triangles name the appended vertices") {
        auto whole = one_triangle();
        auto part = one_triangle();
        part.positions[0] = {5, 6, 7};
        append(whole, part);
        REQUIRE(whole.positions.size() == 6);
        REQUIRE(whole.triangles.size() == 2);
        CHECK(whole.triangles[0] == glm::uvec3(0, 1, 2));
        CHECK(whole.triangles[1] == glm::uvec3(3, 4, 5));
        CHECK(whole.positions[3] == glm::vec3(5, 6, 7));
        CHECK_NOTHROW(validate(whole));
    }

    TEST_CASE("normals stay where both meshes have them") {
        auto with = one_triangle();
        with.normals.assign(3, {0, 0, 1});
        mesh whole;
        append(whole, with);
        append(whole, with);
        CHECK(whole.normals.size() == 6);
        append(whole, one_triangle());
        CHECK(whole.normals.empty());
        append(whole, with);
        CHECK(whole.normals.empty());
        CHECK_NOTHROW(validate(whole));
    }

    TEST_CASE("a chart moves into its rectangle of the atlas") {
        auto surface = one_triangle();
        place_uvs(surface, {0.5f, 0.25f}, {1.0f, 0.5f});
        CHECK(surface.uvs[0] == glm::vec2(0.5f, 0.25f));
        CHECK(surface.uvs[1] == glm::vec2(1.0f, 0.25f));
        CHECK(surface.uvs[2] == glm::vec2(0.5f, 0.5f));
    }
}
