// SPDX-License-Identifier: MIT
// Views of every stride, and of tensors that strangers own.
#include <genrender/core/strided_view.hpp>

#include <doctest/doctest.h>

#include <array>
#include <concepts>
#include <cstddef>
#include <numeric>
#include <type_traits>
#include <vector>

// An engine that has never heard of the library but for two functions beside its own tensor.
namespace toy_engine {

template <class T>
struct image {
    std::vector<T> storage;
    std::size_t rows = 0;
    std::size_t columns = 0;
};

// The engine keeps its rows bottom up.
template <class T>
genrender::strided_view<T, 2> to_view(image<T>& i) {
    auto const columns = static_cast<std::ptrdiff_t>(i.columns);
    return {i.storage.data() + static_cast<std::ptrdiff_t>(i.rows - 1) * columns, {i.rows, i.columns}, {-columns, 1}};
}

template <class T>
genrender::strided_view<T const, 2> to_view(image<T> const& i) {
    auto const columns = static_cast<std::ptrdiff_t>(i.columns);
    return {i.storage.data() + static_cast<std::ptrdiff_t>(i.rows - 1) * columns, {i.rows, i.columns}, {-columns, 1}};
}

struct without_view {
    std::vector<float> storage;
};

} // namespace toy_engine

using namespace genrender;

namespace {

std::vector<float> counted(std::size_t count) {
    std::vector<float> values(count);
    std::iota(values.begin(), values.end(), 0.0F);
    return values;
}

/// A function as the library's doors are: the out-parameter deduces, the input converts.
template <class Real>
Real sum_into(strided_view<Real, 1> out, in_view<Real, 2> in) {
    Real sum = 0;
    for (std::size_t i = 0; i < in.extent(0); ++i) {
        for (std::size_t j = 0; j < in.extent(1); ++j) {
            sum += in(i, j);
        }
    }
    out(0) = sum;
    return sum;
}

} // namespace

