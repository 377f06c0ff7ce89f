// SPDX-License-Identifier: MIT
// Parametrisations made for meshes without one: nothing overlaps.
#include <examples/support/triangle_atlas.hpp>

#include <genrender/scene/primitives.hpp>
#include <genrender/scene/uv_overlap.hpp>

#include <doctest/doctest.h>

using namespace genrender;
using examples::make_triangle_atlas;

TEST_SUITE("examples_support/triangle_atlas") {
    TEST_CASE("no two places of a surface share a texel and all of them are on the texture") {
        mesh fan; // triangles that meet in one vertex only
        for (int i = 0; i < 7; ++i) {
            auto const x = static_cast<float>(i);
            fan.positions.insert(fan.positions.end(), {{0, 0, 0}, {x, 1, 0}, {x + 0.5f, 1, 0}});
            fan.triangles.push_back(glm::uvec3(0, 1, 2) + 3u * static_cast<unsigned>(i));
        }
        for (auto const& surface : {make_sphere(1), make_box({1, 2, 3}), fan, make_plane({1, 1}, 9)}) {
            auto const atlas = make_triangle_atlas(surface);
            validate(atlas.surface);
            CHECK(atlas.surface.triangles.size() == surface.triangles.size());
            auto const overlap = count_uv_overlap(atlas.surface, 512);
            CHECK(overlap.overlapping == 0);
            CHECK(overlap.covered > 512 * 512 / 4);
            for (auto const& uv : atlas.surface.uvs) {
                CHECK(uv.x >= 0);
                CHECK(uv.x <= 1);
                CHECK(uv.y >= 0);
                CHECK(uv.y <= 1);
            }
        }
    }

    TEST_CASE("the shape stays as it was") {
        auto const surface = make_sphere(1);
        auto const atlas = make_triangle_atlas(surface);
        REQUIRE(atlas.source.size() == atlas.surface.positions.size());
        for (std::size_t i = 0; i < atlas.source.size(); ++i) {
            CHECK(atlas.surface.positions[i] == surface.positions[atlas.source[i]]);
            CHECK(atlas.surface.normals[i] == surface.normals[atlas.source[i]]);
        }
        for (std::size_t i = 0; i < surface.triangles.size(); ++i) {
            auto const& t = atlas.surface.triangles[i];
            auto const sources = std::array{atlas.source[t.x], atlas.source[t.y], atlas.source[t.z]};
            auto const& given = surface.triangles[i];
            for (auto const vertex : {given.x, given.y, given.z}) {
                CHECK(std::count(sources.begin(), sources.end(), vertex) == 1);
            }
        }
    }

    TEST_CASE("two triangles of one quadrilateral are neighbours on the texture too") {
        mesh quad;
        quad.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
        quad.triangles = {{0, 1, 2}, {0, 2, 3}};
        auto const atlas = make_triangle_atlas(quad);
        // Corner by corner: vertices 0 and 2 are in both triangles and have one place on the texture each
        for (std::uint32_t const shared : {0u, 2u}) {
            std::vector<glm::vec2> places;
            for (std::size_t i = 0; i < atlas.source.size(); ++i) {
                if (atlas.source[i] == shared) {
                    places.push_back(atlas.surface.uvs[i]);
                }
            }
            REQUIRE(places.size() == 2);
            CHECK(places[0] == places[1]);
        }
    }
}
