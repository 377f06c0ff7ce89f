// SPDX-License-Identifier: MIT
// Eigen's matrices as views, and views as Eigen's maps.
#include <genrender/core/linalg.hpp>

#include <doctest/doctest.h>

#include <array>
#include <numeric>
#include <type_traits>
#include <vector>

using namespace genrender;

TEST_SUITE("core/linalg") {
    TEST_CASE_TEMPLATE("views of both storage orders read the same matrix", Real, float, double) {
        Eigen::Matrix<Real, 2, 3, Eigen::RowMajor> by_rows;
        by_rows << 0, 1, 2, 3, 4, 5;
        Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor> by_columns = by_rows;
        strided_view<Real, 2> const rows = by_rows;
        strided_view<Real, 2> const columns = by_columns;
        CHECK(rows.strides() == std::array<std::ptrdiff_t, 2>{3, 1});
        CHECK(columns.strides() == std::array<std::ptrdiff_t, 2>{1, 2});
        for (int i = 0; i < 2; ++i) {
            for (int j = 0; j < 3; ++j) {
                CHECK(rows(i, j) == by_rows(i, j));
                CHECK(columns(i, j) == by_rows(i, j));
            }
        }
        columns(1, 2) = -1;
        CHECK(by_columns(1, 2) == -1);
    }

    TEST_CASE("constant matrices give constant views and vectors are matrices of one column") {
        using owner = matrix<float>;
        CHECK(std::is_convertible_v<owner const&, strided_view<float const, 2>>);
        CHECK_FALSE(std::is_constructible_v<strided_view<float, 2>, owner const&>);
        CHECK_FALSE(std::is_constructible_v<strided_view<double const, 2>, owner const&>);
        Eigen::VectorXd vector(3);
        vector << 7, 8, 9;
        strided_view<double const, 2> const view = vector;
        CHECK(view.extents() == std::array<std::size_t, 2>{3, 1});
        CHECK(view(2, 0) == 9);
    }

    TEST_CASE_TEMPLATE("maps multiply memory that stays where it is", Real, float, double) {
        std::vector<Real> values(12);
        std::iota(values.begin(), values.end(), Real{0});
        // Two columns of a block of four: rows are 4 apart.
        strided_view<Real, 2> const part(values.data() + 1, {3, 2}, {4, 1});
        auto map = to_matrix(part);
        CHECK(map.rows() == 3);
        CHECK(map.cols() == 2);
        CHECK(map(2, 1) == 10);
        matrix<Real> const gram = map.transpose() * map;
        CHECK(gram(0, 0) == 1 + 25 + 81);
        CHECK(gram(0, 1) == 2 + 30 + 90);
        map.setZero();
        CHECK(values == std::vector<Real>{0, 0, 0, 3, 4, 0, 0, 7, 8, 0, 0, 11});
    }

    TEST_CASE("maps of views with a repeated row or rows from the last to the first") {
        std::vector<double> const values{1, 2, 3, 4};
        auto const repeated = to_matrix(strided_view<double const, 2>(values.data(), {3, 2}, {0, 1}));
        CHECK(repeated(2, 1) == 2);
        CHECK(repeated.sum() == 9);
        matrix<double> const ones = matrix<double>::Ones(1, 3);
        matrix<double> const product = ones * repeated;
        CHECK(product(0, 0) == 3);
        CHECK(product(0, 1) == 6);
        auto const upside_down = to_matrix(strided_view<double const, 2>(values.data() + 2, {2, 2}, {-2, 1}));
        CHECK(upside_down(0, 0) == 3);
        CHECK(upside_down(1, 1) == 2);
        matrix<double> const turned = upside_down * matrix<double>::Identity(2, 2);
        CHECK(turned(1, 0) == 1);
    }

    TEST_CASE("a single column may have any stride within its rows") {
        std::vector<double> const values{1, 2, 3, 4};
        auto const column = to_matrix(strided_view<double const, 2>(values.data(), {2, 1}, {2, 17}));
        CHECK(column(0, 0) == 1);
        CHECK(column(1, 0) == 3);
    }

    TEST_CASE("a map of a constant view cannot be written") {
        std::vector<double> values(4);
        auto const read_only = to_matrix(strided_view<double const, 2>(values.data(), {2, 2}));
        CHECK(std::is_same_v<decltype(read_only.data()), double const*>);
        auto writable = to_matrix(strided_view<double, 2>(values.data(), {2, 2}));
        CHECK(std::is_same_v<decltype(writable.data()), double*>);
    }
}