TEST_SUITE("core/strided_view") {
    TEST_CASE("a block is read row by row") {
        auto values = counted(24);
        strided_view<float, 3> const view(values.data(), {2, 3, 4});
        CHECK(view.strides() == std::array<std::ptrdiff_t, 3>{12, 4, 1});
        CHECK(view.size() == 24);
        CHECK(view(0, 0, 0) == 0);
        CHECK(view(1, 2, 3) == 23);
        CHECK(view(1, 0, 2) == 14);
        CHECK(view.is_contiguous());
        CHECK(view.rows_are_contiguous());
    }

    TEST_CASE("writing through a view writes the owner's memory and nothing else") {
        auto values = counted(6);
        strided_view<float, 2> const transposed(values.data(), {3, 2}, {1, 3});
        transposed(2, 1) = -1;
        CHECK(values == std::vector<float>{0, 1, 2, 3, 4, -1});
        transposed(1, 0) = -2;
        CHECK(values == std::vector<float>{0, -2, 2, 3, 4, -1});
    }

    TEST_CASE("negative strides read backwards") {
        auto values = counted(6);
        strided_view<float, 2> const turned(values.data() + 5, {2, 3}, {-3, -1});
        CHECK(turned(0, 0) == 5);
        CHECK(turned(0, 2) == 3);
        CHECK(turned(1, 2) == 0);
        CHECK(turned[1](0) == 2);
        CHECK(turned.slice(1, 1)(0, 1) == 1);
        CHECK_FALSE(turned.is_contiguous());
        CHECK_FALSE(turned.rows_are_contiguous());
    }

    TEST_CASE("stride 0 repeats an axis") {
        auto values = counted(3);
        strided_view<float const, 2> const repeated(values.data(), {4, 3}, {0, 1});
        CHECK(repeated(3, 2) == 2);
        CHECK(repeated[2].data() == values.data());
        CHECK(repeated.size() == 12);
        CHECK_FALSE(repeated.is_contiguous());
        CHECK(repeated.rows_are_contiguous());
    }

    TEST_CASE("an index of any integer type finds the same element") {
        auto values = counted(6);
        strided_view<float, 2> const view(values.data(), {2, 3});
        CHECK(view(1, 2) == 5);
        CHECK(view(std::size_t{1}, std::uint8_t{2}) == 5);
        CHECK(view(std::uint32_t{1}, std::ptrdiff_t{2}) == 5);
    }

    TEST_CASE("views of one index and of a run of indices keep the strides") {
        auto values = counted(24);
        strided_view<float, 3> const view(values.data(), {2, 3, 4});
        auto const matrix = view[1];
        CHECK(matrix.extents() == std::array<std::size_t, 2>{3, 4});
        CHECK(matrix(0, 0) == 12);
        CHECK(view[1][2](3) == 23);
        CHECK(&view[1][2](3) == &values[23]);
        auto const run = matrix.slice(1, 2);
        CHECK(run.extents() == std::array<std::size_t, 2>{2, 4});
        CHECK(run(0, 0) == 16);
        CHECK(run(1, 3) == 23);
        CHECK(matrix.slice(3, 0).size() == 0);
        CHECK(matrix.slice(0, 3).data() == matrix.data());
    }

    TEST_CASE("extents of 1 and 0 do not disturb contiguity") {
        auto values = counted(6);
        CHECK(strided_view<float, 3>(values.data(), {1, 6, 1}, {999, 1, -7}).is_contiguous());
        CHECK(strided_view<float, 2>(values.data(), {6, 1}, {1, 0}).is_contiguous());
        CHECK(strided_view<float, 2>(values.data(), {6, 1}, {1, 0}).rows_are_contiguous());
        CHECK_FALSE(strided_view<float, 2>(values.data(), {3, 1}, {2, 1}).is_contiguous());
        CHECK_FALSE(strided_view<float, 2>(values.data(), {2, 2}, {3, 1}).is_contiguous());
        CHECK(strided_view<float, 2>(values.data(), {2, 0}).is_contiguous());
        CHECK(strided_view<float, 2>(values.data(), {2, 0}).size() == 0);
        CHECK(strided_view<float, 3>().size() == 0);
    }

    TEST_CASE("a row is a span") {
        auto values = counted(6);
        strided_view<float, 2> const view(values.data(), {2, 3});
        auto const row = view[1].row();
        CHECK(row.size() == 3);
        CHECK(row.front() == 3);
        CHECK(row.back() == 5);
    }

    TEST_CASE("mutable views become constant ones and never the reverse") {
        CHECK(std::is_convertible_v<strided_view<float, 2>, strided_view<float const, 2>>);
        CHECK_FALSE(std::is_constructible_v<strided_view<float, 2>, strided_view<float const, 2>>);
        CHECK_FALSE(std::is_constructible_v<strided_view<double const, 2>, strided_view<float, 2>>);
        CHECK_FALSE(std::is_constructible_v<strided_view<float const, 2>, strided_view<float, 3>>);
        auto values = counted(6);
        strided_view<float, 2> const view(values.data() + 5, {2, 3}, {-3, -1});
        strided_view<float const, 2> const constant = view;
        CHECK(constant.data() == view.data());
        CHECK(constant.extents() == view.extents());
        CHECK(constant.strides() == view.strides());
    }

    TEST_CASE("an engine's tensor converts through the engine's own to_view") {
        using image = toy_engine::image<float>;
        CHECK(std::is_convertible_v<image&, strided_view<float, 2>>);
        CHECK(std::is_convertible_v<image&, strided_view<float const, 2>>);
        CHECK(std::is_convertible_v<image const&, strided_view<float const, 2>>);
        CHECK_FALSE(std::is_constructible_v<strided_view<float, 2>, image const&>);
        CHECK_FALSE(std::is_constructible_v<strided_view<double const, 2>, image&>);
        CHECK_FALSE(std::is_constructible_v<strided_view<float const, 3>, image&>);
        CHECK_FALSE(std::is_constructible_v<strided_view<float const, 1>, toy_engine::without_view&>);
        CHECK_FALSE(std::is_constructible_v<strided_view<float, 1>, std::vector<float>&>);

        image picture{counted(6), 2, 3};
        strided_view<float, 2> const view = picture;
        CHECK(view(0, 0) == 3);
        view(1, 2) = -1;
        CHECK(picture.storage[2] == -1);
        image const& read_only = picture;
        strided_view<float const, 2> const constant = read_only;
        CHECK(constant(1, 2) == -1);
    }

    TEST_CASE("in_view takes tensors and mutable and constant views and leaves deduction to the out-parameter") {
        float sum = 0;
        strided_view<float, 1> const out(&sum, {1});
        toy_engine::image<float> picture{counted(6), 2, 3};
        CHECK(sum_into(out, picture) == 15);
        strided_view<float, 2> const view = picture;
        CHECK(sum_into(out, view) == 15);
        CHECK(sum_into(out, strided_view<float const, 2>(view)) == 15);
        CHECK(sum == 15);
    }

    TEST_CASE("copying goes element by element between any strides") {
        auto values = counted(6);
        std::vector<float> target(12, -1.0F);
        strided_view<float, 2> const every_other(target.data(), {2, 3}, {6, 2});
        strided_view<float const, 2> const columns_first(values.data(), {2, 3}, {1, 2});
        copy(every_other, columns_first);
        CHECK(target == std::vector<float>{0, -1, 2, -1, 4, -1, 1, -1, 3, -1, 5, -1});

        toy_engine::image<float> picture{counted(6), 2, 3};
        copy(every_other, picture);
        CHECK(target == std::vector<float>{3, -1, 4, -1, 5, -1, 0, -1, 1, -1, 2, -1});

        float const one = 7;
        copy(every_other, strided_view<float const, 2>(&one, {2, 3}, {0, 0}));
        CHECK(target == std::vector<float>{7, -1, 7, -1, 7, -1, 7, -1, 7, -1, 7, -1});
    }

    TEST_CASE("copying refuses other extents before it writes") {
        auto values = counted(6);
        std::vector<float> target(6, -1.0F);
        strided_view<float, 2> const to(target.data(), {2, 3});
        CHECK_THROWS_WITH_AS(copy(to, strided_view<float const, 2>(values.data(), {3, 2})),
                             "copy: from is [3, 2], expected [2, 3]", shape_error);
        CHECK(target == std::vector<float>(6, -1.0F));
    }

    TEST_CASE("require_shape says what is and what was expected") {
        strided_view<float, 2> const view(nullptr, {2, 3});
        CHECK_NOTHROW(require_shape("f", "x", view, {2, 3}));
        CHECK_THROWS_WITH_AS(require_shape("f", "x", view, {3, 2}), "f: x is [2, 3], expected [3, 2]", shape_error);
    }

    TEST_CASE("views work in constant expressions") {
        constexpr auto last = [] {
            std::array<int, 6> values{0, 1, 2, 3, 4, 5};
            strided_view<int, 2> const view(values.data(), {2, 3});
            view(1, 2) = 8;
            return view[1](2) + view.slice(1, 1)(0, 0);
        }();
        CHECK(last == 11);
    }
}
