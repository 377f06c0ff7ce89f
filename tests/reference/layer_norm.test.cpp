// SPDX-License-Identifier: MIT
// Tests of LayerNorm.
#include <genrender/reference/layer_norm.hpp>

#include "small_networks.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <cstddef>

using namespace genrender;

using namespace genrender::reference;
using namespace genrender::testing;

TEST_SUITE("reference/layer_norm") {
    TEST_CASE_TEMPLATE("each token has mean 0 and variance 1 before scale and shift", Real, float, double) {
        auto source = weights<Real>::seeded(1, "test"); // its scales are 1
        layer_norm<Real> const norm(source, "norm", 40);
        auto const bias = source.take("norm.bias", {40});
        auto const in = random_stack<Real, 2>({5, 40}, 3);
        stack<Real, 2> out({5, 40});
        norm(out.view(), in);
        for (std::size_t token = 0; token < 5; ++token) {
            double sum = 0;
            double squares = 0;
            for (std::size_t c = 0; c < 40; ++c) {
                auto const value = static_cast<double>(out(token, c) - bias[c]);
                sum += value;
                squares += value * value;
            }
            CHECK(std::abs(sum / 40) < 1e-5);
            CHECK(squares / 40 == doctest::Approx(1).epsilon(1e-3));
        }
    }

    TEST_CASE_TEMPLATE("every number of channels agrees with the definition and in place too", Real, float, double) {
        for (std::size_t const channels : {1U, 3U, 8U, 17U, 33U, 56U}) {
            auto source = weights<Real>::seeded(1, "test");
            layer_norm<Real> const norm(source, "norm", channels);
            auto const bias = source.take("norm.bias", {channels});
            auto values = random_stack<Real, 2>({3, channels}, 3);
            stack<Real, 2> expected(values.extents());
            for (std::size_t token = 0; token < 3; ++token) {
                double mean = 0;
                double variance = 0;
                for (std::size_t c = 0; c < channels; ++c) {
                    mean += static_cast<double>(values(token, c)) / static_cast<double>(channels);
                }
                for (std::size_t c = 0; c < channels; ++c) {
                    auto const rest = static_cast<double>(values(token, c)) - mean;
                    variance += rest * rest / static_cast<double>(channels);
                }
                for (std::size_t c = 0; c < channels; ++c) {
                    expected(token, c) =
                        static_cast<Real>((static_cast<double>(values(token, c)) - mean) / std::sqrt(variance + 1e-5)) +
                        bias[c];
                }
            }
            norm(values.view(), values);
            check_close<Real, 2>(values.view(), expected);
        }
    }

    TEST_CASE_TEMPLATE("a worked example", Real, float, double) {
        auto source = weights<Real>::seeded(1, "test");
        layer_norm<Real> const norm(source, "norm", 2, Real(3));
        auto const bias = source.take("norm.bias", {2});
        stack<Real, 2> values({1, 2});
        values(0, 0) = 5;
        values(0, 1) = 3;
        // Mean 4 and variance 1, to which epsilon = 3 is added.
        norm(values.view(), values);
        CHECK(static_cast<double>(values(0, 0) - bias[0]) == doctest::Approx(0.5));
        CHECK(static_cast<double>(values(0, 1) - bias[1]) == doctest::Approx(-0.5));
    }
}
