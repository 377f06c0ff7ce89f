// SPDX-License-Identifier: MIT
// [GR eq. 2] What an attention call is, and its projections by hand.
#include <genrender/attention/attention_call.hpp>
#include <genrender/injection/host_attention_call.hpp>

#include <doctest/doctest.h>

#include "support/matrix_module.hpp"

#include <array>
#include <optional>
#include <vector>

using namespace genrender;
using genrender::testing::matrix_module;

namespace {

struct handle {};
using least = attention_call_archetype<handle, float>;
static_assert(!shaped_features<handle>);
static_assert(shaped_features<host_features<float>>);

// Each hides one member of the least call behind something that cannot be called as the concept asks.
struct without_place : least {
    int place = 0;
};
struct without_frames : least {
    int frames = 0;
};
struct without_f : least {
    int f = 0;
};
struct without_query : least {
    int query = 0;
};
struct without_key : least {
    int key = 0;
};
struct without_value : least {
    int value = 0;
};
struct without_attend : least {
    int attend = 0;
};
struct without_mix : least {
    int mix = 0;
};
struct with_site_for_place : least {
    site_index place() const;
};
struct with_lists_of_one_frame : least {
    handle attend(handle const&, std::vector<key_value_block<handle>> const&) const;
};
struct only_moves {
    only_moves() = default;
    only_moves(only_moves&&) = default;
    only_moves& operator=(only_moves&&) = default;
};

struct without_projected_values {
    void query(strided_view<float, 2>, strided_view<float const, 2>) const {}
    void key(strided_view<float, 2>, strided_view<float const, 2>) const {}
    std::size_t heads() const { return 1; }
};

template <class Real>
host_features<Real> features(std::array<std::size_t, 3> const& extents, std::vector<Real> const& values) {
    auto const f = host_features<Real>::allocate(extents);
    for (std::size_t i = 0; i < values.size(); ++i) {
        f.view().data()[i] = values[i];
    }
    return f;
}

} // namespace

