// SPDX-License-Identifier: MIT
// No gap, no double cover, and the weights of what is seen.
#include <genrender/scene/triangle_coverage.hpp>

#include <genrender/core/random.hpp>

#include <doctest/doctest.h>

#include <cstdint>
#include <vector>

namespace {

using namespace genrender;

using corners_type = std::array<glm::dvec3, 3>;

/// How many of the triangles cover p.
int claims(std::vector<corners_type> const& triangles, glm::dvec2 p) {
    int count = 0;
    for (auto const& corners : triangles) {
        auto const coverage = triangle_coverage::of(corners);
        count += coverage && coverage->at(p);
    }
    return count;
}

/// A grid of cells x cells quadrilaterals over [0, cells]^2, each cut in two along either diagonal; vertex places and
/// depths from `vertex_at`.
template <class VertexAt>
std::vector<corners_type> cut_grid(std::uint32_t cells, VertexAt const& vertex_at) {
    std::vector<corners_type> triangles;
    for (std::uint32_t row = 0; row < cells; ++row) {
        for (std::uint32_t column = 0; column < cells; ++column) {
            auto const a = vertex_at(row, column), b = vertex_at(row, column + 1);
            auto const c = vertex_at(row + 1, column), d = vertex_at(row + 1, column + 1);
            if ((row * 7 + column * 3) % 2 == 0) {
                triangles.push_back({a, b, d});
                triangles.push_back({d, c, a});
            } else {
                triangles.push_back({b, c, a});
                triangles.push_back({b, c, d}); // wound the other way
            }
        }
    }
    return triangles;
}

} // namespace

TEST_SUITE("scene/triangle_coverage") {
    TEST_CASE("weights reproduce the point they were asked for") {
        corners_type const corners{{{-1, -1, -2}, {3, 0, -5}, {0, 2, -1}}};
        auto const coverage = triangle_coverage::of(corners);
        REQUIRE(coverage);
        glm::dvec2 const p{0.1, 0.2};
        auto const weight = coverage->at(p);
        REQUIRE(weight);
        auto const point = weight->x * corners[0] + weight->y * corners[1] + weight->z * corners[2];
        CHECK(point.x / -point.z == doctest::Approx(p.x));
        CHECK(point.y / -point.z == doctest::Approx(p.y));
        CHECK(weight->x + weight->y + weight->z == doctest::Approx(1));
    }

    TEST_CASE("a point outside or behind the eye is not covered") {
        corners_type const corners{{{-1, -1, -2}, {1, -1, -2}, {0, 1, -2}}};
        auto const ahead = triangle_coverage::of(corners);
        REQUIRE(ahead);
        CHECK(ahead->at({0, 0}));
        CHECK_FALSE(ahead->at({0.9, 0.9}));
        auto const behind = triangle_coverage::of({{-corners[0], -corners[1], -corners[2]}});
        REQUIRE(behind);
        CHECK_FALSE(behind->at({0, 0}));
    }

    TEST_CASE("a triangle that reaches behind the eye is seen up to its horizon") {
        // The floor y = -1 from far behind to far ahead: seen below the horizon y = 0 only.
        auto const floor = triangle_coverage::of({{{-1e4, -1, 1e3}, {1e4, -1, 1e3}, {0, -1, -1e5}}});
        REQUIRE(floor);
        CHECK(floor->at({0, -0.5}));
        CHECK(floor->at({0, -10}));
        CHECK(floor->at({0, -0.001}));
        CHECK_FALSE(floor->at({0, 0.001}));
        CHECK_FALSE(floor->at({0, 10}));
    }

    TEST_CASE("a point on a shared edge or vertex belongs to exactly one triangle") {
        // Vertices on a lattice of quarters, so that edges and vertices pass exactly through many of the points.
        for (std::uint32_t seed = 0; seed < 4; ++seed) {
            auto const triangles = cut_grid(8, [&](std::uint32_t row, std::uint32_t column) {
                auto const inside = row > 0 && row < 8 && column > 0 && column < 8;
                auto const shift = [&](std::uint32_t axis) {
                    return inside ? 0.25 * (static_cast<double>(
                                                uniform_below(3, seed, random_stream::test, {row, column, axis})) -
                                            1)
                                  : 0.0;
                };
                // A power of two as depth keeps the lattice exact.
                auto const depth =
                    static_cast<double>(1U << uniform_below(4, seed, random_stream::test, {row, column, 2}));
                return glm::dvec3((column + shift(0)) * depth, (row + shift(1)) * depth, -depth);
            });
            for (std::uint32_t row = 1; row < 32; ++row) {
                for (std::uint32_t column = 1; column < 32; ++column) {
                    REQUIRE(claims(triangles, {column * 0.25, row * 0.25}) == 1);
                }
            }
        }
    }

    TEST_CASE("neighbours in space leave no gap and no double cover anywhere") {
        for (std::uint32_t seed = 10; seed < 13; ++seed) {
            auto const random = [&](std::uint32_t row, std::uint32_t column, std::uint32_t axis) {
                return uniform_value(seed, random_stream::test, {row, column, axis});
            };
            auto const triangles = cut_grid(8, [&](std::uint32_t row, std::uint32_t column) {
                auto const inside = row > 0 && row < 8 && column > 0 && column < 8;
                auto const depth = 0.5 + 3 * random(row, column, 2);
                auto const x = column + (inside ? 0.5 * (random(row, column, 0) - 0.5) : 0);
                auto const y = row + (inside ? 0.5 * (random(row, column, 1) - 0.5) : 0);
                return glm::dvec3(x * depth, y * depth, -depth);
            });
            for (std::uint32_t i = 0; i < 2000; ++i) {
                auto const x = 0.01 + 7.98 * uniform_value(seed, random_stream::test, {i, 1000, 0});
                auto const y = 0.01 + 7.98 * uniform_value(seed, random_stream::test, {i, 1000, 1});
                REQUIRE(claims(triangles, {x, y}) == 1);
            }
        }
    }

    TEST_CASE("the left and the top edge belong to a triangle and the right and the bottom do not") {
        corners_type const upper_left{{{0, 0, -1}, {0, 1, -1}, {1, 1, -1}}};
        auto const coverage = triangle_coverage::of(upper_left);
        REQUIRE(coverage);
        CHECK(coverage->at({0, 0.5}));         // left edge
        CHECK(coverage->at({0.5, 1}));         // top edge: y is up
        CHECK_FALSE(coverage->at({0.5, 0.5})); // the diagonal, on its right
        CHECK(coverage->at({0, 1}));           // the corner of left and top
        CHECK_FALSE(coverage->at({1, 1}));
    }

    TEST_CASE("a triangle without area to the eye covers nothing") {
        CHECK_FALSE(triangle_coverage::of({{{0, 0, -1}, {1, 1, -1}, {2, 2, -1}}}));
        CHECK_FALSE(triangle_coverage::of({{{1, 2, -3}, {1, 2, -3}, {2, 2, -1}}}));
        CHECK_FALSE(triangle_coverage::of({{{0, -1, -1}, {0, 1, -2}, {0, 3, -7}}})); // its plane holds the eye
        CHECK_FALSE(triangle_coverage::of({{{0, 0, 0}, {1, 0, -1}, {0, 1, -1}}}));
    }
}
