// SPDX-License-Identifier: MIT
// Eq. 6 that keeps variance: by hand, against the law of total variance written plainly, and on every layout.
#include <genrender/blending/mix_rows_keeping_variance.hpp>

#include <genrender/core/linalg.hpp>
#include <genrender/core/random.hpp>
#include <genrender/testing/random_stack.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

using namespace genrender;

TEST_SUITE("blending/mix_rows_keeping_variance") {
    namespace {

    constexpr kept_variance of_total{variance_target::total};
    constexpr kept_variance of_sources{variance_target::sources};

    /// Rows of up to `most` sources whose weights sum to 1; every third token has none.
    template <class Real>
    struct some_rows {
        std::vector<std::uint32_t> offsets{0};
        std::vector<std::uint32_t> sources;
        std::vector<Real> weights;

        some_rows(std::uint32_t tokens, std::uint32_t rows_of_F_KF, std::uint32_t most) {
            for (std::uint32_t t = 0; t < tokens; ++t) {
                auto const count = t % 3 == 2 ? 0 : 1 + t % most;
                for (std::uint32_t e = 0; e < count; ++e) {
                    sources.push_back(uniform_below(rows_of_F_KF, 1, random_stream::test, {t, e, 0}));
                    weights.push_back(static_cast<Real>(2 * (e + 1)) / static_cast<Real>(count * (count + 1)));
                }
                offsets.push_back(static_cast<std::uint32_t>(sources.size()));
            }
        }
        sparse_rows<Real> view() const { return {offsets, sources, weights}; }
    };

    /// Mean and variance of numbers with weights.
    struct weighted_numbers {
        std::vector<std::pair<double, double>> numbers; // value, weight
        double mean() const {
            return moment([](double x) { return x; });
        }
        double variance() const {
            auto const m = mean();
            return moment([m](double x) { return (x - m) * (x - m); });
        }
        template <class Of>
        double moment(Of of) const {
            double sum = 0;
            double weight = 0;
            for (auto const *number = numbers.data(), *end = number + numbers.size(); number != end; ++number) {
                sum += number->second * of(number->first);
                weight += number->second;
            }
            return sum / weight;
        }
    };

    /// The definition, channel by channel in plain loops.
    template <class Real>
    stack<double, 2> plainly(stack<Real, 2> const& F_hat, stack<Real, 3> const& F_KF, sparse_rows<Real> const& rows,
                             double alpha, kept_variance const& kept) {
        auto const tokens = F_hat.extent(0);
        auto const of_frame = F_KF.extent(1);
        stack<double, 2> F({tokens, F_hat.extent(1)});
        for (std::size_t c = 0; c < F_hat.extent(1); ++c) {
            weighted_numbers mixed;
            weighted_numbers all;
            weighted_numbers of_keyframes;
            for (std::size_t t = 0; t < tokens; ++t) {
                F(t, c) = double{F_hat(t, c)};
                if (!rows.is_covered(t)) {
                    continue;
                }
                F(t, c) *= 1 - alpha;
                all.numbers.emplace_back(F_hat(t, c), 1 - alpha);
                for (std::size_t e = rows.offsets[t]; e < rows.offsets[t + 1]; ++e) {
                    auto const x = double{F_KF(rows.sources[e] / of_frame, rows.sources[e] % of_frame, c)};
                    F(t, c) += alpha * double{rows.weights[e]} * x;
                    all.numbers.emplace_back(x, alpha * double{rows.weights[e]});
                    of_keyframes.numbers.emplace_back(x, double{rows.weights[e]});
                }
                mixed.numbers.emplace_back(F(t, c), 1);
            }
            auto const to = kept.target == variance_target::total ? all.variance() : of_keyframes.variance();
            auto const gain = std::clamp(std::sqrt(to / mixed.variance()), 1 / kept.most_gain, kept.most_gain);
            for (std::size_t t = 0; t < tokens; ++t) {
                if (rows.is_covered(t)) {
                    F(t, c) = mixed.mean() + gain * (F(t, c) - mixed.mean());
                }
            }
        }
        return F;
    }

    template <class A, class B>
    double greatest_difference(A const& a, B const& b) {
        double greatest = 0;
        for (std::size_t t = 0; t < a.extent(0); ++t) {
            for (std::size_t c = 0; c < a.extent(1); ++c) {
                greatest = std::max(greatest, std::abs(static_cast<double>(a(t, c)) - static_cast<double>(b(t, c))));
            }
        }
        return greatest;
    }

    template <class Real>
    constexpr double tolerance = sizeof(Real) == 4 ? 2e-5 : 1e-12;

    } // namespace

    TEST_CASE_TEMPLATE("by hand: two tokens of two sources each", Real, float, double) {
        // Token 0 mixes 4 and 0 to 2, token 1 mixes -4 and 0 to -2, token 2 keeps its 9. Variance of F_out: 4; of what was
        // averaged: (16 + 0 + 16 + 0) / 4 = 8. Gain: the root of 2.
        stack<Real, 3> F_KF({2, 3, 1});
        F_KF(0, 0, 0) = 4;
        F_KF(0, 1, 0) = -4;
        std::vector<std::uint32_t> const offsets{0, 2, 4, 4};
        std::vector<std::uint32_t> const sources{0, 3, 1, 4};
        std::vector<Real> const weights(4, Real(0.5));
        stack<Real, 2> F({3, 1});
        F(2, 0) = 9;
        for (auto const& kept : {of_total, of_sources}) {
            F(0, 0) = F(1, 0) = 7; // alpha 1: nothing of it is left
            mix_rows_keeping_variance(F.view(), F_KF, {offsets, sources, weights}, Real(1), kept);
            CHECK(F(0, 0) == doctest::Approx(2 * std::sqrt(2.0)));
            CHECK(F(1, 0) == doctest::Approx(-2 * std::sqrt(2.0)));
            CHECK(F(2, 0) == 9);
        }
    }
    TEST_CASE_TEMPLATE("it is the law of total variance, and the sources' variance, written plainly", Real, float,
                       double) {
        constexpr std::size_t keyframes = 3;
        for (std::size_t const channels : {1U, 7U, 16U, 33U}) {
            for (std::uint32_t const tokens : {4U, 5U, 300U, 700U}) {
                auto const F_KF = testing::random_stack<Real, 3>({keyframes, tokens, channels}, channels);
                auto const F_hat = testing::random_stack<Real, 2>({tokens, channels}, tokens);
                some_rows<Real> const rows(tokens, keyframes * tokens, 19); // more than a pass takes
                for (auto const alpha : {Real(0.7), Real(1)}) {
                    for (auto const& kept : {of_total, of_sources}) {
                        auto F = F_hat;
                        mix_rows_keeping_variance(F.view(), F_KF, rows.view(), alpha, kept);
                        CHECK(greatest_difference(F, plainly(F_hat, F_KF, rows.view(), double{alpha}, kept)) <
                              tolerance<Real>);
                        auto by_threads = F_hat;
                        mix_rows_keeping_variance(by_threads.view(), F_KF, rows.view(), alpha, kept, threaded_loop(3));
                        CHECK(std::equal(F.data(), F.data() + F.size(), by_threads.data()));
                    }
                }
            }
        }
    }
    TEST_CASE_TEMPLATE("a mean far from 0 costs no digits", Real, float, double) {
        std::uint32_t const tokens = 600;
        auto F_KF = testing::random_stack<Real, 3>({2, tokens, 5}, 3);
        auto F_hat = testing::random_stack<Real, 2>({tokens, 5}, 4);
        for (auto* const values : {F_KF.data(), F_hat.data()}) {
            auto const count = values == F_KF.data() ? F_KF.size() : F_hat.size();
            std::for_each(values, values + count, [](Real& x) { x += 100; });
        }
        some_rows<Real> const rows(tokens, 2 * tokens, 4);
        for (auto const& kept : {of_total, of_sources}) {
            auto F = F_hat;
            mix_rows_keeping_variance(F.view(), F_KF, rows.view(), Real(0.7), kept);
            CHECK(greatest_difference(F, plainly(F_hat, F_KF, rows.view(), double{Real(0.7)}, kept)) <
                  (sizeof(Real) == 4 ? 2e-4 : 1e-11));
        }
    }
    TEST_CASE_TEMPLATE("a target of none, alpha 0 and rows without an entry give the bits of mix_rows", Real, float,
                       double) {
        std::uint32_t const tokens = 40;
        auto const F_KF = testing::random_stack<Real, 3>({2, tokens, 9}, 3);
        auto const F_hat = testing::random_stack<Real, 2>({tokens, 9}, 4);
        some_rows<Real> const rows(tokens, 2 * tokens, 12);
        auto const same = [&](sparse_rows<Real> const& some, Real alpha, kept_variance const& kept) {
            auto F = F_hat;
            auto expected = F_hat;
            mix_rows_keeping_variance(F.view(), F_KF, some, alpha, kept);
            mix_rows(expected.view(), F_KF, some, alpha);
            return std::equal(F.data(), F.data() + F.size(), expected.data());
        };
        CHECK(same(rows.view(), Real(0.7), {}));
        CHECK(same(rows.view(), Real(0), of_total));
        std::vector<std::uint32_t> const none(tokens + 1, 0);
        CHECK(same({none, {}, {}}, Real(0.7), of_total));
        CHECK_FALSE(same(rows.view(), Real(0.7), of_total));
    }
    TEST_CASE_TEMPLATE("with nothing to give back F_out has the bits of mix_rows", Real, float, double) {
        std::uint32_t const tokens = 300;
        auto const F_KF = testing::random_stack<Real, 3>({2, tokens, 9}, 3);
        auto const F_hat = testing::random_stack<Real, 2>({tokens, 9}, 4);
        some_rows<Real> const rows(tokens, 2 * tokens, 1); // one source a token and alpha 1: no average at all
        auto F = F_hat;
        auto expected = F_hat;
        mix_rows_keeping_variance(F.view(), F_KF, rows.view(), Real(1), of_total);
        mix_rows(expected.view(), F_KF, rows.view(), Real(1));
        CHECK(greatest_difference(F, expected) < tolerance<Real>);
        mix_rows_keeping_variance(F.view(), F_KF, rows.view(), Real(0.7),
                                  {variance_target::total, 1}); // no gain allowed
        mix_rows(expected.view(), F_KF, rows.view(), Real(0.7));
        CHECK(greatest_difference(F, expected) < tolerance<Real>);
    }
    TEST_CASE("a single covered token, and tokens that are all alike, are only mixed") {
        stack<double, 3> F_KF({1, 3, 2});
        std::fill_n(F_KF.data(), F_KF.size(), 3.0);
        F_KF(0, 2, 0) = 8;
        std::vector<double> const weights{0.5, 0.5, 1};
        stack<double, 2> F({3, 2});
        std::vector<std::uint32_t> const one{0, 2, 2, 2};
        std::vector<std::uint32_t> const sources{0, 2};
        mix_rows_keeping_variance(F.view(), F_KF, {one, sources, weights}, 1.0, of_total);
        CHECK(F(0, 0) == 5.5);
        std::vector<std::uint32_t> const all{0, 1, 2, 3};
        std::vector<std::uint32_t> const alike{0, 1, 0};
        std::vector<double> const whole(3, 1.0);
        mix_rows_keeping_variance(F.view(), F_KF, {all, alike, whole}, 1.0, of_total);
        CHECK(F(0, 0) == 3);
        CHECK(F(2, 1) == 3);
    }
    TEST_CASE("a gain is at most what is allowed, and at least its inverse") {
        CHECK(variance_gain(1, 4, 8) == 2);
        CHECK(variance_gain(1, 100, 2) == 2);
        CHECK(variance_gain(100, 1, 2) == 0.5);
        CHECK(variance_gain(0, 1, 2) == 1);
        CHECK(variance_gain(1, 0, 2) == 1);
        CHECK(variance_gain(-1, 1, 2) == 1);
    }
    TEST_CASE_TEMPLATE("strided and contiguous features give the same", Real, float, double) {
        std::uint32_t const tokens = 21;
        std::size_t const channels = 19;
        auto const F_KF = testing::random_stack<Real, 3>({3, tokens, channels}, 1);
        stack<Real, 3> channel_major({3, channels, tokens});
        strided_view<Real, 3> const F_KF_strided(
            channel_major.data(), {3, tokens, channels},
            {static_cast<std::ptrdiff_t>(tokens * channels), 1, static_cast<std::ptrdiff_t>(tokens)});
        copy(F_KF_strided, in_view<Real, 3>(F_KF));
        some_rows<Real> const rows(tokens, 3 * tokens, 11);
        for (auto const& kept : {of_total, of_sources}) {
            auto plain = testing::random_stack<Real, 2>({tokens, channels}, 2);
            stack<Real, 2> transposed({channels, tokens});
            strided_view<Real, 2> const strided(transposed.data(), {tokens, channels},
                                                {1, static_cast<std::ptrdiff_t>(tokens)});
            copy(strided, in_view<Real, 2>(plain));
            mix_rows_keeping_variance(plain.view(), F_KF, rows.view(), Real(0.7), kept);
            mix_rows_keeping_variance(strided, in_view<Real, 3>(F_KF_strided), rows.view(), Real(0.7), kept);
            CHECK(greatest_difference(plain, strided) < tolerance<Real>);
        }
    }
    TEST_CASE_TEMPLATE("features kept in 16 bits are mixed as what they say", Stored, float16, bfloat16) {
        std::uint32_t const tokens = 30;
        std::size_t const channels = 37;
        auto const given = testing::random_stack<float, 3>({2, tokens, channels}, 4);
        stack<Stored, 3> stored({2, tokens, channels});
        stack<float, 3> widened({2, tokens, channels});
        for (std::size_t e = 0; e < given.size(); ++e) {
            stored.data()[e] = static_cast<Stored>(given.data()[e]);
            widened.data()[e] = static_cast<float>(stored.data()[e]);
        }
        some_rows<float> const rows(tokens, 2 * tokens, 9);
        auto F = testing::random_stack<float, 2>({tokens, channels}, 2);
        auto expected = F;
        mix_rows_keeping_variance(F.view(), stored.view(), rows.view(), 0.7F, of_total);
        mix_rows_keeping_variance(expected.view(), widened, rows.view(), 0.7F, of_total);
        CHECK(std::equal(F.data(), F.data() + F.size(), expected.data()));
    }
    TEST_CASE("with alpha 1 the former feature is not read") {
        stack<float, 3> F_KF({1, 2, 1});
        F_KF(0, 0, 0) = 2;
        stack<float, 2> F({2, 1});
        std::fill_n(F.data(), 2, std::numeric_limits<float>::quiet_NaN());
        std::vector<std::uint32_t> const offsets{0, 1, 2};
        std::vector<std::uint32_t> const sources{0, 1};
        std::vector<float> const weights{1, 1};
        mix_rows_keeping_variance(F.view(), F_KF, {offsets, sources, weights}, 1, of_total);
        CHECK(F(0, 0) == 2);
        CHECK(F(1, 0) == 0);
    }
    TEST_CASE("no tokens and no channels are no work, and what does not fit is refused by name") {
        stack<float, 2> none({0, 4});
        stack<float, 3> const F_KF({1, 0, 4});
        std::vector<std::uint32_t> const offsets{0};
        CHECK_NOTHROW(mix_rows_keeping_variance(none.view(), F_KF, {offsets, {}, {}}, 0.5F, of_total));
        stack<float, 2> F({1, 3});
        stack<float, 3> const other({2, 1, 4});
        std::vector<std::uint32_t> const one{0, 1};
        std::vector<std::uint32_t> const sources{2};
        std::vector<float> const weights{1};
        CHECK_THROWS_WITH_AS(mix_rows_keeping_variance(F.view(), other, {one, sources, weights}, 1, of_total),
                             "mix_rows_keeping_variance: F_KF is [2, 1, 4], expected [2, 1, 3]", shape_error);
        stack<float, 3> const fits({2, 1, 3});
        CHECK_THROWS_WITH_AS(mix_rows_keeping_variance(F.view(), fits, {one, sources, weights}, 1, of_total),
                             "mix_rows_keeping_variance: rows.sources is 2, expected a row of the features' keyframes "
                             "and tokens",
                             value_error);
        CHECK_THROWS_AS(
            mix_rows_keeping_variance(F.view(), fits, {one, sources, weights}, 1, {variance_target::total, 0}),
            value_error);
    }
}