TEST_SUITE("attention/attention_call") {
    TEST_CASE("the least call is a call and a call without one member is none") {
        CHECK(attention_call<least>);
        CHECK(attention_call<attention_call_archetype<int, double>>);
        CHECK_FALSE(attention_call<without_place>);
        CHECK_FALSE(attention_call<without_frames>);
        CHECK_FALSE(attention_call<without_f>);
        CHECK_FALSE(attention_call<without_query>);
        CHECK_FALSE(attention_call<without_key>);
        CHECK_FALSE(attention_call<without_value>);
        CHECK_FALSE(attention_call<without_attend>);
        CHECK_FALSE(attention_call<without_mix>);
        CHECK_FALSE(attention_call<with_site_for_place>);
        CHECK_FALSE(attention_call<with_lists_of_one_frame>);
        CHECK_FALSE(attention_call<attention_call_archetype<only_moves, float>>);
        CHECK_FALSE(attention_call<attention_call_archetype<handle, int>>);
        CHECK_FALSE(attention_call<handle>);
    }

    TEST_CASE("the call over host memory is a call for projections of its own scalar") {
        CHECK(attention_call<host_attention_call<float, matrix_module<float>>>);
        CHECK(attention_call<host_attention_call<double, matrix_module<double>>>);
        CHECK(attention_projections<matrix_module<float>, float>);
        CHECK_FALSE(attention_projections<matrix_module<float>, double>);
        CHECK_FALSE(attention_projections<without_projected_values, float>);
    }

    TEST_CASE_TEMPLATE("[GR eq. 2] queries and keys and values are W f by hand", Real, float, double) {
        matrix_module<Real> module(2);
        // W_Q = (1 2; 0 1), W_K = (0 1; 1 0), W_V = (2 0; 1 -1).
        module.W_Q(0, 0) = 1;
        module.W_Q(0, 1) = 2;
        module.W_Q(1, 1) = 1;
        module.W_K(0, 1) = 1;
        module.W_K(1, 0) = 1;
        module.W_V(0, 0) = 2;
        module.W_V(1, 0) = 1;
        module.W_V(1, 1) = -1;
        std::array const frames{frame_index{5}, frame_index{2}};
        auto const f = features<Real>({2, 1, 2}, {3, 4, -1, 1});
        host_attention_call<Real, matrix_module<Real>> const call({{3}, 1}, frames, f, module);

        CHECK(call.place() == attention_place{{3}, 1});
        REQUIRE(call.frames().size() == 2);
        CHECK(call.frames()[0] == frame_index{5});
        CHECK(call.f().view().data() == f.view().data());

        auto const Q = call.query(call.f());
        auto const K = call.key(call.f());
        auto const V = call.value(call.f());
        CHECK(Q.view()(0, 0, 0) == 11);
        CHECK(Q.view()(0, 0, 1) == 4);
        CHECK(Q.view()(1, 0, 0) == 1);
        CHECK(Q.view()(1, 0, 1) == 1);
        CHECK(K.view()(0, 0, 0) == 4);
        CHECK(K.view()(0, 0, 1) == 3);
        CHECK(V.view()(0, 0, 0) == 6);
        CHECK(V.view()(0, 0, 1) == -1);
        CHECK(V.view()(1, 0, 0) == -2);
        CHECK(V.view()(1, 0, 1) == -2);
        CHECK(f.view()(0, 0, 0) == 3);
    }

    TEST_CASE("projections take stacks of any number of frames") {
        matrix_module<double> const module(4, 1, 1);
        std::array const frames{frame_index{0}};
        host_attention_call<double, matrix_module<double>> const call(
            {}, frames, host_features<double>::allocate({1, 3, 4}), module);
        CHECK(call.key(host_features<double>::allocate({5, 2, 4})).extents() == std::array<std::size_t, 3>{5, 2, 4});
        CHECK(module.keys == 5);
    }

    TEST_CASE("each frame of Q attends to its own list of blocks from any stack") {
        // One channel and one query: F is the mean of V where all logits are 0.
        matrix_module<double> const module(1);
        std::array const frames{frame_index{0}, frame_index{1}};
        host_attention_call<double, matrix_module<double>> const call({}, frames, features<double>({2, 1, 1}, {0, 0}),
                                                                      module);
        auto const K = features<double>({3, 2, 1}, {0, 0, 0, 0, 0, 0});
        auto const V = features<double>({3, 2, 1}, {1, 3, 10, 20, 100, 300});
        auto const other = features<double>({1, 1, 1}, {0});
        auto const far = features<double>({1, 1, 1}, {31});
        attention_sources<host_features<double>> const sources{{{&K, &V, 2}},
                                                               {{&K, &V, 1}, {&other, &far, 0}, {&K, &V, 0}}};
        auto const F = call.attend(call.query(call.f()), sources);
        CHECK(F.view()(0, 0, 0) == doctest::Approx(200));
        CHECK(F.view()(1, 0, 0) == doctest::Approx((10 + 20 + 31 + 1 + 3) / 5.0));
    }

    TEST_CASE("results outlive the call") {
        std::optional<host_features<double>> K;
        {
            matrix_module<double> module(1);
            module.W_K(0, 0) = 2;
            std::array const frames{frame_index{0}};
            host_attention_call<double, matrix_module<double>> const call({}, frames, features<double>({1, 1, 1}, {21}),
                                                                          module);
            K = call.key(call.f());
        }
        CHECK(K->view()(0, 0, 0) == 42);
        CHECK_FALSE(K->is_borrowed());
    }

    TEST_CASE("shapes that do not fit are refused with a sentence") {
        matrix_module<double> const module(4);
        using call_type = host_attention_call<double, matrix_module<double>>;
        std::array const frames{frame_index{0}};
        auto const two = host_features<double>::allocate({2, 3, 4});
        CHECK_THROWS_WITH_AS(call_type({}, frames, two, module),
                             "host_attention_call: f is [2, 3, 4], expected [1, 3, 4]", shape_error);
        auto const one = host_features<double>::allocate({1, 3, 4});
        call_type const call({}, frames, one, module);
        CHECK_THROWS_WITH_AS(call.attend(one, {}), "host_attention_call::attend: sources is [0], expected [1]",
                             shape_error);
        CHECK_THROWS_WITH_AS(call.mix(one, one, {}, 1), "host_attention_call::mix: rows is [0], expected [1]",
                             shape_error);
    }

    TEST_CASE("one and two threads give the same bits") {
        matrix_module<float> const module(8, 2, 7);
        std::vector<frame_index> const frames{{0}, {1}, {2}, {3}, {4}};
        auto noise = genrender::testing::random_stack<float, 3>({5, 9, 8}, 3);
        host_features<float> const f(noise.view());
        sequential_loop const one;
        threaded_loop const two(2);
        host_attention_call<float, matrix_module<float>> const a({}, frames, f, module, one);
        host_attention_call<float, matrix_module<float>> const b({}, frames, f, module, two);
        auto const own = [&](auto const& call) {
            auto const K = call.key(f);
            auto const V = call.value(f);
            attention_sources<host_features<float>> sources(5);
            for (std::size_t i = 0; i < 5; ++i) {
                sources[i] = {{&K, &V, i}, {&K, &V, 4 - i}};
            }
            return call.attend(call.query(f), sources);
        };
        auto const F_a = own(a);
        auto const F_b = own(b);
        bool same = true;
        for (std::size_t e = 0; e < noise.size(); ++e) {
            same = same && F_a.view().data()[e] == F_b.view().data()[e];
        }
        CHECK(same);
        // Without a loop the call brings its own.
        host_attention_call<float, matrix_module<float>> const c({}, frames, f, module);
        CHECK(own(c).view()(4, 8, 7) == F_a.view()(4, 8, 7));
    }
}
