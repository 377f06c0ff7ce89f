// SPDX-License-Identifier: MIT
// The block of memory that the library owns.
#include <genrender/core/stack.hpp>

#include <doctest/doctest.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <new>
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

    TEST_CASE_TEMPLATE("a block begins at a cache line", Real, float, double, std::uint8_t) {
        for (std::size_t const size : {1U, 3U, 1000U}) {
            auto const memory = stack<Real, 1>::uninitialized({size});
            CHECK(memory.size() == size);
            CHECK(reinterpret_cast<std::uintptr_t>(memory.data()) % 64 == 0);
            stack<Real, 1> const zeros({size});
            CHECK(reinterpret_cast<std::uintptr_t>(zeros.data()) % 64 == 0);
        }
        CHECK(stack<Real, 1>().size() == 0);
    }

    TEST_CASE("copies own their numbers and moves take them along") {
        auto a = stack<float, 1>::uninitialized({2});
        a.data()[0] = 1;
        a.data()[1] = 2;
        auto b = a;
        b.data()[0] = 5;
        CHECK(a.data()[0] == 1);
        CHECK(b.data()[1] == 2);
        auto const* const where = b.data();
        a = std::move(b);
        CHECK(a.data() == where);
        CHECK(a.data()[0] == 5);
        auto const c = std::move(a);
        CHECK(c.data() == where);
        CHECK(c.size() == 2);
        CHECK(a.size() == 0); // a stack of none, not of freed elements
        CHECK(a.data() == nullptr);
    }

    TEST_CASE("elements may be records and a stack of more bytes than there are is refused") {
        struct record {
            std::uint32_t token;
            float quality;
        };
        stack<record, 1> records({2});
        CHECK(records(1).token == 0);
        CHECK(records(1).quality == 0);
        auto const half = std::numeric_limits<std::size_t>::max() / 2 + 1;
        CHECK_THROWS_AS((stack<double, 1>({half})), std::bad_alloc);
        CHECK_THROWS_AS((stack<float, 2>({half, half})), std::bad_alloc);
        CHECK((stack<float, 3>({half, half, 0})).size() == 0);
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
