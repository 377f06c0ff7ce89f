// SPDX-License-Identifier: MIT
// Shapes of the small world: they can be drawn, and are of about unit size.
#include <examples/miniature/world_shapes.hpp>

#include <doctest/doctest.h>

using namespace genrender;
using namespace genrender::examples;
using namespace genrender::examples::miniature;

TEST_SUITE("miniature/world_shapes") {
    TEST_CASE("every shape is a mesh that can be drawn, from half of to four times its size across") {
        for (std::size_t shape = 0; shape < shape_words.size(); ++shape) {
            for (std::uint32_t i = 0; i < 20; ++i) {
                random_draw draw(4, i);
                auto const surface = draw_shape(draw, static_cast<world_shape>(shape), 1);
                CHECK_NOTHROW(validate(surface));
                auto lower = glm::vec3(1e9f);
                auto upper = -lower;
                for (auto const& p : surface.positions) {
                    lower = glm::min(lower, p);
                    upper = glm::max(upper, p);
                }
                auto const size = upper - lower;
                CHECK(std::min({size.x, size.y, size.z}) > 0.5f);
                CHECK(std::max({size.x, size.y, size.z}) < 4.5f);
            }
        }
    }

    TEST_CASE("patterns go around what is turned, lie on faces of boxes, and go through figures") {
        CHECK(layout_of(world_shape::vase) == pattern_layout::turned);
        CHECK(layout_of(world_shape::box) == pattern_layout::box);
        CHECK(layout_of(world_shape::figure) == pattern_layout::solid);
    }
}
