// SPDX-License-Identifier: MIT
// [GR eq. 2] Every frame attends to itself and to nothing else.
#include <genrender/attention/plain_attention.hpp>
#include <genrender/injection/host_attention_call.hpp>

#include <doctest/doctest.h>

#include "support/matrix_module.hpp"

#include <vector>

using namespace genrender;
using genrender::testing::matrix_module;
using genrender::testing::random_stack;

namespace {

template <class Real>
host_features<Real> plain(matrix_module<Real> const& module, stack<Real, 3>& f) {
    std::vector<frame_index> frames(f.extent(0));
    host_attention_call<Real, matrix_module<Real>> call({}, frames, host_features<Real>(f.view()), module);
    return plain_attention{}(call);
}

} // namespace

TEST_SUITE("attention/plain_attention") {
    TEST_CASE("sources name each frame once and point to K and V") {
        int const K = 0;
        int const V = 0;
        auto const sources = own_attention_sources(K, V, 3);
        REQUIRE(sources.size() == 3);
        for (std::size_t i = 0; i < 3; ++i) {
            REQUIRE(sources[i].size() == 1);
            CHECK(sources[i][0].K == &K);
            CHECK(sources[i][0].V == &V);
            CHECK(sources[i][0].frame == i);
        }
        CHECK(own_attention_sources(K, V, 0).empty());
    }

    TEST_CASE("[GR eq. 2] queries and keys and values come from the features of the frame itself by hand") {
        // W_Q = ln 3, W_K = 1, W_V = 4: token f = 1 weighs its keys 1 and 0 by 3 : 1, token f = 0 by 1 : 1.
        matrix_module<double> module(1);
        module.W_Q(0, 0) = std::log(3.0);
        module.W_K(0, 0) = 1;
        module.W_V(0, 0) = 4;
        stack<double, 3> f({1, 2, 1});
        f(0, 0, 0) = 1;
        auto const F = plain(module, f);
        CHECK(F.view()(0, 0, 0) == doctest::Approx(3));
        CHECK(F.view()(0, 1, 0) == doctest::Approx(2));
    }

    TEST_CASE_TEMPLATE("a frame of a stack comes out as if it were alone to the bit", Real, float, double) {
        matrix_module<Real> const module(6, 3, 5);
        auto f = random_stack<Real, 3>({3, 7, 6}, 2);
        auto const together = plain(module, f);
        for (std::size_t i = 0; i < 3; ++i) {
            stack<Real, 3> alone({1, 7, 6});
            copy(alone.view()[0], f.view()[i]);
            auto const F = plain(module, alone);
            bool same = true;
            for (std::size_t t = 0; t < 7; ++t) {
                for (std::size_t c = 0; c < 6; ++c) {
                    same = same && F.view()(0, t, c) == together.view()(i, t, c);
                }
            }
            CHECK(same);
        }
    }

    TEST_CASE("every frame is projected once and f is left alone") {
        matrix_module<double> const module(4, 2, 9);
        auto f = random_stack<double, 3>({3, 5, 4}, 4);
        auto const before = f;
        auto const F = plain(module, f);
        CHECK(module.queries == 3);
        CHECK(module.keys == 3);
        CHECK(module.values == 3);
        CHECK(std::equal(before.data(), before.data() + before.size(), f.data()));
        CHECK(F.extents() == f.extents());
    }
}
