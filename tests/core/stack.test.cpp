// SPDX-License-Identifier: MIT
// The block of memory that the library owns.
#include <genrender/core/stack.hpp>

#include <doctest/doctest.h>

#include <array>
#include <type_traits>
#include <utility>

using namespace genrender;

TEST_SUITE("core/stack") {
    TEST_CASE_TEMPLATE("a new stack holds zeros in one row-major block", Real, float, double, std::uint8_t) {
        stack<Real, 3> values({2, 3, 4});
        CHECK(values.size() == 24);
        CHECK(values.extents() == std::array<std::size_t, 3>{2, 3, 4});
        CHECK(values.extent(1) == 3);
        CHECK(values.view().is_contiguous());
        for (std::size_t i = 0; i < values.size(); ++i) {
            CHECK(values.data()[i] == Real{0});
        }
        values(1, 2, 3) = Real{9};
        CHECK(values.data()[23] == Real{9});
        CHECK(std::as_const(values)(1, 2, 3) == Real{9});
    }

    TEST_CASE("copies share nothing") {
        stack<double, 1> first({3});
        auto second = first;
        second(1) = 5;
        CHECK(first(1) == 0);
        CHECK(second.view().data() != first.view().data());
    }

    TEST_CASE("an empty stack has an empty view") {
        stack<float, 2> const none;
        CHECK(none.size() == 0);
        CHECK(none.view().size() == 0);
        stack<float, 2> const no_rows({0, 5});
        CHECK(no_rows.size() == 0);
        CHECK(no_rows.view().extents() == std::array<std::size_t, 2>{0, 5});
    }

    TEST_CASE("a stack converts to views as constant as it is") {
        using owner = stack<float, 2>;
        CHECK(std::is_convertible_v<owner&, strided_view<float, 2>>);
        CHECK(std::is_convertible_v<owner&, strided_view<float const, 2>>);
        CHECK(std::is_convertible_v<owner const&, strided_view<float const, 2>>);
        CHECK_FALSE(std::is_constructible_v<strided_view<float, 2>, owner const&>);
        CHECK_FALSE(std::is_constructible_v<strided_view<float, 3>, owner&>);
        owner values({2, 2});
        strided_view<float, 2> const view = values;
        view(1, 0) = 3;
        CHECK(values(1, 0) == 3);
    }
}
