// SPDX-License-Identifier: MIT
// Cubic curves and steps of FBX followed by straight lines.
#include <examples/support/fbx_curve.hpp>

#include <doctest/doctest.h>

#include <cmath>

using namespace genrender::examples;

namespace {

constexpr std::int64_t fbx_second = 46186158000;
constexpr std::int32_t key_cubic = 0x8, key_found = 0x108, key_level = 0x4108, key_set = 0x408;

/// Straight between the keys.
double curve_at(fbx_curve const& curve, double seconds) {
    auto const time = seconds * static_cast<double>(fbx_second);
    std::size_t i = 1;
    while (i + 1 < curve.times.size() && static_cast<double>(curve.times[i]) <= time) {
        ++i;
    }
    auto const begin = static_cast<double>(curve.times[i - 1]);
    auto const share = (time - begin) / (static_cast<double>(curve.times[i]) - begin);
    return static_cast<double>(curve.values[i - 1]) * (1 - share) + static_cast<double>(curve.values[i]) * share;
}

fbx_curve straight_of(fbx_curve const& curve) {
    auto const result = straightened(curve);
    REQUIRE(result);
    return *result;
}

} // namespace

TEST_SUITE("examples_support/fbx_curve") {
    TEST_CASE("a cubic of two keys with found tangents eases in and out") {
        auto const curve = straight_of({{0, fbx_second}, {10, 30}, {{key_found}, {key_found}}});
        for (double t = 0; t <= 1; t += 0.0173) {
            CHECK(std::abs(curve_at(curve, t) - (10 + 20 * t * t * (3 - 2 * t))) < 20 * 2e-4);
        }
        CHECK(curve.times.front() == 0);
        CHECK(curve.times.back() == fbx_second);
    }

    TEST_CASE("tangents that were set are slopes a second and each side has its own") {
        // Hermite: from 0 with slope 3 to 1 over two seconds with slope -2
        auto const curve = straight_of({{0, 2 * fbx_second}, {0, 1}, {{key_set, 3, -2, 0}, {key_set, 99, 99, 0}}});
        for (double t = 0; t <= 2; t += 0.0371) {
            auto const s = t / 2;
            auto const exact = 2 * 3 * s * (1 - s) * (1 - s) - 2 * -2 * s * s * (1 - s) + s * s * (3 - 2 * s);
            CHECK(std::abs(curve_at(curve, t) - exact) < 2e-3);
        }
    }

    TEST_CASE("weights stretch the tangents and time with them") {
        // Control points at 9/10 and 1/10 of the time: x(u) = 2.7 u (1-u)^2 + 0.3 u^2 (1-u) + u^3
        std::int32_t const flags = key_set | 0x1000000 | 0x2000000;
        std::uint32_t const weights = 9000u | (9000u << 16);
        auto const curve = straight_of({{0, fbx_second}, {0, 1}, {{flags, 0, 0, weights}, {key_set}}});
        for (double u = 0.05; u < 1; u += 0.05) {
            auto const x = 2.7 * u * (1 - u) * (1 - u) + 0.3 * u * u * (1 - u) + u * u * u;
            auto const y = 3 * u * u * (1 - u) + u * u * u;
            CHECK(std::abs(curve_at(curve, x) - y) < 3e-3);
        }
    }

    TEST_CASE("a found tangent goes from neighbour to neighbour") {
        fbx_curve const keys{{0, fbx_second, 3 * fbx_second}, {0, 1, 4}, {{key_found}, {key_found}, {key_found}}};
        auto const curve = straight_of(keys);
        auto const slope = (curve_at(curve, 1.01) - curve_at(curve, 0.99)) / 0.02;
        CHECK(slope == doctest::Approx(4 / 3.0).epsilon(0.02));
    }

    TEST_CASE("a curve that must not overshoot stays between its keys and is flat where it turns") {
        fbx_curve keys{{0, fbx_second, 2 * fbx_second, 3 * fbx_second}, {0, 1, 1.05f, -4}, {}};
        keys.attributes.assign(4, {key_found});
        auto over = 0.0, kept = 0.0;
        for (double t = 0; t <= 3; t += 0.01) {
            over = std::max(over, curve_at(straight_of(keys), t));
        }
        keys.attributes.assign(4, {key_level});
        auto const curve = straight_of(keys);
        for (double t = 0; t <= 3; t += 0.01) {
            kept = std::max(kept, curve_at(curve, t));
        }
        CHECK(over > 1.06);
        CHECK(kept <= 1.0501);
        CHECK(std::abs(curve_at(curve, 2.01) - 1.05) < 4e-3); // from neighbour to neighbour it would have lost 0.025
    }

    TEST_CASE("a step stays until the next key or goes there at once") {
        auto const stays = straight_of({{0, fbx_second}, {2, 5}, {{2}, {2}}});
        CHECK(curve_at(stays, 0.999) == doctest::Approx(2));
        CHECK(curve_at(stays, 1) == doctest::Approx(5));
        auto const goes = straight_of({{0, fbx_second}, {2, 5}, {{2 | 0x100}, {2}}});
        CHECK(curve_at(goes, 0) == doctest::Approx(2));
        CHECK(curve_at(goes, 0.001) == doctest::Approx(5));
    }

    TEST_CASE("what is straight already or makes no sense is left alone") {
        CHECK(!straightened({{0, fbx_second}, {2, 5}, {{4}, {4}}}));
        CHECK(!straightened({{0, fbx_second}, {5, 5}, {{key_found}, {key_found}}}));
        CHECK(
            !straightened({{0, fbx_second}, {0, 1}, {{key_set, 1, 1, 0}, {key_set}}})); // its tangents lie on the line
        CHECK(!straightened({{0}, {2}, {{key_cubic}}}));
        CHECK(!straightened({}));
        CHECK(!straightened({{0, fbx_second}, {0}, {{key_found}, {key_found}}}));
        CHECK(!straightened({{0, fbx_second}, {0, 1}, {{key_found}}}));
        CHECK(!straightened({{fbx_second, 0}, {0, 1}, {{key_found}, {key_found}}}));
        CHECK(!straightened({{0, 0}, {0, 1}, {{key_found}, {key_found}}}));
    }

    TEST_CASE("motion that was sampled once a frame grows to twice its keys at most") {
        fbx_curve keys;
        for (std::int64_t i = 0; i < 100; ++i) {
            keys.times.push_back(i * fbx_second / 30);
            keys.values.push_back(std::sin(static_cast<float>(i)));
            keys.attributes.push_back({key_found});
        }
        CHECK(straight_of(keys).times.size() <= 200);
    }
}
