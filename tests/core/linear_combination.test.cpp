// SPDX-License-Identifier: MIT
// Every element of every layout is combined once.
#include <genrender/core/linear_combination.hpp>

#include <genrender/core/stack.hpp>

#include "support/each_vector_target.hpp"
#include <genrender/testing/random_stack.hpp>

#include <doctest/doctest.h>

#include <array>
#include <cstddef>
#include <utility>
#include <vector>

using namespace genrender;

TEST_SUITE("core/linear_combination") {
    TEST_CASE_TEMPLATE("every length gives what one element at a time gives", Real, float, double) {
        testing::at_each_vector_target([] {
            for (std::size_t count = 0; count < 70; ++count) {
                std::vector<Real> a(count + 1);
                std::vector<Real> b(count + 1);
                for (std::size_t e = 0; e <= count; ++e) {
                    a[e] = static_cast<Real>(e) - Real(10);
                    b[e] = static_cast<Real>(e * e);
                }
                std::vector<Real> out(count + 1, Real(-1));
                // Halves and wholes: exact however it is computed.
                linear_combination<Real, 2>(out.data(), count, {Real(0.5), Real(1)}, {a.data(), b.data()});
                for (std::size_t e = 0; e < count; ++e) {
                    CHECK(out[e] == Real(0.5) * a[e] + b[e]);
                }
                CHECK(out[count] == Real(-1));
            }
        });
    }

    TEST_CASE_TEMPLATE("any strides give the same and an input may be the output", Real, float, double) {
        testing::at_each_vector_target([] {
            auto const a = testing::random_stack<Real, 3>({3, 5, 7}, 1);
            std::array const twice{Real(1), Real(1)};
            stack<Real, 3> plain({3, 5, 7});
            linear_combination<Real, 3, 2>(plain.view(), twice, {a.view(), a.view()});
            stack<Real, 3> storage({7, 5, 3});
            strided_view<Real, 3> const backwards(storage.data(), {3, 5, 7}, {1, 3, 15});
            copy(backwards, in_view<Real, 3>(a));
            linear_combination<Real, 3, 2>(backwards, twice, {backwards, a.view()});
            // Rows that are blocks in a stack that is not.
            stack<Real, 3> wide({3, 5, 9});
            strided_view<Real, 3> const left(wide.data(), {3, 5, 7}, {45, 9, 1});
            linear_combination<Real, 3, 2>(left, twice, {a.view(), a.view()});
            for (std::size_t i = 0; i < 3; ++i) {
                for (std::size_t j = 0; j < 5; ++j) {
                    for (std::size_t k = 0; k < 7; ++k) {
                        CHECK(plain(i, j, k) == 2 * a(i, j, k));
                        CHECK(backwards(i, j, k) == plain(i, j, k));
                        CHECK(left(i, j, k) == plain(i, j, k));
                    }
                    CHECK(wide(i, j, std::size_t{7}) == 0);
                }
            }
        });
    }
}
