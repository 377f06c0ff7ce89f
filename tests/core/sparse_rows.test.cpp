// SPDX-License-Identifier: MIT
// Rows of a sparse map: how many there are and which are covered.
#include <genrender/core/sparse_rows.hpp>

#include <doctest/doctest.h>

#include <vector>

using namespace genrender;

TEST_SUITE("core/sparse_rows") {
    TEST_CASE_TEMPLATE("rows are counted and covered by their offsets alone", Real, float, double) {
        std::vector<std::uint32_t> const offsets{0, 2, 2, 3, 3};
        std::vector<std::uint32_t> const sources{4, 0, 7};
        std::vector<Real> const weights{Real(0.25), Real(0.75), 0};
        sparse_rows<Real> const rows{offsets, sources, weights};
        CHECK(rows.row_count() == 4);
        CHECK(rows.is_covered(0));
        CHECK_FALSE(rows.is_covered(1));
        // A weight of 0 is an entry all the same: coverage is never read off a value.
        CHECK(rows.is_covered(2));
        CHECK_FALSE(rows.is_covered(3));
        // The formula of the comment, by hand: row 0 of the sources 0, 10, 20, ...
        Real result = 0;
        for (auto e = rows.offsets[0]; e < rows.offsets[1]; ++e) {
            result += rows.weights[e] * static_cast<Real>(10 * rows.sources[e]);
        }
        CHECK(result == 10);
    }

    TEST_CASE("no offsets and one offset both mean no rows") {
        CHECK(sparse_rows<float>{}.row_count() == 0);
        std::vector<std::uint32_t> const zero{0};
        CHECK(sparse_rows<float>{zero, {}, {}}.row_count() == 0);
    }
}
