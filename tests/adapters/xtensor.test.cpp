// SPDX-License-Identifier: MIT
// Views and xtensor's arrays, adaptors and slices show the same elements.
#include <genrender/adapters/xtensor.hpp>

#include <doctest/doctest.h>

#if __has_include(<xtensor/views/xview.hpp>)
#include <xtensor/containers/xarray.hpp>
#include <xtensor/views/xview.hpp>
#else
#include <xtensor/xarray.hpp>
#include <xtensor/xview.hpp>
#endif

#include <array>
#include <cstddef>
#include <numeric>
#include <vector>

using namespace genrender;

TEST_SUITE("adapters/xtensor") {
    using adapters::to_xtensor;
    using adapters::view_of;

    TEST_CASE("an xtensor of a view has its elements, whatever the strides, and writes to them") {
        std::vector<float> memory(60);
        std::iota(memory.begin(), memory.end(), 0.0f);
        strided_view<float, 3> const view(memory.data() + 1, {2, 3, 4}, {1, 16, 3});
        auto x = to_xtensor(view);
        for (std::size_t i = 0; i < 2; ++i) {
            for (std::size_t j = 0; j < 3; ++j) {
                for (std::size_t k = 0; k < 4; ++k) {
                    CHECK(&x(i, j, k) == &view(i, j, k));
                }
            }
        }
        x += 100.0f;
        CHECK(view(1, 2, 3) == 100 + 1 + 1 + 32 + 9);
        CHECK(memory[0] == 0);
    }

    TEST_CASE("an xtensor of a view computes with its elements alone") {
        std::array<float, 6> memory{1, 2, 3, 4, 5, 6};
        strided_view<float const, 2> const view(memory.data(), {2, 1}, {3, 9});
        xt::xtensor<float, 2> const wide = xt::zeros<float>({2, 3});
        xt::xtensor<float, 2> const sum = wide + to_xtensor(view);
        CHECK(sum(0, 2) == 1);
        CHECK(sum(1, 2) == 4);
        strided_view<float, 2> const backward(memory.data() + 5, {2, 3}, {-3, -1});
        CHECK(xt::xtensor<float, 2>(to_xtensor(backward)) == xt::xtensor<float, 2>{{6, 5, 4}, {3, 2, 1}});
        strided_view<float, 2> const empty(nullptr, {0, 3});
        CHECK(to_xtensor(empty).size() == 0);
    }

    TEST_CASE("arrays and slices of any rank are views of as many axes") {
        xt::xarray<float> array = xt::arange<float>(24).reshape({2, 3, 4});
        auto const view = view_of<3>(array);
        CHECK(&view(1, 2, 3) == &array(1, 2, 3));
        CHECK_THROWS_WITH_AS(view_of<2>(array), doctest::Contains("number of axes"), value_error);
        auto slice = xt::view(array, 1, xt::range(1, 3), xt::range(0, 4, 2));
        auto const of_slice = view_of<2>(slice);
        CHECK(of_slice.extents() == std::array<std::size_t, 2>{2, 2});
        CHECK(&of_slice(1, 1) == &array(1, 2, 2));
        xt::xarray<float, xt::layout_type::column_major> const columns = array;
        CHECK(&view_of<3>(columns)(1, 0, 2) == &columns(1, 0, 2));
    }
}
