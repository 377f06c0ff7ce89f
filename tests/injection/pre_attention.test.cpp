// SPDX-License-Identifier: MIT
// [GR eq. 5] A frame attends to its own tokens and the keyframes', as if all stood in one row.
#include <genrender/injection/pre_attention.hpp>

#include <genrender/attention/extended_attention.hpp>
#include <genrender/attention/plain_attention.hpp>
#include <genrender/injection/host_attention_call.hpp>

#include "dense_equations.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <vector>

using namespace genrender;
using namespace genrender::testing;

namespace {

template <class Real>
using call_of = host_attention_call<Real, matrix_module<Real>>;

/// F_hat of all frames of f with the keyframes f_KF.
template <class Real>
host_features<Real> pre_attended(matrix_module<Real> const& module, host_features<Real> const& f,
                                 host_features<Real> const& f_KF, std::optional<std::size_t> left_out = std::nullopt) {
    std::vector<frame_index> const frames(f.extents()[0]);
    call_of<Real> const call({}, frames, f, module);
    auto const K = call.key(f);
    auto const V = call.value(f);
    auto const K_KF = call.key(f_KF);
    auto const V_KF = call.value(f_KF);
    attention_sources<host_features<Real>> sources;
    for (std::size_t i = 0; i < frames.size(); ++i) {
        sources.push_back(pre_attention_sources(K, V, i, K_KF, V_KF, f_KF.extents()[0], left_out));
    }
    return call.attend(call.query(f), sources);
}

} // namespace

