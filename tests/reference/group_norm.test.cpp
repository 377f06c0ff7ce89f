// SPDX-License-Identifier: MIT
// Tests of GroupNorm.
#include <genrender/reference/group_norm.hpp>

#include "small_networks.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <type_traits>
#include <utility>

using namespace genrender;

using namespace genrender::reference;
using namespace genrender::testing;

TEST_SUITE("reference/group_norm") {
    TEST_CASE_TEMPLATE("each group has mean 0 and variance 1 before scale and shift", Real, float, double) {
        auto source = weights<Real>::seeded(1, "test"); // its scales are 1
        group_norm<Real> const norm(source, "norm", 6, 2, Real(1e-5));
        auto const bias = source.take("norm.bias", {6});
        auto in = random_stack<Real, 2>({50, 6}, 3);
        for (std::size_t e = 0; e < in.size(); ++e) {
            in.data()[e] =
                in.data()[e] * (e % 6 < 3 ? Real(4) : Real(0.5)) + 10; // far from 0, groups of different spread
        }
        stack<Real, 2> out({50, 6});
        norm(out.view(), in);
        for (std::size_t group = 0; group < 2; ++group) {
            double sum = 0;
            double squares = 0;
            for (std::size_t token = 0; token < 50; ++token) {
                for (std::size_t c = 3 * group; c < 3 * group + 3; ++c) {
                    auto const value = static_cast<double>(out(token, c) - bias[c]);
                    sum += value;
                    squares += value * value;
                }
            }
            CHECK(std::abs(sum / 150) < 1e-5);
            CHECK(squares / 150 == doctest::Approx(1).epsilon(1e-3));
        }
        norm(in.view(), in); // in place
        check_close<Real, 2>(in.view(), out);
    }

    TEST_CASE_TEMPLATE("a worked example", Real, float, double) {
        auto source = weights<Real>::seeded(1, "test");
        group_norm<Real> const norm(source, "norm", 2, 1, Real(1));
        auto const bias = source.take("norm.bias", {2});
        stack<Real, 2> values({1, 2});
        values(0, 0) = 3;
        values(0, 1) = 1;
        // Mean 2 and variance 1, to which epsilon = 1 is added.
        norm(values.view(), values);
        CHECK(static_cast<double>(values(0, 0) - bias[0]) == doctest::Approx(1 / std::sqrt(2.0)));
        CHECK(static_cast<double>(values(0, 1) - bias[1]) == doctest::Approx(-1 / std::sqrt(2.0)));
    }

    TEST_CASE_TEMPLATE("every number of channels and tokens agrees with the definition", Real, float, double) {
        for (std::size_t const channels : {1U, 2U, 8U, 24U, 40U, 56U}) {
            for (std::size_t const tokens : {1U, 6U, 300U}) {
                auto const groups = channels % 8 == 0 ? std::size_t{8} : std::size_t{1};
                auto source = weights<Real>::seeded(1, "test");
                group_norm<Real> const norm(source, "norm", channels, groups, Real(1e-5));
                auto const bias = source.take("norm.bias", {channels});
                auto const in = random_stack<Real, 2>({tokens, channels}, 3);
                auto const size = channels / groups;
                stack<Real, 2> expected(in.extents());
                for (std::size_t first = 0; first < channels; first += size) {
                    auto const mean_of = [&](auto f) {
                        double sum = 0;
                        for (std::size_t token = 0; token < tokens; ++token) {
                            for (std::size_t c = first; c < first + size; ++c) {
                                sum += f(static_cast<double>(in(token, c)));
                            }
                        }
                        return sum / static_cast<double>(size * tokens);
                    };
                    auto const mean = mean_of([](double x) { return x; });
                    auto const variance = mean_of([&](double x) { return (x - mean) * (x - mean); });
                    for (std::size_t token = 0; token < tokens; ++token) {
                        for (std::size_t c = first; c < first + size; ++c) {
                            expected(token, c) = static_cast<Real>((static_cast<double>(in(token, c)) - mean) /
                                                                   std::sqrt(variance + 1e-5)) +
                                                 bias[c];
                        }
                    }
                }
                stack<Real, 2> out(in.extents());
                norm(out.view(), in);
                check_close<Real, 2>(out.view(), expected);

                // With SiLU, into the ring of a convolution.
                grid_extents const grid{tokens / (tokens > 1 ? 3 : 1), tokens > 1 ? 3U : 1U};
                padded_map<Real> map(grid, channels);
                norm.with_silu(map, in);
                for (std::size_t token = 0; token < tokens; ++token) {
                    for (std::size_t c = 0; c < channels; ++c) {
                        auto const x = static_cast<double>(expected(token, c));
                        auto const found = map.row(token / grid.width)[token % grid.width * channels + c];
                        REQUIRE(std::abs(static_cast<double>(found) - x / (1 + std::exp(-x))) <= tolerance<Real>());
                    }
                }
                CHECK(map.corner()[0] == 0);
                CHECK(map.row(0)[grid.width * channels] == 0);
            }
        }
    }

    TEST_CASE_TEMPLATE("a mean far above the spread costs no accuracy", Real, float, double) {
        auto source = weights<Real>::seeded(1, "test");
        group_norm<Real> const norm(source, "norm", 16, 1, Real(0));
        auto const bias = source.take("norm.bias", {16});
        stack<Real, 2> in({64, 16});
        for (std::size_t e = 0; e < in.size(); ++e) {
            in.data()[e] = 65536 + Real(e / 16 % 2); // one half each, whose spread is a half
        }
        norm(in.view(), in);
        for (std::size_t e = 0; e < in.size(); ++e) {
            auto const found = static_cast<double>(in.data()[e] - bias[e % 16]);
            CHECK(found ==
                  doctest::Approx(e / 16 % 2 == 0 ? -1.0 : 1.0).epsilon(std::is_same_v<Real, float> ? 0.02 : 1e-9));
        }
    }

    TEST_CASE_TEMPLATE("the result is the same to the bit on any number of threads", Real, float, double) {
        auto source = weights<Real>::seeded(1, "test");
        group_norm<Real> const norm(source, "norm", 80, 8, Real(1e-5));
        auto const in = random_stack<Real, 2>({600, 80}, 3);
        stack<Real, 2> alone(in.extents());
        stack<Real, 2> shared(in.extents());
        norm(alone.view(), in);
        norm(shared.view(), in, threaded_loop(3));
        CHECK(std::equal(alone.data(), alone.data() + alone.size(), shared.data()));
        padded_map<Real> map_alone({30, 20}, 80);
        padded_map<Real> map_shared({30, 20}, 80);
        norm.with_silu(map_alone, in);
        norm.with_silu(map_shared, in, threaded_loop(3));
        CHECK(std::equal(map_alone.corner(), std::as_const(map_alone).row(29) + 20 * 80, map_shared.corner()));
    }

    TEST_CASE_TEMPLATE("some tokens under the line of all are those of the whole to the bit", Real, float, double) {
        auto source = weights<Real>::seeded(1, "test");
        group_norm<Real> const norm(source, "norm", 24, 8, Real(1e-5));
        CHECK(norm.channels() == 24);
        auto const in = random_stack<Real, 2>({30, 24}, 3);
        padded_map<Real> map({5, 6}, 24);
        norm.with_silu(map, in);
        auto const line = norm.line_of(in);
        stack<Real, 2> row({6, 24});
        norm.apply_silu(row.view(), in.view().slice(12, 6), line);
        CHECK(std::equal(row.data(), row.data() + row.size(), std::as_const(map).row(2)));
        stack<Real, 2> narrow({6, 20});
        CHECK_THROWS_WITH_AS(norm.apply_silu(row.view(), narrow, line), "group_norm: in is [6, 20], expected [6, 24]",
                             shape_error);
    }

    TEST_CASE("groups must divide the channels") {
        auto source = weights<float>::seeded(1, "test");
        CHECK_THROWS_WITH_AS((group_norm<float>(source, "norm", 6, 4, 1e-5f)),
                             "group_norm: groups is 4, expected a divisor of the channels", value_error);
    }
}
