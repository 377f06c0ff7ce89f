// SPDX-License-Identifier: MIT
// [GR eq. 1, 2, 6] The call of engines in host memory: reads features where they lie, writes memory of its own.
#include <genrender/injection/host_attention_call.hpp>

#include <genrender/attention/attention_processor.hpp>
#include <genrender/attention/plain_attention.hpp>

#include "dense_equations.hpp"

#include <doctest/doctest.h>

#include <array>
#include <vector>

using namespace genrender;
using namespace genrender::testing;

TEST_SUITE("injection/host_attention_call") {
    namespace {

    constexpr std::size_t tokens = 9;
    constexpr std::size_t channels = 6;
    std::vector<frame_index> const frames{{4}, {0}, {7}};

    template <class Real>
    using call_of = host_attention_call<Real, matrix_module<Real>>;

    struct without_heads {
        void query(strided_view<float, 2>, strided_view<float const, 2>) const {}
        void key(strided_view<float, 2>, strided_view<float const, 2>) const {}
        void value(strided_view<float, 2>, strided_view<float const, 2>) const {}
    };

    } // namespace

    TEST_CASE("it is an attention call for modules with three projections and a number of heads") {
        CHECK(attention_call<call_of<float>>);
        CHECK(attention_call<host_attention_call<double, matrix_module<double>>>);
        CHECK(attention_projections<matrix_module<float>, float>);
        CHECK_FALSE(attention_projections<matrix_module<float>, double>);
        CHECK_FALSE(attention_projections<without_heads, float>);
        CHECK(attention_processor<plain_attention, call_of<float>>);
    }

    TEST_CASE("it says what it was made for and hands out the engine's own f") {
        matrix_module<double> const module(channels, 1, 1);
        auto engine = random_stack<double, 3>({3, tokens, channels}, 2);
        call_of<double> const call({{5}, 1}, frames, host_features<double>(engine.view()), module);
        CHECK(call.place() == attention_place{{5}, 1});
        CHECK(call.frames().data() == frames.data());
        CHECK(call.f().view().data() == engine.data());
        CHECK(call.f().is_borrowed());
    }

    TEST_CASE_TEMPLATE("[GR eq. 2] projections of every frame are W f in new memory", Real, float, double) {
        matrix_module<Real> const module(channels, 1, 1);
        auto const f = random_features<Real>({3, tokens, channels}, 2);
        auto const other = random_features<Real>({2, 4, channels}, 3);
        call_of<Real> const call({}, frames, f, module);
        auto const Q = call.query(f);
        auto const K = call.key(f);
        auto const V = call.value(other); // any stack may be projected, as f_KF is
        CHECK_FALSE(Q.is_borrowed());
        CHECK(V.extents() == other.extents());
        for (std::size_t i = 0; i < 3; ++i) {
            CHECK(greatest_difference(Q, i, dense_product(module.W_Q, joined_rows(f, {i}))) < 1e-5);
            CHECK(greatest_difference(K, i, dense_product(module.W_K, joined_rows(f, {i}))) < 1e-5);
        }
        CHECK(greatest_difference(V, 1, dense_product(module.W_V, joined_rows(other, {1}))) < 1e-5);
    }

    TEST_CASE("[GR eq. 1] each frame attends to its own list of blocks") {
        matrix_module<double> const module(channels, 3, 1);
        auto const f = random_features<double>({3, tokens, channels}, 2);
        call_of<double> const call({}, frames, f, module);
        auto const Q = call.query(f);
        auto const K = call.key(f);
        auto const V = call.value(f);
        auto const F = call.attend(Q, {{{&K, &V, 0}}, {{&K, &V, 2}, {&K, &V, 0}}, {{&K, &V, 1}, {&K, &V, 1}}});
        std::vector<std::vector<std::size_t>> const joined{{0}, {0, 2}, {1}};
        for (std::size_t i = 0; i < 3; ++i) {
            auto const expected = dense_self_attention(module, joined_rows(f, {i}), joined_rows(f, joined[i]));
            CHECK(greatest_difference(F, i, expected) < 1e-13);
        }
    }

    TEST_CASE("[GR eq. 6] mix gives F_hat itself with covered rows replaced") {
        matrix_module<double> const module(channels, 1, 1);
        auto const f = random_features<double>({3, tokens, channels}, 2);
        auto const F_hat = random_features<double>({3, tokens, channels}, 3);
        auto const F_KF = random_features<double>({2, tokens, channels}, 4);
        std::vector<random_plan<double>> const plans{{tokens, 2, 5}, {tokens, 2, 6}, {tokens, 2, 7}};
        std::vector<sparse_rows<double>> const rows{plans[0].rows(), plans[1].rows(), plans[2].rows()};
        call_of<double> const call({}, frames, f, module);
        std::vector<token_rows> expected;
        for (std::size_t i = 0; i < 3; ++i) {
            expected.push_back(dense_mix(joined_rows(F_hat, {i}), joined_rows(F_KF, {0, 1}), rows[i], 0.7));
        }
        auto const F = call.mix(F_hat, F_KF, rows, 0.7);
        CHECK(F.view().data() == F_hat.view().data());
        for (std::size_t i = 0; i < 3; ++i) {
            CHECK(greatest_difference(F, i, expected[i]) < 1e-13);
        }
    }

    TEST_CASE("features of any strides give the same and are not changed") {
        matrix_module<double> const module(channels, 2, 1);
        auto const f = random_features<double>({3, tokens, channels}, 2);
        stack<double, 3> channel_major({3, channels, tokens});
        strided_view<double, 3> const strided(channel_major.data(), {3, tokens, channels},
                                              {static_cast<std::ptrdiff_t>(tokens * channels), 1, tokens});
        copy<double, 3>(strided, f);
        auto const before = channel_major;
        call_of<double> call({}, frames, f, module);
        call_of<double> strided_call({}, frames, host_features<double>(strided), module);
        CHECK(equal_bits(plain_attention{}(call), plain_attention{}(strided_call)));
        for (std::size_t e = 0; e < before.size(); ++e) {
            REQUIRE(channel_major.data()[e] == before.data()[e]);
        }
    }

    TEST_CASE("frames run through the loop with the same bits") {
        matrix_module<double> const module(channels, 2, 1);
        auto const f = random_features<double>({3, tokens, channels}, 2);
        threaded_loop const loop(3);
        call_of<double> call({}, frames, f, module);
        host_attention_call<double, matrix_module<double>> threaded({}, frames, f, module, loop);
        CHECK(equal_bits(plain_attention{}(call), plain_attention{}(threaded)));
    }

    TEST_CASE("results live as long as their handles and longer than the call") {
        matrix_module<double> const module(channels, 1, 1);
        host_features<double> F;
        host_features<double> expected;
        {
            auto const f = random_features<double>({3, tokens, channels}, 2);
            call_of<double> call({}, frames, f, module);
            F = plain_attention{}(call);
            expected = plain_attention{}(call);
        }
        CHECK(equal_bits(F, expected));
    }

    TEST_CASE("stacks that do not fit the frames are refused in a sentence") {
        matrix_module<double> const module(channels, 1, 1);
        auto const f = random_features<double>({3, tokens, channels}, 2);
        std::vector<frame_index> const two(2);
        CHECK_THROWS_WITH_AS(call_of<double>({}, two, f, module),
                             "host_attention_call: f is [3, 9, 6], expected [2, 9, 6]", shape_error);
        call_of<double> const call({}, frames, f, module);
        CHECK_THROWS_WITH_AS(call.attend(f, {{{&f, &f, 0}}}),
                             "host_attention_call::attend: sources is [1], expected [3]", shape_error);
        std::vector<sparse_rows<double>> const rows(2);
        CHECK_THROWS_WITH_AS(call.mix(f, f, rows, 0.5), "host_attention_call::mix: rows is [2], expected [3]",
                             shape_error);
        CHECK_THROWS_WITH_AS(call.attend(f, {{{&f, &f, 0}}, {}, {{&f, &f, 0}}}),
                             "scaled_dot_product: blocks is empty, expected at least one key", value_error);
    }

    TEST_CASE("keys and values kept in 16 bits are attended to beside those that are not") {
        matrix_module<double> const module(channels, 2, 1);
        auto const f = random_features<double>({3, tokens, channels}, 2);
        call_of<double> const call({}, frames, f, module);
        auto const Q = call.query(f);
        auto const K = call.key(f);
        auto const V = call.value(f);
        for (auto const storage : {feature_storage::f16, feature_storage::bf16}) {
            auto const K_kept = call.stored(K, storage);
            auto const V_kept = call.stored(V, storage);
            auto const widened = [](host_features<double> const& kept) {
                auto const wide = host_features<double>::allocate(kept.extents());
                kept.visit([&](auto const& view) {
                    for (std::size_t e = 0; e < view.size(); ++e) {
                        wide.view().data()[e] = static_cast<double>(view.data()[e]);
                    }
                });
                return wide;
            };
            auto const K_wide = widened(K_kept);
            auto const V_wide = widened(V_kept);
            auto const mixed = call.attend(Q, {{{&K, &V, 0}, {&K_kept, &V_kept, 1}},
                                               {{&K_kept, &V_kept, 2}},
                                               {{&K, &V, 2}, {&K_kept, &V_kept, 0}, {&K_kept, &V_kept, 1}}});
            auto const wide = call.attend(Q, {{{&K, &V, 0}, {&K_wide, &V_wide, 1}},
                                              {{&K_wide, &V_wide, 2}},
                                              {{&K, &V, 2}, {&K_wide, &V_wide, 0}, {&K_wide, &V_wide, 1}}});
            for (std::size_t e = 0; e < mixed.view().size(); ++e) {
                REQUIRE(mixed.view().data()[e] == doctest::Approx(wide.view().data()[e]).epsilon(1e-12));
            }
        }
        CHECK(call.stored(K, feature_storage::same).view().data() == K.view().data());
    }
}
