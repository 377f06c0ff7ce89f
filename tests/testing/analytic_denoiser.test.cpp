// SPDX-License-Identifier: MIT
// The denoiser of known answer gives the answer.
#include <genrender/testing/analytic_denoiser.hpp>

#include <genrender/attention/plain_attention.hpp>
#include <genrender/core/stack.hpp>

#include <doctest/doctest.h>

#include <array>

TEST_SUITE("testing/analytic_denoiser") {
    using namespace genrender;
    using testing::analytic_denoiser;

    TEST_CASE_TEMPLATE("its estimate is the posterior mean, and attention to one token changes nothing", Real, float,
                       double) {
        for (auto const attention : {Real(0), Real(0.5)}) {
            analytic_denoiser<Real> const phi{
                .grid = {1, 1}, .channels = 1, .mean = Real(0.5), .spread = Real(0.25), .attention = attention};
            stack<Real, 4> z({1, 1, 1, 1});
            z(0, 0, 0, 0) = Real(1.5);
            stack<Real, 4> x0({1, 1, 1, 1});
            plain_attention const plain;
            phi(x0.view(), z.view(), Real(0.5), std::array{frame_index{0}}, plain);
            CHECK(x0(0, 0, 0, 0) == doctest::Approx(0.5 + 0.0625 / (0.0625 + 0.25) * (1.5 - 0.5)));
        }
    }
    TEST_CASE("projections of the identity leave features as they are") {
        stack<double, 2> f({2, 2});
        f(1, 0) = 3;
        stack<double, 2> out({2, 2});
        testing::identity_projections const module;
        module.query(out.view(), in_view<double, 2>(f.view()));
        CHECK(out(1, 0) == 3);
        out(1, 0) = 0;
        module.key(out.view(), in_view<double, 2>(f.view()));
        CHECK(out(1, 0) == 3);
        out(1, 0) = 0;
        module.value(out.view(), in_view<double, 2>(f.view()));
        CHECK(out(1, 0) == 3);
        CHECK(module.heads() == 1);
    }
}
