// SPDX-License-Identifier: MIT
// Classifier-free guidance of clean estimates.
#include <genrender/sampling/classifier_free_guidance.hpp>

#include <doctest/doctest.h>

#include <genrender/core/stack.hpp>
#include <genrender/sampling/preconditioning.hpp>

#include <array>
#include <cmath>
#include <initializer_list>
#include <limits>

using namespace genrender;

namespace {

template <class Real>
stack<Real, 4> row_of(std::initializer_list<Real> values) {
    stack<Real, 4> row({1, 1, 1, values.size()});
    std::size_t i = 0;
    for (auto const value : values) {
        row.data()[i++] = value;
    }
    return row;
}

} // namespace

TEST_SUITE("sampling/classifier_free_guidance") {
    TEST_CASE_TEMPLATE("guidance goes scale times the way from unconditional to conditional", Real, float, double) {
        auto const uncond = row_of<Real>({1, 2, -4});
        auto const cond = row_of<Real>({3, 2, -5});
        stack<Real, 4> out({1, 1, 1, 3});
        guide(out.view(), uncond, cond, Real(7.5));
        CHECK(out(0, 0, 0, 0) == Real(16));
        CHECK(out(0, 0, 0, 1) == Real(2));
        CHECK(out(0, 0, 0, 2) == Real(-11.5));
    }

    TEST_CASE_TEMPLATE("scale 0 is the unconditional and scale 1 the conditional estimate", Real, float, double) {
        auto const uncond = row_of<Real>({Real(1.5), Real(-2)});
        auto const cond = row_of<Real>({Real(0.25), Real(8)});
        stack<Real, 4> out({1, 1, 1, 2});
        guide(out.view(), uncond, cond, Real(0));
        CHECK(out(0, 0, 0, 0) == Real(1.5));
        CHECK(out(0, 0, 0, 1) == Real(-2));
        guide(out.view(), uncond, cond, Real(1));
        CHECK(out(0, 0, 0, 0) == Real(0.25));
        CHECK(out(0, 0, 0, 1) == Real(8));
    }

    TEST_CASE("guiding clean estimates and guiding outputs of the network come to the same") {
        auto const z = row_of({1.5, -3.0});
        auto const F_uncond = row_of({0.5, 0.25});
        auto const F_cond = row_of({-1.0, 0.75});
        stack<double, 4> x0_uncond(z.extents());
        stack<double, 4> x0_cond(z.extents());
        stack<double, 4> F(z.extents());
        stack<double, 4> guided(z.extents());
        stack<double, 4> expected(z.extents());
        for (auto const predicted : {prediction::epsilon, prediction::velocity, prediction::clean, prediction::flow}) {
            to_clean(x0_uncond.view(), predicted, z, F_uncond, 2.0);
            to_clean(x0_cond.view(), predicted, z, F_cond, 2.0);
            guide(guided.view(), x0_uncond, x0_cond, 7.5);
            guide(F.view(), F_uncond, F_cond, 7.5);
            to_clean(expected.view(), predicted, z, F, 2.0);
            CHECK(std::abs(guided(0, 0, 0, 0) - expected(0, 0, 0, 0)) < 1e-13);
            CHECK(std::abs(guided(0, 0, 0, 1) - expected(0, 0, 0, 1)) < 1e-13);
        }
    }

    TEST_CASE("the two branches of one stack are guided into the first of them") {
        stack<float, 4> branches({2, 1, 1, 2});
        branches(0, 0, 0, 0) = 1;
        branches(0, 0, 0, 1) = 2;
        branches(1, 0, 0, 0) = 3;
        branches(1, 0, 0, 1) = 5;
        auto const uncond = branches.view().slice(0, 1);
        guide(uncond, uncond, branches.view().slice(1, 1), 2.0F);
        CHECK(branches(0, 0, 0, 0) == 5.0F);
        CHECK(branches(0, 0, 0, 1) == 8.0F);
        CHECK(branches(1, 0, 0, 0) == 3.0F);
        CHECK(branches(1, 0, 0, 1) == 5.0F);
    }

    TEST_CASE("wrong shapes and impossible scales are refused") {
        stack<double, 4> out({2, 1, 1, 2});
        stack<double, 4> const other({1, 1, 1, 2});
        CHECK_THROWS_WITH_AS(guide(out.view(), other, out, 1.0),
                             "guide: x0_uncond is [1, 1, 1, 2], expected [2, 1, 1, 2]", shape_error);
        CHECK_THROWS_WITH_AS(guide(out.view(), out, other, 1.0),
                             "guide: x0_cond is [1, 1, 1, 2], expected [2, 1, 1, 2]", shape_error);
        CHECK_THROWS_WITH_AS(guide(out.view(), out, out, std::numeric_limits<double>::quiet_NaN()),
                             "guide: scale is nan, expected a finite number", value_error);
    }

    TEST_CASE_TEMPLATE("rescaled guidance has the conditional deviation at share 1 and half the way at a half", Real,
                       float, double) {
        stack<Real, 4> F({2, 1, 1, 4});
        stack<Real, 4> F_cond({2, 1, 1, 4});
        for (std::size_t e = 0; e < 4; ++e) {
            F(0, 0, 0, e) = Real(10) * static_cast<Real>(e); // deviation 12.909...
            F(1, 0, 0, e) = 7;                               // none
            F_cond(0, 0, 0, e) = static_cast<Real>(3 + e);   // a tenth of the first
            F_cond(1, 0, 0, e) = static_cast<Real>(e);
        }
        auto whole = F;
        rescale_guidance(whole.view(), F_cond, Real(1));
        auto half = F;
        rescale_guidance(half.view(), F_cond, Real(0.5));
        auto none = F;
        rescale_guidance(none.view(), F_cond, Real(0));
        for (std::size_t e = 0; e < 4; ++e) {
            CHECK(whole(0, 0, 0, e) == doctest::Approx(static_cast<double>(e)));
            CHECK(half(0, 0, 0, e) == doctest::Approx(5.5 * static_cast<double>(e)));
            CHECK(none(0, 0, 0, e) == F(0, 0, 0, e));
            CHECK(whole(1, 0, 0, e) == 7); // A frame without deviation stays.
        }
        CHECK_THROWS_WITH_AS(rescale_guidance(F.view(), F_cond, Real(1.5)),
                             "rescale_guidance: share is 1.500000, expected a number in [0, 1]", value_error);
        stack<Real, 4> other({2, 1, 1, 3});
        CHECK_THROWS_WITH_AS(rescale_guidance(F.view(), other, Real(1)),
                             "rescale_guidance: F_cond is [2, 1, 1, 3], expected [2, 1, 1, 4]", shape_error);
    }
}
