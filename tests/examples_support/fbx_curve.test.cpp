// SPDX-License-Identifier: MIT
// Cubic curves and steps of FBX followed by straight lines.
#include <examples/support/fbx_curve.hpp>

#include <doctest/doctest.h>

#include <cmath>

using namespace genrender::examples;

namespace {

constexpr std::int64_t second = 46186158000;
constexpr std::int32_t cubic = 0x8, found = 0x108, no_overshoot = 0x4108, set = 0x408;

/// Straight between the keys.
double at(fbx_curve const& curve, double seconds) {
    auto const time = seconds * static_cast<double>(second);
    std::size_t i = 1;
    while (i + 1 < curve.times.size() && static_cast<double>(curve.times[i]) <= time) {
        ++i;
    }
    auto const begin = static_cast<double>(curve.times[i - 1]);
    auto const share = (time - begin) / (static_cast<double>(curve.times[i]) - begin);
    return static_cast<double>(curve.values[i - 1]) * (1 - share) + static_cast<double>(curve.values[i]) * share;
}

fbx_curve straight(fbx_curve const& curve) {
    auto const result = straightened(curve);
    REQUIRE(result);
    return *result;
}

} // namespace

TEST_SUITE("examples_support/fbx_curve") {
    TEST_CASE("a cubic of two keys with found tangents eases in and out") {
        auto const curve = straight({{0, second}, {10, 30}, {{found}, {found}}});
        for (double t = 0; t <= 1; t += 0.0173) {
            CHECK(std::abs(at(curve, t) - (10 + 20 * t * t * (3 - 2 * t))) < 20 * 2e-4);
        }
        CHECK(curve.times.front() == 0);
        CHECK(curve.times.back() == second);
    }

    TEST_CASE("tangents that were set are slopes a second and each side has its own") {
        // Hermite: from 0 with slope 3 to 1 over two seconds with slope -2
        auto const curve = straight({{0, 2 * second}, {0, 1}, {{set, 3, -2, 0}, {set, 99, 99, 0}}});
        for (double t = 0; t <= 2; t += 0.0371) {
            auto const s = t / 2;
            auto const exact = 2 * 3 * s * (1 - s) * (1 - s) - 2 * -2 * s * s * (1 - s) + s * s * (3 - 2 * s);
            CHECK(std::abs(at(curve, t) - exact) < 2e-3);
        }
    }

    TEST_CASE("weights stretch the tangents and time with them") {
        // Control points at 9/10 and 1/10 of the time: x(u) = 2.7 u (1-u)^2 + 0.3 u^2 (1-u) + u^3
        std::int32_t const flags = set | 0x1000000 | 0x2000000;
        std::uint32_t const weights = 9000u | (9000u << 16);
        auto const curve = straight({{0, second}, {0, 1}, {{flags, 0, 0, weights}, {set}}});
        for (double u = 0.05; u < 1; u += 0.05) {
            auto const x = 2.7 * u * (1 - u) * (1 - u) + 0.3 * u * u * (1 - u) + u * u * u;
            auto const y = 3 * u * u * (1 - u) + u * u * u;
            CHECK(std::abs(at(curve, x) - y) < 3e-3);
        }
    }

    TEST_CASE("a found tangent goes from neighbour to neighbour") {
        fbx_curve const keys{{0, second, 3 * second}, {0, 1, 4}, {{found}, {found}, {found}}};
        auto const curve = straight(keys);
        auto const slope = (at(curve, 1.01) - at(curve, 0.99)) / 0.02;
        CHECK(slope == doctest::Approx(4 / 3.0).epsilon(0.02));
    }

    TEST_CASE("a curve that must not overshoot stays between its keys and is flat where it turns") {
        fbx_curve keys{{0, second, 2 * second, 3 * second}, {0, 1, 1.05f, -4}, {}};
        keys.attributes.assign(4, {found});
        auto over = 0.0, kept = 0.0;
        for (double t = 0; t <= 3; t += 0.01) {
            over = std::max(over, at(straight(keys), t));
        }
        keys.attributes.assign(4, {no_overshoot});
        auto const curve = straight(keys);
        for (double t = 0; t <= 3; t += 0.01) {
            kept = std::max(kept, at(curve, t));
        }
        CHECK(over > 1.06);
        CHECK(kept <= 1.0501);
        CHECK(std::abs(at(curve, 2.01) - 1.05) < 4e-3); // from neighbour to neighbour it would have lost 0.025
    }

    TEST_CASE("a step stays until the next key or goes there at once") {
        auto const stays = straight({{0, second}, {2, 5}, {{2}, {2}}});
        CHECK(at(stays, 0.999) == doctest::Approx(2));
        CHECK(at(stays, 1) == doctest::Approx(5));
        auto const goes = straight({{0, second}, {2, 5}, {{2 | 0x100}, {2}}});
        CHECK(at(goes, 0) == doctest::Approx(2));
        CHECK(at(goes, 0.001) == doctest::Approx(5));
    }

    TEST_CASE("what is straight already or makes no sense is left alone") {
        CHECK(!straightened({{0, second}, {2, 5}, {{4}, {4}}}));
        CHECK(!straightened({{0, second}, {5, 5}, {{found}, {found}}}));
        CHECK(!straightened({{0, second}, {0, 1}, {{set, 1, 1, 0}, {set}}})); // its tangents lie on the line
        CHECK(!straightened({{0}, {2}, {{cubic}}}));
        CHECK(!straightened({}));
        CHECK(!straightened({{0, second}, {0}, {{found}, {found}}}));
        CHECK(!straightened({{0, second}, {0, 1}, {{found}}}));
        CHECK(!straightened({{second, 0}, {0, 1}, {{found}, {found}}}));
        CHECK(!straightened({{0, 0}, {0, 1}, {{found}, {found}}}));
    }

    TEST_CASE("motion that was sampled once a frame grows to twice its keys at most") {
        fbx_curve keys;
        for (std::int64_t i = 0; i < 100; ++i) {
            keys.times.push_back(i * second / 30);
            keys.values.push_back(std::sin(static_cast<float>(i)));
            keys.attributes.push_back({found});
        }
        CHECK(straight(keys).times.size() <= 200);
    }
}
