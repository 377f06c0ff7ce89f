// SPDX-License-Identifier: MIT
// Texels that two places of a surface claim.
#include <genrender/scene/uv_overlap.hpp>

#include <doctest/doctest.h>

namespace {

using namespace genrender;

/// A square of two triangles whose UVs fill the rectangle from `lower` to `upper`.
mesh square(glm::vec2 lower, glm::vec2 upper) {
    return {
        std::vector<glm::vec3>(4), {}, {lower, {upper.x, lower.y}, upper, {lower.x, upper.y}}, {{0, 1, 2}, {0, 2, 3}}};
}

} // namespace

TEST_SUITE("scene/uv_overlap") {
    TEST_CASE("two triangles that share an edge cover each texel once") {
        auto const counts = count_uv_overlap(square({0, 0}, {1, 1}), 16);
        CHECK(counts.covered == 256);
        CHECK(counts.overlapping == 0);
    }

    TEST_CASE("charts that overlap are counted where they do") {
        auto surface = square({0, 0}, {0.5f, 1});
        append(surface, square({0.25f, 0}, {0.75f, 0.5f}));
        auto const counts = count_uv_overlap(surface, 8);
        CHECK(counts.covered == 4 * 8 + 2 * 4);
        CHECK(counts.overlapping == 2 * 4);
    }

    TEST_CASE("a mirrored chart laid over itself overlaps everywhere") {
        auto surface = square({0, 0}, {1, 1});
        append(surface, square({1, 0}, {0, 1}));
        append(surface, square({0, 1}, {1, 0}));
        auto const counts = count_uv_overlap(surface, 8);
        CHECK(counts.covered == 64);
        CHECK(counts.overlapping == 64);
    }

    TEST_CASE("UVs off the texture and triangles without area fall on no texel") {
        CHECK(count_uv_overlap(square({1.5f, 0}, {2.5f, 1}), 8).covered == 0);
        CHECK(count_uv_overlap(square({-3, -3}, {-1, -1}), 8).covered == 0);
        CHECK(count_uv_overlap(square({0.5f, 0}, {0.5f, 1}), 8).covered == 0);
        CHECK(count_uv_overlap(square({0.5f, 0.5f}, {1.5f, 1.5f}), 8).covered == 16);
    }

    TEST_CASE("no texels and a broken mesh are refused by name") {
        CHECK_THROWS_WITH_AS(count_uv_overlap(square({0, 0}, {1, 1}), 0),
                             "count_uv_overlap: resolution is 0, expected at least 1", value_error);
        auto broken = square({0, 0}, {1, 1});
        broken.uvs.pop_back();
        CHECK_THROWS_WITH_AS(count_uv_overlap(broken, 4), "count_uv_overlap: mesh.uvs is [3], expected [4]",
                             shape_error);
    }
}
