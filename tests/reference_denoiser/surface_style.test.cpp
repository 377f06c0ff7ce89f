// SPDX-License-Identifier: MIT
// Styles: shares of colours, width of features, scattered dots, noise.
#include <examples/reference_denoiser/surface_style.hpp>

#include <genrender/scene/primitives.hpp>

#include <doctest/doctest.h>

using namespace genrender;
using namespace genrender::examples;

namespace {

constexpr palette two_colours{{1, 0, 0}, {0, 0, 1}, {0, 1, 0}};

painted_surface painted(surface_style style, float feature, std::uint32_t number = 0) {
    random_draw draw(3, number);
    return painted_surface(draw, style, two_colours, make_sphere(1), feature);
}

/// The share of points in a cube whose colour is the first, or else the second or the third.
std::array<double, 3> shares(painted_surface const& surface) {
    std::array<double, 3> counts{};
    for (std::uint32_t i = 0; i < 4000; ++i) {
        random_draw draw(9, i);
        auto const colour = surface.colour_at(draw.direction());
        counts[colour.r > 0 ? 0 : colour.b > 0 ? 1 : 2] += 1.0 / 4000;
    }
    return counts;
}

} // namespace

TEST_SUITE("reference_denoiser/surface_style") {
    TEST_CASE("plain is the first colour everywhere") {
        CHECK(shares(painted(surface_style::plain, 0.2f))[0] == doctest::Approx(1));
    }

    TEST_CASE("stripes and squares give both colours about half of the surface") {
        for (auto const style : {surface_style::stripes, surface_style::checker}) {
            auto const found = shares(painted(style, 0.1f));
            CHECK(found[0] == doctest::Approx(0.5).epsilon(0.2));
            CHECK(found[1] == doctest::Approx(0.5).epsilon(0.2));
        }
    }

    TEST_CASE("a stripe is as wide as a feature") {
        auto const surface = painted(surface_style::stripes, 0.25f);
        // The greatest number of changes along any way of one unit is four, along the axis of the stripes.
        std::size_t most = 0;
        for (std::uint32_t i = 0; i < 400; ++i) {
            random_draw draw(4, i);
            auto const way = draw.direction();
            std::size_t changes = 0;
            for (int k = 0; k < 2000; ++k) {
                auto const t = static_cast<float>(k) / 2000;
                changes += surface.colour_at(way * t).r != surface.colour_at(way * (t + 0.0005f)).r ? 1U : 0U;
            }
            most = std::max(most, changes);
        }
        CHECK(most >= 3);
        CHECK(most <= 5);
    }

    TEST_CASE("dots are a part of the surface and all three tones of camo occur") {
        auto const dots = shares(painted(surface_style::dots, 0.2f));
        CHECK(dots[1] > 0.1);
        CHECK(dots[1] < 0.6);
        std::array<double, 3> tones{};
        for (std::uint32_t number = 0; number < 8; ++number) {
            auto const found = shares(painted(surface_style::camo, 0.2f, number));
            for (std::size_t c = 0; c < 3; ++c) {
                tones[c] += found[c] / 8;
            }
        }
        CHECK(*std::min_element(tones.begin(), tones.end()) > 0.15);
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
