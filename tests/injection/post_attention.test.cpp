// SPDX-License-Identifier: MIT
// [GR eq. 6] Where keyframes cover a token F_hat moves towards F_bar by alpha; elsewhere it stays.
#include <genrender/injection/post_attention.hpp>

#include <genrender/core/error.hpp>

#include "dense_equations.hpp"

#include <doctest/doctest.h>

#include <limits>
#include <vector>

using namespace genrender;
using namespace genrender::testing;

TEST_SUITE("injection/post_attention") {
    namespace {

    constexpr std::size_t tokens = 23;
    constexpr std::size_t keyframes = 3;
    constexpr std::size_t channels = 5;

    /// x with the affine map W x + b applied to every token, as an output projection does.
    host_features<double> projected(host_features<double> const& x) {
        auto const W = random_stack<double, 2>({channels, channels}, 71);
        auto const b = random_stack<double, 1>({channels}, 72);
        auto const y = host_features<double>::allocate(x.extents());
        for (std::size_t i = 0; i < x.extents()[0]; ++i) {
            for (std::size_t t = 0; t < x.extents()[1]; ++t) {
                for (std::size_t r = 0; r < channels; ++r) {
                    y.view()(i, t, r) = b(r);
                    for (std::size_t c = 0; c < channels; ++c) {
                        y.view()(i, t, r) += W(r, c) * x.view()(i, t, c);
                    }
                }
            }
        }
        return y;
    }

    } // namespace

    TEST_CASE_TEMPLATE("[GR eq. 6] a covered and an uncovered token by hand", Real, float, double) {
        std::vector<std::uint32_t> const offsets{0, 2, 2};
        std::vector<std::uint32_t> const sources{1, 2}; // token 1 of keyframe 0 and token 0 of keyframe 1
        std::vector<Real> const weights{Real(0.75), Real(0.25)};
        stack<Real, 3> F_KF({2, 2, 1});
        F_KF(0, 1, 0) = 4;
        F_KF(1, 0, 0) = 8;
        stack<Real, 2> F({2, 1});
        F(0, 0) = 10;
        F(1, 0) = 7;
        post_attention(F.view(), F_KF, sparse_rows<Real>{offsets, sources, weights}, Real(0.7));
        CHECK(F(0, 0) == doctest::Approx(0.7 * (0.75 * 4 + 0.25 * 8) + 0.3 * 10)); // 6.5
        CHECK(F(1, 0) == 7);
    }

    TEST_CASE_TEMPLATE("[GR eq. 6] alpha 0 leaves F_hat bit for bit", Real, float, double) {
        random_plan<Real> const plan(tokens, keyframes, 1);
        auto const F_KF = random_features<Real>({keyframes, tokens, channels}, 2);
        auto const F_hat = random_features<Real>({1, tokens, channels}, 3);
        auto const F = random_features<Real>({1, tokens, channels}, 3);
        post_attention(F.view()[0], F_KF, plan.rows(), Real(0));
        CHECK(equal_bits(F, F_hat));
        // Not even a feature that overflowed shows.
        F_KF.view()(plan.sources[0] / tokens, plan.sources[0] % tokens, 0) = std::numeric_limits<Real>::infinity();
        post_attention(F.view()[0], F_KF, plan.rows(), Real(0));
        CHECK(equal_bits(F, F_hat));
    }

    TEST_CASE_TEMPLATE("[GR eq. 6] alpha 1 gives F_bar and uncovered tokens still keep F_hat", Real, float, double) {
        random_plan<Real> const plan(tokens, keyframes, 1);
        auto const F_KF = random_features<Real>({keyframes, tokens, channels}, 2);
        auto const F_hat = random_features<Real>({1, tokens, channels}, 3);
        auto const F = random_features<Real>({1, tokens, channels}, 3);
        post_attention(F.view()[0], F_KF, plan.rows(), Real(1));
        std::size_t uncovered = 0;
        for (std::size_t t = 0; t < tokens; ++t) {
            for (std::size_t c = 0; c < channels; ++c) {
                Real F_bar = 0;
                for (auto e = plan.offsets[t]; e < plan.offsets[t + 1]; ++e) {
                    F_bar += plan.weights[e] * F_KF.view()(plan.sources[e] / tokens, plan.sources[e] % tokens, c);
                }
                auto const is_covered = plan.rows().is_covered(t);
                auto const kept = F_hat.view()(0, t, c);
                CHECK(F.view()(0, t, c) == doctest::Approx(is_covered ? F_bar : kept).epsilon(1e-6));
                uncovered += is_covered ? 0U : 1U;
            }
        }
        CHECK(uncovered > 0);
        CHECK(uncovered < tokens * channels);
    }

    TEST_CASE("[GR eq. 6] with alpha 1 what F_hat was does not matter where it is covered") {
        random_plan<double> const plan(tokens, keyframes, 1);
        auto const F_KF = random_features<double>({keyframes, tokens, channels}, 2);
        auto const F = host_features<double>::allocate({1, tokens, channels});
        for (std::size_t e = 0; e < F.view().size(); ++e) {
            F.view().data()[e] = std::numeric_limits<double>::quiet_NaN();
        }
        post_attention(F.view()[0], F_KF, plan.rows(), 1.0);
        for (std::size_t t = 0; t < tokens; ++t) {
            CHECK(std::isfinite(F.view()(0, t, 0)) == plan.rows().is_covered(t));
        }
    }

    TEST_CASE_TEMPLATE("[GR eq. 6] any alpha equals the dense equation", Real, float, double) {
        random_plan<Real> const plan(tokens, keyframes, 4);
        auto const F_KF = random_features<Real>({keyframes, tokens, channels}, 5);
        for (auto const alpha : {Real(0.3), Real(0.7), Real(-0.5), Real(1.5)}) {
            auto const F = random_features<Real>({1, tokens, channels}, 6);
            auto const expected = dense_mix(joined_rows(F, {0}), joined_rows(F_KF, {0, 1, 2}), plan.rows(), alpha);
            post_attention(F.view()[0], F_KF, plan.rows(), alpha);
            CHECK(greatest_difference(F, 0, expected) < (sizeof(Real) == 4 ? 1e-6 : 1e-14));
        }
    }

    TEST_CASE("[GR eq. 6] blending before or after an affine output projection is the same") {
        random_plan<double> const plan(tokens, keyframes, 4);
        auto const F_KF = random_features<double>({keyframes, tokens, channels}, 5);
        auto const F_hat = random_features<double>({1, tokens, channels}, 6);
        auto const after = projected(F_hat);
        post_attention(after.view()[0], projected(F_KF), plan.rows(), 0.7);
        post_attention(F_hat.view()[0], F_KF, plan.rows(), 0.7);
        CHECK(greatest_difference(after, 0, joined_rows(projected(F_hat), {0})) < 1e-13);
    }

    TEST_CASE("an alpha that is no number and features that do not fit are refused in a sentence") {
        random_plan<double> const plan(2, 1, 4);
        stack<double, 2> F_hat({2, 3});
        stack<double, 3> F_KF({1, 2, 3});
        CHECK_THROWS_WITH_AS(post_attention(F_hat.view(), F_KF, plan.rows(), std::numeric_limits<double>::quiet_NaN()),
                             "post_attention: alpha is nan, expected a finite number", value_error);
        CHECK_THROWS_WITH_AS(post_attention(F_hat.view(), F_KF, plan.rows(), std::numeric_limits<double>::infinity()),
                             "post_attention: alpha is inf, expected a finite number", value_error);
        stack<double, 3> const other_channels({1, 2, 4});
        CHECK_THROWS_WITH_AS(post_attention(F_hat.view(), other_channels, plan.rows(), 0.5),
                             "mix_rows: F_KF is [1, 2, 4], expected [1, 2, 3]", shape_error);
        random_plan<double> const other_tokens(3, 1, 4);
        CHECK_THROWS_WITH_AS(post_attention(F_hat.view(), F_KF, other_tokens.rows(), 0.5),
                             "mix_rows: rows is [3], expected [2]", shape_error);
    }
}
