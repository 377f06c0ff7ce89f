// SPDX-License-Identifier: MIT
// Tests of maps within a ring of zeros.
#include <genrender/reference/padded_map.hpp>

#include "small_networks.hpp"

#include <doctest/doctest.h>

using namespace genrender;

using namespace genrender::reference;
using namespace genrender::testing;

TEST_SUITE("reference/padded_map") {
    TEST_CASE_TEMPLATE("around the features are zeros and nothing else", Real, float, double) {
        for (auto const grid : {grid_extents{3, 4}, grid_extents{1, 1}, grid_extents{5, 2}}) {
            auto const in = random_stack<Real, 2>({grid.size(), 3}, 1);
            padded_map<Real> const map(in, grid);
            CHECK(map.row_stride() == (grid.width + 2) * 3);
            CHECK(map.row(0) == map.corner() + map.row_stride() + 3);
            for (std::size_t y = 0; y < grid.height + 2; ++y) {
                for (std::size_t x = 0; x < grid.width + 2; ++x) {
                    auto const is_inside = y >= 1 && y <= grid.height && x >= 1 && x <= grid.width;
                    for (std::size_t c = 0; c < 3; ++c) {
                        auto const expected = is_inside ? in((y - 1) * grid.width + x - 1, c) : Real{0};
                        CHECK(map.corner()[y * map.row_stride() + x * 3 + c] == expected);
                    }
                }
            }
        }
    }

    TEST_CASE("features of another grid are refused") {
        stack<float, 2> const in({6, 2});
        CHECK_THROWS_WITH_AS((padded_map<float>(in, {2, 4})), "padded_map: in is [6, 2], expected [8, 2]", shape_error);
    }
}
