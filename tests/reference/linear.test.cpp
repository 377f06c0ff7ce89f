// SPDX-License-Identifier: MIT
// Tests of the fully connected layer.
#include <genrender/reference/linear.hpp>

#include "small_networks.hpp"

#include <doctest/doctest.h>

using namespace genrender;

using namespace genrender::reference;
using namespace genrender::testing;

TEST_SUITE("reference/linear") {
    TEST_CASE_TEMPLATE("a layer is in W^T + b", Real, float, double) {
        auto source = weights<Real>::seeded(1, "test");
        linear<Real> const layer(source, "fc", 7, 5);
        linear<Real> const without_bias(source, "fc", 7, 5, false);
        auto const in = random_stack<Real, 2>({11, 7}, 2);
        auto const weight = source.take("fc.weight", {5, 7});
        auto const bias = source.take("fc.bias", {5});
        stack<Real, 2> out({11, 5});
        layer(out.view(), in);
        check_close<Real, 2>(out.view(), plain_linear<Real>(in, weight, bias, 5));
        layer.add_to(out.view(), in);
        auto twice = plain_linear<Real>(in, weight, bias, 5);
        add_scaled(twice.view(), std::as_const(twice).view());
        check_close<Real, 2>(out.view(), twice);
        without_bias(out.view(), in);
        check_close<Real, 2>(out.view(), plain_linear<Real>(in, weight, {}, 5));
    }

    TEST_CASE_TEMPLATE("a 1x1 convolution is the same map of another shape", Real, float, double) {
        auto source = weights<Real>::seeded(1, "test");
        auto const layer = linear<Real>::of_1x1_convolution(source, "fc", 7, 5);
        auto const in = random_stack<Real, 2>({11, 7}, 2);
        stack<Real, 2> out({11, 5});
        layer(out.view(), in);
        auto const weight = source.take("fc.weight", {5, 7, 1, 1});
        check_close<Real, 2>(out.view(), plain_linear<Real>(in, weight, source.take("fc.bias", {5}), 5));
    }

    TEST_CASE("extents that do not fit are refused") {
        auto source = weights<float>::seeded(1, "test");
        linear<float> const layer(source, "fc", 3, 2);
        stack<float, 2> in({4, 3});
        stack<float, 2> out({4, 3});
        CHECK_THROWS_WITH_AS(layer(out.view(), in), "linear: out is [4, 3], expected [4, 2]", shape_error);
        CHECK_THROWS_WITH_AS(layer(out.view(), stack<float, 2>({4, 2})), "linear: in is [4, 2], expected [4, 3]",
                             shape_error);
    }
}
