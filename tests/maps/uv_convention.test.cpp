// SPDX-License-Identifier: MIT
// Maps of other renderers, brought to v downwards and inside the texture.
#include <genrender/maps/uv_convention.hpp>

#include <genrender/core/stack.hpp>

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <limits>

namespace {

using namespace genrender;

/// What becomes of one covered (u, v).
std::array<float, 2> adopted(float u, float v, uv_convention convention) {
    stack<float, 4> uv({1, 1, 1, 2});
    stack<std::uint8_t, 3> coverage({1, 1, 1});
    uv(0, 0, 0, 0) = u;
    uv(0, 0, 0, 1) = v;
    coverage(0, 0, 0) = 1;
    adopt_uv(uv.view(), coverage.view(), convention);
    return {uv(0, 0, 0, 0), uv(0, 0, 0, 1)};
}

} // namespace

TEST_SUITE("maps/uv_convention") {
    TEST_CASE("the library's own convention changes nothing") {
        CHECK(adopted(0.25f, 0.75f, {}) == std::array{0.25f, 0.75f});
        CHECK(adopted(-3.5f, 7, {}) == std::array{-3.5f, 7.0f});
    }

    TEST_CASE("v upwards is turned and turning twice gives back the maps") {
        uv_convention const upwards{true, uv_outside::keep};
        CHECK(adopted(0.25f, 0.75f, upwards) == std::array{0.25f, 0.25f});
        CHECK(adopted(0, 0, upwards) == std::array{0.0f, 1.0f});
        auto const once = adopted(0.3f, 0.125f, upwards);
        CHECK(adopted(once[0], once[1], upwards) == std::array{0.3f, 0.125f});
    }

    TEST_CASE("clamping goes to the nearest border") {
        uv_convention const clamp{false, uv_outside::clamp};
        CHECK(adopted(-0.5f, 1.5f, clamp) == std::array{0.0f, 1.0f});
        CHECK(adopted(0.5f, 1, clamp) == std::array{0.5f, 1.0f});
    }

    TEST_CASE("wrapping repeats the texture and leaves its borders in place") {
        uv_convention const wrap{false, uv_outside::wrap};
        CHECK(adopted(1.25f, -0.25f, wrap) == std::array{0.25f, 0.75f});
        CHECK(adopted(-3, 4.5f, wrap) == std::array{0.0f, 0.5f});
        CHECK(adopted(1, 0, wrap) == std::array{1.0f, 0.0f});
        // A hair below the texture is the opposite border, never beyond it.
        CHECK(adopted(-1e-12f, 0.5f, wrap) == std::array{1.0f, 0.5f});
    }

    TEST_CASE("v is turned before it is brought inside") {
        CHECK(adopted(0, 1.25f, {true, uv_outside::clamp}) == std::array{0.0f, 0.0f});
        CHECK(adopted(0, 1.25f, {true, uv_outside::wrap}) == std::array{0.0f, 0.75f});
    }

    TEST_CASE("values that are not finite and pixels that show nothing stay") {
        auto const nan = adopted(std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
                                 {true, uv_outside::clamp});
        CHECK(std::isnan(nan[0]));
        CHECK(std::isinf(nan[1]));
        stack<float, 4> uv({1, 1, 1, 2});
        stack<std::uint8_t, 3> coverage({1, 1, 1});
        uv(0, 0, 0, 1) = 9;
        adopt_uv(uv.view(), coverage.view(), {true, uv_outside::clamp});
        CHECK(uv(0, 0, 0, 1) == 9);
    }

    TEST_CASE("maps that do not fit each other are refused by name") {
        stack<float, 4> uv({1, 2, 2, 2});
        stack<std::uint8_t, 3> coverage({1, 2, 3});
        CHECK_THROWS_WITH_AS(adopt_uv(uv.view(), coverage.view(), {}),
                             "adopt_uv: uv is [1, 2, 2, 2], expected [1, 2, 3, 2]", shape_error);
    }
}
