// SPDX-License-Identifier: MIT
// [GR sec. 3.2] The kernel of blending on every layout.
#include <genrender/blending/mix_rows.hpp>

#include <genrender/core/linalg.hpp>

#include <genrender/testing/random_stack.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

using namespace genrender;

TEST_SUITE("blending/mix_rows") {
    TEST_CASE_TEMPLATE("a row by hand", Real, float, double) {
        stack<Real, 3> F_KF({2, 2, 1});
        F_KF(0, 1, 0) = 4;
        F_KF(1, 0, 0) = 8;
        std::vector<std::uint32_t> const offsets{0, 2, 2};
        std::vector<std::uint32_t> const sources{1, 2};
        std::vector<Real> const weights{Real(0.75), Real(0.25)};
        stack<Real, 2> F({2, 1});
        F(0, 0) = 1;
        F(1, 0) = 9;
        mix_rows(F.view(), F_KF, sparse_rows<Real>{offsets, sources, weights}, Real(0.5));
        CHECK(F(0, 0) == doctest::Approx(0.5 * 1 + 0.5 * (0.75 * 4 + 0.25 * 8)));
        CHECK(F(1, 0) == 9);
    }
    TEST_CASE_TEMPLATE("strided and contiguous features give the same", Real, float, double) {
        std::size_t const tokens = 7;
        std::size_t const channels = 5;
        auto const F_KF = testing::random_stack<Real, 3>({3, tokens, channels}, 1);
        stack<Real, 3> channel_major({3, channels, tokens});
        strided_view<Real, 3> const F_KF_strided(
            channel_major.data(), {3, tokens, channels},
            {static_cast<std::ptrdiff_t>(tokens * channels), 1, static_cast<std::ptrdiff_t>(tokens)});
        copy(F_KF_strided, in_view<Real, 3>(F_KF));
        std::vector<std::uint32_t> const offsets{0, 1, 1, 3, 6, 7, 7, 9};
        std::vector<std::uint32_t> const sources{20, 3, 9, 0, 7, 14, 6, 13, 1};
        std::vector<Real> const weights{1,         Real(0.5), Real(0.5), Real(0.2), Real(0.3),
                                        Real(0.5), 1,         Real(0.1), Real(0.9)};
        sparse_rows<Real> const rows{offsets, sources, weights};
        for (auto const alpha : {Real(0.7), Real(1), Real(0)}) {
            auto plain = testing::random_stack<Real, 2>({tokens, channels}, 2);
            auto const before = plain;
            stack<Real, 2> transposed({channels, tokens});
            strided_view<Real, 2> const strided(transposed.data(), {tokens, channels},
                                                {1, static_cast<std::ptrdiff_t>(tokens)});
            copy(strided, in_view<Real, 2>(plain));
            mix_rows(plain.view(), F_KF, rows, alpha);
            mix_rows(strided, F_KF_strided, rows, alpha);
            for (std::size_t t = 0; t < tokens; ++t) {
                for (std::size_t c = 0; c < channels; ++c) {
                    Real F_bar = 0;
                    for (auto e = offsets[t]; e < offsets[t + 1]; ++e) {
                        F_bar += weights[e] * F_KF(sources[e] / tokens, sources[e] % tokens, c);
                    }
                    auto const expected =
                        rows.is_covered(t) ? (1 - alpha) * before(t, c) + alpha * F_bar : before(t, c);
                    CHECK(plain(t, c) == doctest::Approx(expected).epsilon(1e-5));
                    // Where products and sums are fused, not to the last bit.
                    CHECK(strided(t, c) == doctest::Approx(plain(t, c)).epsilon(1e-5));
                }
            }
        }
    }
    TEST_CASE_TEMPLATE("every number of sources and channels gives what the formula gives", Real, float, double) {
        constexpr std::size_t keyframes = 3;
        for (std::size_t const channels : {1U, 2U, 7U, 16U, 33U, 320U}) {
            for (std::uint32_t const tokens : {1U, 5U, 300U}) {
                auto const F_KF = testing::random_stack<Real, 3>({keyframes, tokens, channels}, channels);
                auto const before = testing::random_stack<Real, 2>({tokens, channels}, tokens);
                std::vector<std::uint32_t> offsets{0};
                std::vector<std::uint32_t> sources;
                std::vector<Real> weights;
                for (std::uint32_t t = 0; t < tokens; ++t) {
                    // Up to 19 sources, 0 of some tokens.
                    for (std::uint32_t e = 0; e < (t + channels) % 20; ++e) {
                        sources.push_back(uniform_below(keyframes * tokens, 1, random_stream::test, {t, e, 0}));
                        weights.push_back(static_cast<Real>(uniform_value(1, random_stream::test, {t, e, 1})));
                    }
                    offsets.push_back(static_cast<std::uint32_t>(sources.size()));
                }
                sparse_rows<Real> const rows{offsets, sources, weights};
                for (auto const alpha : {Real(0.7), Real(1)}) {
                    auto F = before;
                    mix_rows(F.view(), F_KF, rows, alpha);
                    auto by_threads = before;
                    mix_rows(by_threads.view(), F_KF, rows, alpha, threaded_loop(3));
                    double worst = 0;
                    std::size_t differing = 0;
                    for (std::size_t t = 0; t < tokens; ++t) {
                        for (std::size_t c = 0; c < channels; ++c) {
                            double expected = rows.is_covered(t) ? (1.0 - double{alpha}) * double{before(t, c)}
                                                                 : double{before(t, c)};
                            for (auto e = offsets[t]; e < offsets[t + 1]; ++e) {
                                expected += double{alpha} * double{weights[e]} *
                                            double{F_KF(sources[e] / tokens, sources[e] % tokens, c)};
                            }
                            worst = std::max(worst, std::abs(expected - double{F(t, c)}));
                            differing += F(t, c) == by_threads(t, c) ? 0U : 1U;
                        }
                    }
                    CHECK(worst < (sizeof(Real) == 4 ? 1e-5 : 1e-13));
                    CHECK(differing == 0);
                }
            }
        }
    }
    TEST_CASE_TEMPLATE("features kept in 16 bits are mixed as what they say", Stored, float16, bfloat16) {
        std::size_t const tokens = 9;
        std::size_t const channels = 37;
        auto const given = testing::random_stack<float, 3>({2, tokens, channels}, 4);
        stack<Stored, 3> stored({2, tokens, channels});
        stack<float, 3> widened({2, tokens, channels});
        for (std::size_t e = 0; e < given.size(); ++e) {
            stored.data()[e] = static_cast<Stored>(given.data()[e]);
            widened.data()[e] = static_cast<float>(stored.data()[e]);
        }
        std::vector<std::uint32_t> const offsets{0, 1, 1, 3, 6, 7, 7, 9, 14, 15};
        std::vector<std::uint32_t> const sources{17, 3, 9, 0, 7, 14, 6, 13, 1, 2, 4, 8, 16, 12, 5};
        std::vector<float> const weights{1,    0.5F, 0.5F, 0.2F, 0.3F, 0.5F, 1,   0.1F,
                                         0.9F, 0.2F, 0.2F, 0.2F, 0.2F, 0.2F, 0.6F};
        sparse_rows<float> const rows{offsets, sources, weights};
        auto F = testing::random_stack<float, 2>({tokens, channels}, 2);
        auto expected = F;
        auto strided = stack<float, 2>({channels, tokens});
        strided_view<float, 2> const by_columns(strided.data(), {tokens, channels},
                                                {1, static_cast<std::ptrdiff_t>(tokens)});
        copy(by_columns, in_view<float, 2>(F));
        mix_rows(expected.view(), widened, rows, 0.7F);
        mix_rows(F.view(), stored.view(), rows, 0.7F);
        mix_rows(by_columns, std::as_const(stored).view(), rows, 0.7F);
        for (std::size_t t = 0; t < tokens; ++t) {
            for (std::size_t c = 0; c < channels; ++c) {
                CHECK(F(t, c) == doctest::Approx(expected(t, c)).epsilon(1e-5));
                CHECK(by_columns(t, c) == doctest::Approx(expected(t, c)).epsilon(1e-5));
            }
        }
    }
    TEST_CASE("no tokens and no channels are no work") {
        stack<float, 2> none({0, 4});
        stack<float, 3> const F_KF({1, 0, 4});
        std::vector<std::uint32_t> const offsets{0};
        CHECK_NOTHROW(mix_rows(none.view(), F_KF, {offsets, {}, {}}, 0.5F));
        stack<float, 2> narrow({1, 0});
        stack<float, 3> const narrow_KF({1, 1, 0});
        std::vector<std::uint32_t> const one{0, 1};
        std::vector<std::uint32_t> const sources{0};
        std::vector<float> const weights{1};
        CHECK_NOTHROW(mix_rows(narrow.view(), narrow_KF, {one, sources, weights}, 0.5F));
    }
    TEST_CASE("with alpha 1 the former feature is not read") {
        stack<float, 3> F_KF({1, 1, 1});
        F_KF(0, 0, 0) = 2;
        stack<float, 2> F({1, 1});
        F(0, 0) = std::numeric_limits<float>::quiet_NaN();
        std::vector<std::uint32_t> const offsets{0, 1};
        std::vector<std::uint32_t> const sources{0};
        std::vector<float> const weights{1};
        mix_rows(F.view(), F_KF, {offsets, sources, weights}, 1);
        CHECK(F(0, 0) == 2);
    }
    TEST_CASE("a plan for more keyframes than there are features of is refused by name") {
        stack<float, 2> F({1, 3});
        stack<float, 3> const F_KF({2, 1, 3});
        std::vector<std::uint32_t> const offsets{0, 1};
        std::vector<std::uint32_t> const sources{2};
        std::vector<float> const weights{1};
        CHECK_THROWS_WITH_AS(mix_rows(F.view(), F_KF, {offsets, sources, weights}, 1),
                             "mix_rows: rows.sources is 2, expected a row of the features' keyframes and tokens",
                             value_error);
        stack<float, 3> const nothing({2, 0, 3});
        CHECK_THROWS_AS(mix_rows(F.view(), nothing, {offsets, sources, weights}, 1), value_error);
    }
    TEST_CASE("features that do not fit are refused by name") {
        stack<float, 2> F({2, 3});
        stack<float, 3> F_KF({1, 2, 4});
        std::vector<std::uint32_t> const offsets{0, 0};
        CHECK_THROWS_WITH_AS(mix_rows(F.view(), F_KF, {offsets, {}, {}}, 1),
                             "mix_rows: F_KF is [1, 2, 4], expected [1, 2, 3]", shape_error);
        stack<float, 3> fits({1, 2, 3});
        CHECK_THROWS_WITH_AS(mix_rows(F.view(), fits, {offsets, {}, {}}, 1), "mix_rows: rows is [1], expected [2]",
                             shape_error);
    }
}
