// SPDX-License-Identifier: MIT
// Views of the built-in path's stacks.
#include <genrender/core/tensor.hpp>

#include <doctest/doctest.h>

#include <array>
#include <numeric>
#include <type_traits>
#include <vector>

using namespace genrender;

TEST_SUITE("core/tensor") {
    TEST_CASE("a view of a tensor reads its elements") {
        auto values = tensor<float, 3>::from_shape({2, 3, 4});
        std::iota(values.begin(), values.end(), 0.0F);
        strided_view<float, 3> const view = values;
        CHECK(view.extents() == std::array<std::size_t, 3>{2, 3, 4});
        CHECK(view.is_contiguous());
        CHECK(view(1, 2, 3) == 23);
        CHECK(view(0, 1, 2) == values(0, 1, 2));
        view(1, 0, 1) = -1;
        CHECK(values(1, 0, 1) == -1);
    }

    TEST_CASE("axes of extent 1 have the strides of a row-major block") {
        // xtensor itself keeps stride 0 for them.
        for (auto const& shape : {std::array<std::size_t, 4>{1, 3, 1, 2}, {2, 1, 1, 1}, {1, 1, 1, 1}, {1, 2, 3, 1}}) {
            auto values = latents<double>::from_shape(shape);
            std::iota(values.begin(), values.end(), 0.0);
            strided_view<double const, 4> const view = values;
            CHECK(view.extents() == shape);
            CHECK(view.stride(3) == 1);
            CHECK(view.stride(2) == static_cast<std::ptrdiff_t>(shape[3]));
            CHECK(view.stride(0) == static_cast<std::ptrdiff_t>(shape[1] * shape[2] * shape[3]));
            CHECK(view(shape[0] - 1, shape[1] - 1, shape[2] - 1, shape[3] - 1) ==
                  static_cast<double>(values.size() - 1));
        }
    }

    TEST_CASE("constant tensors give constant views") {
        using owner = tensor<float, 2>;
        CHECK(std::is_convertible_v<owner&, strided_view<float, 2>>);
        CHECK(std::is_convertible_v<owner const&, strided_view<float const, 2>>);
        CHECK_FALSE(std::is_constructible_v<strided_view<float, 2>, owner const&>);
        CHECK_FALSE(std::is_constructible_v<strided_view<float const, 3>, owner&>);
        CHECK_FALSE(std::is_constructible_v<strided_view<double const, 2>, owner&>);
    }

    TEST_CASE("column-major tensors are refused rather than misread") {
        using column_major = xt::xtensor<float, 2, xt::layout_type::column_major>;
        CHECK_FALSE(std::is_constructible_v<strided_view<float, 2>, column_major&>);
        CHECK_FALSE(std::is_constructible_v<strided_view<float const, 2>, column_major const&>);
    }

    TEST_CASE("a tensor without frames has a view without elements") {
        auto const values = latents<float>::from_shape({0, 4, 8, 8});
        strided_view<float const, 4> const view = values;
        CHECK(view.size() == 0);
        CHECK(view.extent(3) == 8);
    }
}
