// SPDX-License-Identifier: MIT
// UV maps are canonical maps of two coordinates, those of the texture; the rest is in canonical_maps.test.cpp.
#include <genrender/maps/uv_maps_view.hpp>

#include <genrender/core/error.hpp>
#include <genrender/core/stack.hpp>

#include <doctest/doctest.h>

#include <array>
#include <concepts>
#include <cstdint>

TEST_SUITE("maps/uv_maps_view") {
    using namespace genrender;

    static_assert(std::same_as<uv_maps_view, canonical_maps_view<2>>);

    TEST_CASE("[GR sec. 3] the canonical point of UV maps is the texture coordinate") {
        stack<float, 4> uv({1, 1, 2, 2});
        uv(0, 0, 1, 0) = 0.25F;
        uv(0, 0, 1, 1) = 0.75F;
        stack<std::uint32_t, 3> const object({1, 1, 2});
        stack<std::uint8_t, 3> const coverage({1, 1, 2});
        uv_maps_view const view(uv.view(), object.view(), coverage.view());
        CHECK(view.point_at({0}, {0, 1}) == std::array{0.25F, 0.75F});
    }

    TEST_CASE("what does not fit is called by the name of UV maps") {
        stack<float, 4> const rgb({1, 2, 2, 3});
        stack<std::uint32_t, 3> const object({1, 2, 2});
        stack<std::uint8_t, 3> const coverage({1, 2, 2});
        CHECK_THROWS_WITH_AS(uv_maps_view(rgb.view(), object.view(), coverage.view()),
                             "uv_maps_view: uv is [1, 2, 2, 3], expected [1, 2, 2, 2]", shape_error);
    }
}
