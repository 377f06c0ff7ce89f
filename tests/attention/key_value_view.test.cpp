// SPDX-License-Identifier: MIT
// Views of stored features: what converts to them, and what they read.
#include <genrender/attention/key_value_view.hpp>

#include <genrender/core/linalg.hpp>
#include <genrender/core/stack.hpp>

#include <doctest/doctest.h>

#include <array>
#include <type_traits>

using namespace genrender;

TEST_SUITE("attention/key_value_view") {
    TEST_CASE_TEMPLATE("a stored view reads any storage as Real", Real, float, double) {
        stack<Real, 2> full({3, 2});
        stack<float16, 2> half({3, 2});
        stack<bfloat16, 2> brain({3, 2});
        full(2, 1) = Real{0.1F};
        half(2, 1) = static_cast<float16>(0.1F);
        brain(2, 1) = static_cast<bfloat16>(0.1F);
        CHECK(stored_view<Real>(full)(2, 1) == Real{0.1F});
        CHECK(stored_view<Real>(half)(2, 1) == static_cast<Real>(half(2, 1)));
        CHECK(stored_view<Real>(brain.view())(2, 1) == static_cast<Real>(brain(2, 1)));
        CHECK(stored_view<Real>(half.view()).visit([](auto const& view) { return sizeof(*view.data()); }) == 2);
        CHECK(stored_view<Real>().extents() == std::array<std::size_t, 2>{0, 0});
    }

    TEST_CASE("a slice begins at its first token") {
        stack<float16, 2> half({5, 2});
        half(3, 1) = static_cast<float16>(7.0F);
        auto const slice = stored_view<float>(half).slice(2, 3);
        CHECK(slice.extents() == std::array<std::size_t, 2>{3, 2});
        CHECK(slice.extent(0) == 3);
        CHECK(slice(1, 1) == 7);
    }

    TEST_CASE("other element types and ranks do not convert") {
        CHECK(std::is_convertible_v<strided_view<float, 2>, stored_view<float>>);
        CHECK(std::is_convertible_v<strided_view<float16 const, 2>, stored_view<double>>);
        CHECK_FALSE(std::is_convertible_v<strided_view<double, 2>, stored_view<float>>);
        CHECK_FALSE(std::is_convertible_v<strided_view<float, 3>, stored_view<float>>);
        CHECK_FALSE(std::is_convertible_v<stored_view<double>, stored_view<float>>);
    }

    TEST_CASE("keys and values count once each unless said otherwise") {
        stack<float, 2> const K({4, 2});
        key_value_view<float> const block{K, K};
        CHECK(block.counts.extent(0) == 0);
    }
}
