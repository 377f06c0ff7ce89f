// SPDX-License-Identifier: MIT
// Views and Eigen's maps, blocks and tensors show the same elements.
#include <genrender/adapters/eigen.hpp>

#include <doctest/doctest.h>

#include <unsupported/Eigen/CXX11/Tensor>

#include <cstddef>
#include <numeric>
#include <type_traits>
#include <vector>

using namespace genrender;

TEST_SUITE("adapters/eigen") {
    using adapters::to_eigen;
    using adapters::to_eigen_tensor;

    namespace {

    std::vector<float> counted(std::size_t count) {
        std::vector<float> numbers(count);
        std::iota(numbers.begin(), numbers.end(), 0.0f);
        return numbers;
    }

    } // namespace

    TEST_CASE("a matrix of a view has its elements, whatever the strides, and writes to them") {
        auto memory = counted(40);
        strided_view<float, 2> const view(memory.data() + 1, {3, 4}, {2, 7});
        auto matrix = to_eigen(view);
        for (std::size_t i = 0; i < 3; ++i) {
            for (std::size_t j = 0; j < 4; ++j) {
                CHECK(&matrix(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) == &view(i, j));
            }
        }
        matrix *= 2.0f;
        CHECK(view(2, 3) == 2 * (1 + 2 * 2 + 3 * 7));
        strided_view<float const, 2> const constant = view;
        CHECK(to_eigen(constant).sum() == matrix.sum());
        strided_view<float, 2> const backward(memory.data() + 30, {3, 4}, {-4, 1});
        CHECK_THROWS_WITH_AS(to_eigen(backward), doctest::Contains("view.stride"), value_error);
    }

    TEST_CASE("a vector of a view has its elements") {
        auto memory = counted(12);
        strided_view<float, 1> const view(memory.data() + 2, {4}, {3});
        auto vector = to_eigen(view);
        CHECK(vector.sum() == 2 + 5 + 8 + 11);
        vector[3] = -1;
        CHECK(memory[11] == -1);
        strided_view<float, 1> const backward(memory.data() + 2, {2}, {-1});
        CHECK_THROWS_AS(to_eigen(backward), value_error);
    }

    TEST_CASE("maps, blocks and arrays are views where views are asked for") {
        auto memory = counted(40);
        Eigen::MatrixXf matrix = Eigen::Map<Eigen::MatrixXf>(memory.data(), 5, 8);
        auto block = matrix.block(1, 2, 3, 4);
        strided_view<float, 2> const of_block = block;
        CHECK(of_block.extents() == std::array<std::size_t, 2>{3, 4});
        CHECK(&of_block(2, 3) == &matrix(3, 5));
        auto const map = to_eigen(of_block);
        strided_view<float const, 2> const of_map = map;
        CHECK(of_map.strides() == of_block.strides());
        Eigen::ArrayXXf const array = matrix.array();
        static_assert(std::is_same_v<decltype(to_view(array)), strided_view<float const, 2>>);
        CHECK(to_view(array)(4, 7) == 39);
        static_assert(!std::is_convertible_v<decltype(matrix + matrix), strided_view<float const, 2>>);
    }

    TEST_CASE("tensors of either storage order are views, and contiguous views are tensors") {
        Eigen::Tensor<float, 3> columns_first(2, 3, 4);
        Eigen::Tensor<float, 3, Eigen::RowMajor> const rows_first(2, 3, 4);
        strided_view<float, 3> const a = columns_first;
        strided_view<float const, 3> const b = rows_first;
        CHECK(&a(1, 2, 3) == &columns_first(1, 2, 3));
        CHECK(&a(0, 2, 1) == &columns_first(0, 2, 1));
        CHECK(&b(1, 2, 3) == &rows_first(1, 2, 3));
        CHECK(&b(1, 0, 2) == &rows_first(1, 0, 2));

        auto memory = counted(24);
        strided_view<float, 3> const view(memory.data(), {2, 3, 4});
        using map = Eigen::TensorMap<Eigen::Tensor<float, 3, Eigen::RowMajor>>;
        auto tensor = to_eigen_tensor<map>(view);
        CHECK(&tensor(1, 2, 0) == &view(1, 2, 0));
        strided_view<float, 3> const again = tensor;
        CHECK(again.strides() == view.strides());
        strided_view<float, 3> const gaps(memory.data(), {2, 2, 4}, {12, 4, 1});
        CHECK_THROWS_WITH_AS(to_eigen_tensor<map>(gaps), doctest::Contains("contiguous rows"), value_error);
    }
}
