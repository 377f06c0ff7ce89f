// SPDX-License-Identifier: MIT
// The consensus by hand, by its laws and against a plain second writing.
#include <genrender/blending/consensus.hpp>

#include "../support/plain_consensus.hpp"

#include <genrender/testing/random_stack.hpp>

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

using namespace genrender;
using genrender::testing::random_stack;

TEST_SUITE("blending/consensus") {
    namespace {

    constexpr std::uint8_t whole = 255;

    /// Every cell shows its object alone.
    strided_view<std::uint8_t const, 2> whole_cells(std::size_t height, std::size_t width) {
        return {&whole, {height, width}, {0, 0}};
    }

    /// Rows of four cells over two sources of four: cell 0 is the mean of both, cell 1 of source 0 alone, cell 2 a quarter
    /// and three quarters, cell 3 of nobody.
    struct four_rows {
        std::vector<std::uint32_t> offsets{0, 2, 3, 5, 5};
        std::vector<std::uint32_t> sources{0, 4, 1, 2, 7};
        template <class Real>
        static constexpr std::array<Real, 5> weights{Real(0.5), Real(0.5), 1, Real(0.25), Real(0.75)};

        template <class Real>
        sparse_rows<Real> rows() const {
            return {offsets, sources, weights<Real>};
        }
    };

    template <class Real>
    double deviation(std::vector<Real> const& values) {
        double mean = 0;
        double squares = 0;
        for (auto const value : values) {
            mean += static_cast<double>(value) / static_cast<double>(values.size());
        }
        for (auto const value : values) {
            squares += std::pow(static_cast<double>(value) - mean, 2) / static_cast<double>(values.size());
        }
        return std::sqrt(squares);
    }

    } // namespace

    TEST_CASE_TEMPLATE("estimates are gathered a token a row", Real, float, double) {
        auto const x0 = random_stack<Real, 3>({2, 3, 4}, 1);
        stack<Real, 2> tokens({12, 2});
        gather_estimates(tokens.view(), x0.view());
        CHECK(tokens(5, 1) == x0(1, 1, 1));
        CHECK(tokens(11, 0) == x0(0, 2, 3));
        stack<Real, 2> wrong({11, 2});
        CHECK_THROWS_AS(gather_estimates(wrong.view(), x0.view()), shape_error);
    }
    TEST_CASE_TEMPLATE("mean and gain by hand", Real, float, double) {
        // Averages 2 and 6, of 1 and 3 and of 6: mu = 4, sigma_mix^2 = 4, sigma_src^2 = (9 + 1) / 2 / 2 + 4 / 2 = 4.5.
        std::vector<std::uint32_t> const offsets{0, 2, 3};
        std::vector<std::uint32_t> const sources{0, 2, 1};
        std::vector<Real> const weights{Real(0.5), Real(0.5), 1};
        std::vector<Real> const values{1, 6, 3, 100};
        std::vector<Real> const averages{2, 6};
        sparse_rows<Real> const rows{offsets, sources, weights};
        in_view<Real, 1> const mixed(averages.data(), {2});
        in_view<Real, 2> const x0_src(values.data(), {2, 2});
        auto const both = channel_consensus<Real>::of(mixed, x0_src, rows, 2);
        CHECK(both.mean == 4);
        CHECK(both.gain == doctest::Approx(std::sqrt(4.5) / 2).epsilon(1e-6));
        CHECK(channel_consensus<Real>::of(mixed, x0_src, rows, Real(1.01)).gain == Real(1.01));
        CHECK(channel_consensus<Real>::of(mixed, x0_src, rows, 1).gain == 1);
    }
    TEST_CASE("averages that are all alike have nothing to be multiplied") {
        std::vector<std::uint32_t> const offsets{0, 2, 4};
        std::vector<std::uint32_t> const sources{0, 2, 1, 3};
        std::vector<double> const weights{0.5, 0.5, 0.5, 0.5};
        std::vector<double> const values{-1, -1, 1, 1};
        std::vector<double> const averages{0, 0};
        auto const flat =
            channel_consensus<double>::of(in_view<double, 1>(averages.data(), {2}),
                                          in_view<double, 2>(values.data(), {2, 2}), {offsets, sources, weights}, 2);
        CHECK(flat.gain == 1);
        CHECK(flat.mean == 0);
    }
    TEST_CASE_TEMPLATE("it equals the plainly written equation at any strength, gain and share", Real, float, double) {
        four_rows const plan;
        auto const x0_src = random_stack<Real, 3>({2, 4, 3}, 4);
        std::array<std::uint8_t, 4> const shares{255, 51, 204, 255};
        double worst = 0;
        for (auto const strength : {1.0, 0.25}) {
            for (auto const most_gain : {1.0, 1.05, 4.0}) {
                auto x0 = random_stack<Real, 3>({3, 2, 2}, 5);
                auto const before = x0;
                mix_consensus(x0.view(), x0_src.view(), plan.rows<Real>(), static_cast<Real>(strength),
                              static_cast<Real>(most_gain), {shares.data(), {2, 2}});
                for (std::size_t c = 0; c < 3; ++c) {
                    std::vector<double> own;
                    std::vector<double> strengths;
                    std::vector<testing::weighted_values> lists(4);
                    for (std::size_t t = 0; t < 4; ++t) {
                        own.push_back(static_cast<double>(before(c, t / 2, t % 2)));
                        strengths.push_back(strength * shares[t] / 255);
                        for (auto e = plan.offsets[t]; e < plan.offsets[t + 1]; ++e) {
                            auto const source = plan.sources[e];
                            lists[t].emplace_back(static_cast<double>(x0_src(source / 4, source % 4, c)),
                                                  static_cast<double>(four_rows::weights<Real>[e]));
                        }
                    }
                    auto const expected = testing::plain_consensus(own, lists, strengths, most_gain);
                    for (std::size_t t = 0; t < 4; ++t) {
                        worst = std::max(worst, std::abs(expected[t] - static_cast<double>(x0(c, t / 2, t % 2))));
                    }
                    CHECK(x0(c, 1, 1) == before(c, 1, 1)); // not covered
                }
            }
        }
        MESSAGE("greatest difference ", worst);
        CHECK(worst < (sizeof(Real) == 4 ? 2e-6 : 1e-14));
    }
    TEST_CASE_TEMPLATE("sources that agree are what every frame gets and nothing is multiplied", Real, float, double) {
        four_rows const plan;
        auto x0_src = random_stack<Real, 3>({2, 4, 1}, 6);
        x0_src(1, 0, 0) = x0_src(0, 0, 0); // what cells 0 and 2 average is equal
        x0_src(1, 3, 0) = x0_src(0, 2, 0);
        auto x0 = random_stack<Real, 3>({1, 2, 2}, 7);
        mix_consensus(x0.view(), x0_src.view(), plan.rows<Real>(), 1, 2, whole_cells(2, 2));
        CHECK(x0(0, 0, 0) == doctest::Approx(static_cast<double>(x0_src(0, 0, 0))).epsilon(1e-6));
        CHECK(x0(0, 0, 1) == doctest::Approx(static_cast<double>(x0_src(0, 1, 0))).epsilon(1e-6));
        CHECK(x0(0, 1, 0) == doctest::Approx(static_cast<double>(x0_src(0, 2, 0))).epsilon(1e-6));
    }
    TEST_CASE("the mean of independent estimates keeps their deviation and loses it without a gain") {
        constexpr std::uint32_t cells = 400;
        constexpr std::uint32_t K = 3;
        auto const x0_src = random_stack<double, 3>({K, cells, 1}, 8);
        std::vector<std::uint32_t> offsets{0};
        std::vector<std::uint32_t> sources;
        for (std::uint32_t t = 0; t < cells; ++t) {
            for (std::uint32_t k = 0; k < K; ++k) {
                sources.push_back(k * cells + t);
            }
            offsets.push_back(static_cast<std::uint32_t>(sources.size()));
        }
        std::vector<double> const weights(sources.size(), 1.0 / K);
        sparse_rows<double> const rows{offsets, sources, weights};
        std::vector<double> const all(x0_src.data(), x0_src.data() + x0_src.size());
        auto const deviation_at = [&](double most_gain) {
            stack<double, 3> x0({1, 20, 20});
            mix_consensus(x0.view(), x0_src.view(), rows, 1, most_gain, whole_cells(20, 20));
            return deviation(std::vector<double>(x0.data(), x0.data() + x0.size()));
        };
        CHECK(deviation_at(3) == doctest::Approx(deviation(all)).epsilon(1e-9));
        CHECK(deviation_at(1) == doctest::Approx(deviation(all) / std::sqrt(3.0)).epsilon(0.1));
        CHECK(deviation_at(1.5) == doctest::Approx(1.5 * deviation_at(1)).epsilon(1e-9));
    }
    TEST_CASE_TEMPLATE("of no strength or without rows it changes nothing to the bit", Real, float, double) {
        four_rows const plan;
        auto const x0_src = random_stack<Real, 3>({2, 4, 3}, 4);
        auto x0 = random_stack<Real, 3>({3, 2, 2}, 5);
        auto const before = x0;
        std::vector<std::uint32_t> const none{0, 0, 0, 0, 0};
        mix_consensus(x0.view(), x0_src.view(), plan.rows<Real>(), 0, 2, whole_cells(2, 2));
        mix_consensus(x0.view(), x0_src.view(), sparse_rows<Real>{none, {}, {}}, 1, 2, whole_cells(2, 2));
        CHECK(std::equal(x0.data(), x0.data() + x0.size(), before.data()));
    }
    TEST_CASE("what does not fit is refused by name") {
        four_rows const plan;
        auto const x0_src = random_stack<double, 3>({2, 4, 3}, 4);
        auto x0 = random_stack<double, 3>({3, 2, 2}, 5);
        auto const mix = [&](auto const& sources, double strength, double most_gain,
                             strided_view<std::uint8_t const, 2> shares) {
            mix_consensus(x0.view(), in_view<double, 3>(sources.view()), plan.rows<double>(), strength, most_gain,
                          shares);
        };
        CHECK_THROWS_WITH_AS(mix(x0_src, 1.5, 2, whole_cells(2, 2)),
                             "mix_consensus: strength is 1.500000, expected a share in [0, 1]", value_error);
        CHECK_THROWS_WITH_AS(mix(x0_src, 1, 0.5, whole_cells(2, 2)),
                             "mix_consensus: most_gain is 0.500000, expected a factor of at least 1", value_error);
        CHECK_THROWS_WITH_AS(mix(x0_src, 1, 2, whole_cells(1, 4)), "mix_consensus: shares is [1, 4], expected [2, 2]",
                             shape_error);
        CHECK_THROWS_WITH_AS(mix(random_stack<double, 3>({2, 4, 2}, 4), 1, 2, whole_cells(2, 2)),
                             "mix_consensus: x0_src is [2, 4, 2], expected [2, 4, 3]", shape_error);
        CHECK_THROWS_AS(mix(random_stack<double, 3>({1, 4, 3}, 4), 1, 2, whole_cells(2, 2)), value_error);
    }
}
