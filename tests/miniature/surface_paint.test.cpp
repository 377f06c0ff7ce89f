// SPDX-License-Identifier: MIT
// Patterns: shares of their colours, width of features, how they lie on boxes and round things; materials.
#include <examples/miniature/surface_paint.hpp>

#include <genrender/scene/primitives.hpp>

#include <doctest/doctest.h>

#include <array>
#include <cmath>

using namespace genrender;
using namespace genrender::examples;
using namespace genrender::examples::miniature;

namespace {

constexpr glm::vec3 red{1, 0, 0};
constexpr glm::vec3 blue{0, 0, 1};

surface_paint painted(surface_pattern pattern, pattern_layout layout, mesh const& surface, float feature,
                      std::uint32_t number = 0) {
    random_draw draw(3, number);
    return surface_paint(draw, {pattern, surface_material::smooth, layout, red, blue, feature}, surface);
}

/// The share of a ball's surface that has the second colour.
double second_share_of_ball(surface_pattern pattern, pattern_layout layout) {
    auto const paint = painted(pattern, layout, make_sphere(1), 0.1f);
    double share = 0;
    for (std::uint32_t i = 0; i < 4000; ++i) {
        random_draw draw(9, i);
        share += double{paint.colour_at(draw.direction()).b} / 4000;
    }
    return share;
}

} // namespace

TEST_SUITE("miniature/surface_paint") {
    TEST_CASE("plain is the first colour everywhere") {
        CHECK(second_share_of_ball(surface_pattern::plain, pattern_layout::turned) == 0);
    }

    TEST_CASE("squares, stripes and waves give both colours about half of the surface") {
        for (auto const layout : {pattern_layout::solid, pattern_layout::turned}) {
            for (auto const pattern : {surface_pattern::checker, surface_pattern::stripes, surface_pattern::waves}) {
                CHECK(second_share_of_ball(pattern, layout) == doctest::Approx(0.5).epsilon(0.2));
            }
        }
    }

    TEST_CASE("dots and joints are the smaller part") {
        for (auto const layout : {pattern_layout::solid, pattern_layout::turned}) {
            for (auto const pattern : {surface_pattern::dots, surface_pattern::bricks}) {
                auto const share = second_share_of_ball(pattern, layout);
                CHECK(share > 0.15);
                CHECK(share < 0.55);
            }
        }
    }

    TEST_CASE("a stripe is as wide as a feature") {
        auto const paint = painted(surface_pattern::stripes, pattern_layout::solid, make_sphere(1), 0.25f);
        std::size_t changes = 0;
        for (int k = -1000; k < 1000; ++k) {
            auto const y = static_cast<float>(k) / 1000;
            changes += paint.colour_at({0, y, 0}) != paint.colour_at({0, y + 0.001f, 0}) ? 1U : 0U;
        }
        CHECK(changes == 8);
    }

    TEST_CASE("a box has whole squares between its faces and no face lies in an edge of its pattern") {
        auto const size = glm::vec3(1.13f, 0.9f, 2.07f);
        for (std::uint32_t number = 0; number < 20; ++number) {
            auto const paint = painted(surface_pattern::checker, pattern_layout::box, make_box(size), 0.3f, number);
            for (int axis = 0; axis < 3; ++axis) {
                // Just inside and just outside of both faces the colours are the same
                for (auto const side : {-0.5f, 0.5f}) {
                    glm::vec3 p{0.11f, 0.07f, 0.13f};
                    p[axis] = size[axis] * side * 0.98f;
                    auto q = p;
                    q[axis] = size[axis] * side * 1.02f;
                    CHECK(paint.colour_at(p) == paint.colour_at(q));
                }
            }
        }
    }

    TEST_CASE("a pattern around an axis closes where it began") {
        auto const paint = painted(surface_pattern::checker, pattern_layout::turned, make_sphere(1), 0.23f);
        std::size_t changes = 0;
        auto const at = [](int k) {
            auto const angle = static_cast<float>(k) * 6.283185307f / 3600;
            return glm::vec3(std::sin(angle), 0.05f, std::cos(angle));
        };
        for (int k = 0; k < 3600; ++k) {
            changes += paint.colour_at(at(k)) != paint.colour_at(at(k + 1)) ? 1U : 0U;
        }
        CHECK(changes % 2 == 0);
        CHECK(std::abs(static_cast<double>(changes) - 6.2832 / 0.23) < 3);
    }

    TEST_CASE("a pattern too small to be seen is the mean of its colours") {
        auto const paint = painted(surface_pattern::checker, pattern_layout::flat, make_plane({4, 4}), 0.1f);
        CHECK(glm::distance(paint.colour_at({0.33f, 0, 0.21f}, 0), (red + blue) * 0.5f) < 1e-6f);
        auto const plain = painted(surface_pattern::plain, pattern_layout::flat, make_plane({4, 4}), 0.1f);
        CHECK(plain.colour_at({0.33f, 0, 0.21f}, 0) == red);
    }

    TEST_CASE("wood and stone change the brightness of a colour by a few parts in a hundred") {
        for (auto const material : {surface_material::wood, surface_material::stone}) {
            random_draw draw(5, 1);
            surface_paint const paint(
                draw, {surface_pattern::plain, material, pattern_layout::solid, glm::vec3(0.5f), {}, 0.1f},
                make_sphere(1));
            double sum = 0;
            double squares = 0;
            for (std::uint32_t i = 0; i < 2000; ++i) {
                random_draw place(6, i);
                auto const value = double{paint.colour_at(place.direction()).r};
                sum += value / 2000;
                squares += value * value / 2000;
            }
            auto const deviation = std::sqrt(squares - sum * sum) / sum;
            CHECK(sum == doctest::Approx(0.5).epsilon(0.05));
            CHECK(deviation > 0.03);
            CHECK(deviation < 0.15);
        }
    }

    TEST_CASE("scattered points keep their distance and lie on the surface") {
        random_draw draw(8, 0);
        auto const points = scattered_points(draw, make_sphere(1, 64), 0.5f);
        CHECK(points.size() > 20);
        for (std::size_t i = 0; i < points.size(); ++i) {
            CHECK(glm::length(points[i]) == doctest::Approx(1).epsilon(0.01));
            for (std::size_t j = 0; j < i; ++j) {
                CHECK(glm::distance(points[i], points[j]) >= 0.5f);
            }
        }
    }

    TEST_CASE("gradient noise has mean zero and is zero at whole numbers") {
        CHECK(gradient_noise(1, {3, -2, 5}) == doctest::Approx(0).epsilon(1e-6));
        double sum = 0;
        double squares = 0;
        for (std::uint32_t i = 0; i < 20000; ++i) {
            random_draw draw(2, i);
            auto const value = double{gradient_noise(7, draw.direction() * draw.uniform(0, 50))};
            sum += value / 20000;
            squares += value * value / 20000;
        }
        CHECK(std::abs(sum) < 0.02);
        CHECK(std::sqrt(squares) > 0.15);
        CHECK(std::sqrt(squares) < 0.45);
    }
}
