// SPDX-License-Identifier: MIT
// [GR eq. 3] Every frame attends to all frames, as if their features stood in one long row.
#include <genrender/attention/extended_attention.hpp>
#include <genrender/attention/plain_attention.hpp>
#include <genrender/injection/host_attention_call.hpp>

#include <doctest/doctest.h>

#include "support/matrix_module.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

using namespace genrender;
using genrender::testing::matrix_module;
using genrender::testing::random_stack;

namespace {

template <class Real>
using call_of = host_attention_call<Real, matrix_module<Real>>;

template <class Real>
host_features<Real> extended(matrix_module<Real> const& module, stack<Real, 3>& f) {
    std::vector<frame_index> const frames(f.extent(0));
    call_of<Real> const call({}, frames, host_features<Real>(f.view()), module);
    auto const K = call.key(call.f());
    auto const V = call.value(call.f());
    return call.attend(call.query(call.f()), extended_attention_sources(K, V, frames.size()));
}

template <class Real>
double largest_difference(strided_view<Real const, 2> a, strided_view<Real const, 2> b) {
    double largest = 0;
    for (std::size_t t = 0; t < a.extent(0); ++t) {
        for (std::size_t c = 0; c < a.extent(1); ++c) {
            largest = std::max(largest, std::abs(static_cast<double>(a(t, c)) - static_cast<double>(b(t, c))));
        }
    }
    return largest;
}

} // namespace

TEST_SUITE("attention/extended_attention") {
    TEST_CASE("[GR eq. 3] every frame's sources are all frames in their order") {
        int const K = 0;
        int const V = 0;
        auto const sources = extended_attention_sources(K, V, 3);
        REQUIRE(sources.size() == 3);
        for (auto const& list : sources) {
            REQUIRE(list.size() == 3);
            for (std::size_t j = 0; j < 3; ++j) {
                CHECK(list[j].K == &K);
                CHECK(list[j].V == &V);
                CHECK(list[j].frame == j);
            }
        }
        CHECK(extended_attention_sources(K, V, 0).empty());
    }

    TEST_CASE_TEMPLATE("[GR eq. 3] it equals attention over W [f^1 ... f^N] joined in memory", Real, float, double) {
        constexpr std::size_t n = 3;
        constexpr std::size_t tokens = 11;
        constexpr std::size_t channels = 6;
        matrix_module<Real> const module(channels, 2, 21);
        auto f = random_stack<Real, 3>({n, tokens, channels}, 8);
        auto const F = extended(module, f);

        // The stack is contiguous, so one frame of n * tokens tokens is the joined row.
        stack<Real, 2> Q({n * tokens, channels});
        stack<Real, 2> K({n * tokens, channels});
        stack<Real, 2> V({n * tokens, channels});
        strided_view<Real const, 2> const joined(f.data(), {n * tokens, channels});
        module.query(Q.view(), joined);
        module.key(K.view(), joined);
        module.value(V.view(), joined);
        stack<Real, 2> expected({n * tokens, channels});
        std::vector<key_value_view<Real>> const one_block{{K.view(), V.view()}};
        scaled_dot_product(expected.view(), Q, one_block, 2);

        auto const F_joined = strided_view<Real const, 2>(F.view().data(), {n * tokens, channels});
        CHECK(largest_difference<Real>(F_joined, expected.view()) < (sizeof(Real) == 4 ? 2e-6 : 1e-14));
    }

    TEST_CASE_TEMPLATE("[GR eq. 3] of one frame it is plain attention to the bit", Real, float, double) {
        matrix_module<Real> const module(8, 2, 3);
        auto f = random_stack<Real, 3>({1, 70, 8}, 5);
        auto const F = extended(module, f);
        std::vector<frame_index> const frames(1);
        call_of<Real> call({}, frames, host_features<Real>(f.view()), module);
        auto const plain = plain_attention{}(call);
        CHECK(std::equal(F.view().data(), F.view().data() + f.size(), plain.view().data()));
    }

    TEST_CASE("[GR eq. 3] of copies of one frame it is plain attention but for rounding") {
        matrix_module<double> const module(4, 1, 3);
        auto f = random_stack<double, 3>({4, 9, 4}, 5);
        for (std::size_t i = 1; i < 4; ++i) {
            copy(f.view()[i], f.view()[0]);
        }
        auto const F = extended(module, f);
        std::vector<frame_index> const frames(4);
        call_of<double> call({}, frames, host_features<double>(f.view()), module);
        auto const plain = plain_attention{}(call);
        for (std::size_t i = 0; i < 4; ++i) {
            CHECK(largest_difference<double>(F.view()[i], plain.view()[i]) < 1e-14);
        }
    }

    TEST_CASE("[GR eq. 3] the order of frames permutes the result and nothing else") {
        matrix_module<double> const module(4, 2, 3);
        auto f = random_stack<double, 3>({3, 5, 4}, 6);
        stack<double, 3> turned({3, 5, 4});
        for (std::size_t i = 0; i < 3; ++i) {
            copy(turned.view()[i], f.view()[2 - i]);
        }
        auto const F = extended(module, f);
        auto const F_turned = extended(module, turned);
        for (std::size_t i = 0; i < 3; ++i) {
            CHECK(largest_difference<double>(F.view()[i], F_turned.view()[2 - i]) < 1e-14);
        }
    }
}
