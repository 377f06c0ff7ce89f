// SPDX-License-Identifier: MIT
// What keys of one surface point count for, by hand, and what that does to attention.
#include <genrender/blending/point_counts.hpp>

#include <genrender/attention/scaled_dot_product.hpp>
#include <genrender/core/stack.hpp>
#include <genrender/testing/random_stack.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

using namespace genrender;

TEST_SUITE("blending/point_counts") {
    TEST_CASE("by hand: a point shown by the frame and two keyframes counts a third with each key") {
        // Three tokens, two keyframes: token 0 is shown by token 1 of both, token 1 by token 2 of keyframe 1, token 2 by none.
        std::vector<std::uint32_t> const offsets{0, 2, 3, 3};
        std::vector<std::uint32_t> const sources{1, 4, 5};
        std::vector<float> const weights(3, 0.5F);
        sparse_rows<float> const rows{offsets, sources, weights};
        auto const third = 1 / 3.0F;
        CHECK(point_counts(rows, 2) == std::vector<float>{third, 0.5F, 1, 1, third, 1, 1, third, 0.5F});
        CHECK(point_counts_of_stack(rows, 2) == std::vector<float>{1, 0.5F, 1, 1, 0.5F, 1});
    }
    TEST_CASE("a key of several own tokens has the count of the point that is shown most") {
        std::vector<std::uint32_t> const offsets{0, 1, 3};
        std::vector<std::uint32_t> const sources{0, 0, 2};
        std::vector<float> const weights{1, 0.5F, 0.5F};
        sparse_rows<float> const rows{offsets, sources, weights};
        CHECK(point_counts(rows, 2) == std::vector<float>{0.5F, 1 / 3.0F, 1 / 3.0F, 1, 1 / 3.0F, 1});
    }
    TEST_CASE("keys of one point weigh together like one key with the mean of their values") {
        // Own tokens 0 and 1; a keyframe shows the point of token 0 again, with the same key and another value.
        auto const Q = testing::random_stack<double, 2>({3, 4}, 1);
        auto K = testing::random_stack<double, 2>({4, 4}, 2);
        auto const V = testing::random_stack<double, 2>({4, 4}, 3);
        for (std::size_t c = 0; c < 4; ++c) {
            K(2, c) = K(0, c);
        }
        std::vector<std::uint32_t> const offsets{0, 1, 1};
        std::vector<std::uint32_t> const sources{0};
        std::vector<double> const weights{1};
        auto const counts = point_counts(sparse_rows<double>{offsets, sources, weights}, 1);
        std::vector<double> const as_double(counts.begin(), counts.end());
        stack<double, 2> F({3, 4});
        key_value_view<double> block{K, V, strided_view<double const, 1>(as_double.data(), {4})};
        scaled_dot_product(F.view(), Q, std::vector{block}, 1);
        // Token 0 once, with the mean of both values.
        stack<double, 2> K_once({3, 4});
        stack<double, 2> V_once({3, 4});
        for (std::size_t c = 0; c < 4; ++c) {
            for (std::size_t t = 0; t < 3; ++t) {
                K_once(t, c) = K(t < 2 ? t : 3, c);
                V_once(t, c) = V(t < 2 ? t : 3, c);
            }
            V_once(0, c) = (V(0, c) + V(2, c)) / 2;
        }
        stack<double, 2> once({3, 4});
        scaled_dot_product(once.view(), Q, std::vector{key_value_view<double>{K_once, V_once}}, 1);
        for (std::size_t e = 0; e < F.size(); ++e) {
            CHECK(F.data()[e] == doctest::Approx(once.data()[e]).epsilon(1e-12));
        }
    }
}
