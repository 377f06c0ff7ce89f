// SPDX-License-Identifier: MIT
// Tests of GroupNorm.
#include <genrender/models/group_norm.hpp>

#include "small_networks.hpp"

#include <doctest/doctest.h>

using namespace genrender;
using namespace genrender::testing;

TEST_SUITE("models/group_norm") {
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

    TEST_CASE("groups must divide the channels") {
        auto source = weights<float>::seeded(1, "test");
        CHECK_THROWS_WITH_AS((group_norm<float>(source, "norm", 6, 4, 1e-5f)),
                             "group_norm: groups is 4, expected a divisor of the channels", value_error);
    }
}