TEST_SUITE("injection/pre_attention") {
    TEST_CASE("[GR eq. 5] the sources are the frame's own tokens and then all keyframes in their order") {
        int const K = 0;
        int const V = 0;
        int const K_KF = 0;
        int const V_KF = 0;
        auto const sources = pre_attention_sources(K, V, 4, K_KF, V_KF, 3);
        REQUIRE(sources.size() == 4);
        CHECK(sources[0].K == &K);
        CHECK(sources[0].V == &V);
        CHECK(sources[0].frame == 4);
        for (std::size_t k = 0; k < 3; ++k) {
            CHECK(sources[k + 1].K == &K_KF);
            CHECK(sources[k + 1].V == &V_KF);
            CHECK(sources[k + 1].frame == k);
        }
    }

    TEST_CASE("[GR eq. 5] the keyframe that is left out is the only one missing") {
        int const K = 0;
        int const K_KF = 0;
        auto const sources = pre_attention_sources(K, K, 0, K_KF, K_KF, 3, 1);
        REQUIRE(sources.size() == 3);
        CHECK(sources[0].K == &K);
        CHECK(sources[1].frame == 0);
        CHECK(sources[2].frame == 2);
        CHECK(pre_attention_sources(K, K, 0, K_KF, K_KF, 1, 0).size() == 1);
    }

    TEST_CASE("[GR eq. 5] keys and values of another number of keyframes are refused") {
        auto const one = random_features<double>({1, 5, 2}, 1);
        auto const two = random_features<double>({2, 5, 2}, 2);
        auto const three = random_features<double>({3, 5, 2}, 3);
        CHECK_NOTHROW(pre_attention_sources(one, one, 0, three, three, 3));
        CHECK_THROWS_WITH_AS(pre_attention_sources(one, one, 0, two, three, 3),
                             "pre_attention_sources: K_KF is [2, 5, 2], expected [3, 5, 2]", shape_error);
        CHECK_THROWS_WITH_AS(pre_attention_sources(one, one, 0, three, two, 3),
                             "pre_attention_sources: V_KF is [2, 5, 2], expected [3, 5, 2]", shape_error);
        // More of them than keyframes are another pass's too, and a keyframe that is left out is still there.
        CHECK_THROWS_AS(pre_attention_sources(one, one, 0, three, three, 2, 1), shape_error);
    }

    TEST_CASE_TEMPLATE("[GR eq. 5] one token and one keyframe by hand", Real, float, double) {
        matrix_module<Real> module(1);
        module.W_Q(0, 0) = 1;
        module.W_K(0, 0) = 2;
        module.W_V(0, 0) = 10;
        auto const f = host_features<Real>::allocate({1, 1, 1});
        auto const f_KF = host_features<Real>::allocate({1, 1, 1});
        f.view()(0, 0, 0) = Real(0.5);
        f_KF.view()(0, 0, 0) = -1;
        // Q = 0.5, K = (1, -2), V = (5, -10): logits 0.5 and -1
        auto const own = std::exp(0.5) / (std::exp(0.5) + std::exp(-1.0));
        auto const F_hat = pre_attended(module, f, f_KF);
        CHECK(F_hat.view()(0, 0, 0) == doctest::Approx(own * 5 + (1 - own) * -10).epsilon(1e-6));
    }

    TEST_CASE_TEMPLATE("[GR eq. 5] F_hat is attention over W [f_i f_KF] joined in memory", Real, float, double) {
        struct world {
            std::size_t frames, keyframes, tokens, channels, heads;
        };
        auto const tolerance = sizeof(Real) == 4 ? 1e-5 : 1e-13;
        std::uint64_t seed = 1;
        for (auto const& [frames, keyframes, tokens, channels, heads] :
             {world{1, 1, 1, 2, 1}, world{3, 2, 5, 8, 2}, world{2, 4, 17, 12, 3}, world{1, 3, 70, 6, 6}}) {
            matrix_module<Real> const module(channels, heads, ++seed);
            auto const f = random_features<Real>({frames, tokens, channels}, ++seed);
            auto const f_KF = random_features<Real>({keyframes, tokens, channels}, ++seed);
            auto const F_hat = pre_attended(module, f, f_KF);
            auto const F_hat_without_0 = pre_attended(module, f, f_KF, 0);
            std::vector<std::size_t> all;
            for (std::size_t k = 0; k < keyframes; ++k) {
                all.push_back(k);
            }
            std::vector<std::size_t> const without_0(all.begin() + 1, all.end());
            for (std::size_t i = 0; i < frames; ++i) {
                auto const own = joined_rows(f, {i});
                auto const joined = [&](std::vector<std::size_t> const& with) {
                    auto rows = own;
                    auto const others = joined_rows(f_KF, with);
                    rows.insert(rows.end(), others.begin(), others.end());
                    return rows;
                };
                CHECK(greatest_difference(F_hat, i, dense_self_attention(module, own, joined(all))) < tolerance);
                CHECK(greatest_difference(F_hat_without_0, i, dense_self_attention(module, own, joined(without_0))) <
                      tolerance);
            }
        }
    }

    TEST_CASE("[GR eq. 5] a single keyframe equal to the frame itself changes nothing") {
        matrix_module<double> const module(6, 2, 5);
        auto const f = random_features<double>({1, 9, 6}, 6);
        auto const F_hat = pre_attended(module, f, f);
        std::vector<frame_index> const frames(1);
        call_of<double> call({}, frames, f, module);
        CHECK(greatest_difference(F_hat, 0, joined_rows(plain_attention{}(call), {0})) < 1e-14);
    }

    TEST_CASE("[GR eq. 5] without its own copy a keyframe meets what it met in extended attention") {
        matrix_module<double> const module(6, 1, 5);
        auto const f_KF = random_features<double>({3, 9, 6}, 6);
        std::vector<frame_index> const frames(3);
        call_of<double> const call({}, frames, f_KF, module);
        auto const K = call.key(f_KF);
        auto const V = call.value(f_KF);
        auto const extended = call.attend(call.query(f_KF), extended_attention_sources(K, V, 3));
        attention_sources<host_features<double>> sources;
        for (std::size_t k = 0; k < 3; ++k) {
            sources.push_back(pre_attention_sources(K, V, k, K, V, 3, k));
        }
        auto const F_hat = call.attend(call.query(f_KF), sources);
        auto const F_hat_twice = pre_attended(module, f_KF, f_KF);
        for (std::size_t k = 0; k < 3; ++k) {
            CHECK(greatest_difference(F_hat, k, joined_rows(extended, {k})) < 1e-14);
            CHECK(greatest_difference(F_hat_twice, k, joined_rows(extended, {k})) > 1e-3);
        }
    }
}
