// SPDX-License-Identifier: MIT
// [GR eq. 6] The plans of a call as one list.
#include <genrender/blending/call_rows.hpp>

#include <genrender/blending/mix_rows.hpp>
#include <genrender/testing/random_stack.hpp>

#include <doctest/doctest.h>

#include <cstddef>
#include <limits>
#include <vector>

using namespace genrender;

TEST_SUITE("blending/call_rows") {
    TEST_CASE_TEMPLATE("[GR eq. 6] one list gives what the plans of the frames give", Real, float, double) {
        std::vector<std::uint32_t> const offsets{0, 2, 2, 3};
        std::vector<std::uint32_t> const sources{1, 5, 4};
        std::vector<Real> const weights{Real(0.25), Real(0.75), 1};
        std::vector<std::uint32_t> const no_offsets(4, 0);
        std::vector<sparse_rows<Real>> const plans{
            {offsets, sources, weights}, {no_offsets, {}, {}}, {offsets, sources, weights}};
        auto const rows = make_call_rows(plans, Real(0.5));
        CHECK(rows.offsets == std::vector<std::int32_t>{0, 2, 2, 3, 3, 3, 3, 5, 5, 6});
        CHECK(rows.index == std::vector<std::int32_t>{1, 5, 4, 1, 5, 4});
        CHECK(rows.weights[1] == Real(0.375));
        CHECK(rows.own == std::vector<Real>{Real(0.5), 1, Real(0.5), 1, 1, 1, Real(0.5), 1, Real(0.5)});

        auto const F_KF = testing::random_stack<Real, 3>({2, 3, 4}, 1);
        auto F = testing::random_stack<Real, 3>({3, 3, 4}, 2);
        auto const F_hat = F;
        for (std::size_t i = 0; i < 3; ++i) {
            mix_rows(F.view()[i], F_KF, plans[i], Real(0.5));
        }
        for (std::size_t r = 0; r < 9; ++r) {
            for (std::size_t c = 0; c < 4; ++c) {
                auto sum = rows.own[r] * F_hat.data()[r * 4 + c];
                for (auto e = rows.offsets[r]; e < rows.offsets[r + 1]; ++e) {
                    auto const entry = static_cast<std::size_t>(e);
                    sum += rows.weights[entry] * F_KF.data()[static_cast<std::size_t>(rows.index[entry]) * 4 + c];
                }
                CHECK(F.data()[r * 4 + c] == doctest::Approx(sum).epsilon(1e-6));
            }
        }
    }
    TEST_CASE("what an int32 does not count, or is no number, is refused by name") {
        std::vector<std::uint32_t> const offsets{0, 1};
        std::vector<std::uint32_t> const sources{0xFFFFFFFFU};
        std::vector<double> const weights{1};
        std::vector<sparse_rows<double>> const plans{{offsets, sources, weights}};
        CHECK_THROWS_WITH_AS(
            make_call_rows(plans, 0.5),
            "make_call_rows: rows.sources is 4294967295, expected rows of features that an int32 counts", value_error);
        CHECK_THROWS_WITH_AS(make_call_rows(plans, std::numeric_limits<double>::infinity()),
                             "make_call_rows: alpha is inf, expected a finite number", value_error);
    }
}
