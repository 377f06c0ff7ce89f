// SPDX-License-Identifier: MIT
// [GR eq. 6] Rows of a fixed width.
#include <genrender/blending/padded_rows.hpp>

#include <genrender/blending/blend_plan.hpp>
#include <genrender/blending/mix_rows.hpp>
#include <genrender/correspondence/footprint_map.hpp>
#include <genrender/correspondence/texel_grid.hpp>
#include <genrender/testing/random_stack.hpp>

#include "../support/random_scene.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

using namespace genrender;

TEST_SUITE("blending/padded_rows") {
    namespace {

    /// Two frames of 3 tokens: rows of 2, 0 and 1 entries, and of 0, 3 and 1.
    template <class Real>
    struct two_plans {
        std::vector<std::uint32_t> offsets{0, 2, 2, 3};
        std::vector<std::uint32_t> sources{1, 5, 4};
        std::vector<Real> weights{Real(0.25), Real(0.75), 1};
        std::vector<std::uint32_t> other_offsets{0, 0, 3, 4};
        std::vector<std::uint32_t> other_sources{0, 2, 3, 5};
        std::vector<Real> other_weights{Real(0.5), Real(0.25), Real(0.25), 1};
        std::vector<sparse_rows<Real>> rows{{offsets, sources, weights}, {other_offsets, other_sources, other_weights}};
    };

    template <class Real>
    double difference_of_mixes(std::vector<sparse_rows<Real>> const& rows, std::size_t keyframes, Real alpha,
                               std::optional<std::size_t> width = {}) {
        auto const tokens = rows.front().row_count();
        std::size_t const channels = 3;
        auto const F_KF = testing::random_stack<Real, 3>({keyframes, tokens, channels}, 1);
        auto by_padded = testing::random_stack<Real, 3>({rows.size(), tokens, channels}, 2);
        auto by_rows = by_padded;
        auto padding = make_padded_rows(rows, alpha, width);
        mix_padded_rows(by_padded.view(), F_KF, padding.view());
        double worst = 0;
        for (std::size_t i = 0; i < rows.size(); ++i) {
            mix_rows(by_rows.view()[i], F_KF, rows[i], alpha);
        }
        for (std::size_t e = 0; e < by_rows.size(); ++e) {
            worst = std::max(worst, std::abs(static_cast<double>(by_rows.data()[e] - by_padded.data()[e])));
        }
        return worst;
    }

    } // namespace

    TEST_CASE_TEMPLATE("[GR eq. 6] rows by hand hold alpha, and nothing where they end", Real, float, double) {
        two_plans<Real> const plans;
        auto const rows = make_padded_rows(plans.rows, Real(0.5));
        CHECK(rows.frames == 2);
        CHECK(rows.tokens == 3);
        CHECK(rows.width == 3);
        CHECK(rows.index == std::vector<std::int32_t>{1, 5, 0, 0, 0, 0, 4, 0, 0, 0, 0, 0, 0, 2, 3, 5, 0, 0});
        CHECK(rows.weights == std::vector<Real>{Real(0.125), Real(0.375), 0, 0, 0, 0, Real(0.5), 0, 0, //
                                                0, 0, 0, Real(0.25), Real(0.125), Real(0.125), Real(0.5), 0, 0});
        CHECK(rows.own == std::vector<Real>{Real(0.5), 1, Real(0.5), 1, Real(0.5), Real(0.5)});
    }
    TEST_CASE("a wider row has more entries of weight 0 and mixes the same") {
        two_plans<double> const plans;
        auto const rows = make_padded_rows(plans.rows, 0.25, 5);
        CHECK(rows.width == 5);
        CHECK(std::count(rows.weights.begin(), rows.weights.end(), 0.0) == 2 * 3 * 5 - 7);
        CHECK(difference_of_mixes(plans.rows, 2, 0.25, 5) == difference_of_mixes(plans.rows, 2, 0.25));
    }
    TEST_CASE_TEMPLATE("[GR eq. 6] padded rows mix as mix_rows does, up to rounding", Real, float, double) {
        for (std::uint64_t seed = 0; seed < 4; ++seed) {
            auto const maps = testing::random_scene(seed, 5, {16, 16}, 3);
            footprint_map const footprints(to_uv_view(maps), {8, 8});
            texel_grid const texels(to_uv_view(maps), {8, 8}, {.T = 4, .reading = texel_reading::average});
            std::vector<frame_index> const KF{{3}, {0}, {4}};
            std::vector<blend_plan<Real>> plans;
            for (std::uint32_t i = 0; i < 5; ++i) {
                plans.push_back(make_blend_plan<Real>(footprints, KF, {i}));
                plans.push_back(make_blend_plan<Real>(texels, KF, {i}));
            }
            std::vector<sparse_rows<Real>> rows;
            for (auto const& plan : plans) {
                rows.push_back(plan.rows());
            }
            for (auto const alpha : {Real(0.7), Real(1), Real(0)}) {
                CHECK(difference_of_mixes(rows, 3, alpha) < (sizeof(Real) == 4 ? 2e-6 : 1e-14));
            }
        }
    }
    TEST_CASE("rows are written into memory of an engine, whatever its strides") {
        two_plans<float> const plans;
        auto expected = make_padded_rows(plans.rows, 0.7F);
        std::vector<std::int32_t> index(3 * 2 * 3, -1);
        std::vector<float> weights(3 * 2 * 3, -1);
        std::vector<float> own(2 * 4, -1);
        padded_rows_view<float> const out{{index.data(), {2, 3, 3}, {3, 1, 6}}, // entry by entry, as gathers take it
                                          {weights.data(), {2, 3, 3}, {3, 1, 6}},
                                          {own.data(), {2, 3}, {4, 1}}};
        write_padded_rows(out, plans.rows, 0.7F);
        auto const rows = expected.view();
        for (std::size_t i = 0; i < 2; ++i) {
            for (std::size_t t = 0; t < 3; ++t) {
                CHECK(out.own(i, t) == rows.own(i, t));
                for (std::size_t w = 0; w < 3; ++w) {
                    CHECK(index[w * 6 + i * 3 + t] == rows.index(i, t, w));
                    CHECK(out.weights(i, t, w) == rows.weights(i, t, w));
                }
            }
        }
        CHECK(own[3] == -1); // what lies between rows stays
    }
    TEST_CASE("a plan that covers nothing is of width 0, and no frames are none") {
        std::vector<std::uint32_t> const offsets(5, 0);
        sparse_rows<float> const nothing{offsets, {}, {}};
        CHECK(row_width(nothing) == 0);
        auto const rows = make_padded_rows(std::span(&nothing, 1), 0.7F);
        CHECK(rows.width == 0);
        CHECK(rows.own == std::vector<float>(4, 1.0F));
        CHECK(make_padded_rows(std::vector<sparse_rows<float>>{}, 0.7F).own.empty());
    }
    TEST_CASE("what does not fit is refused by name") {
        two_plans<double> plans;
        CHECK_THROWS_WITH_AS(make_padded_rows(plans.rows, 0.7, 2),
                             "write_padded_rows: rows[1] has a row of 3 entries, expected at most the width 2",
                             value_error);
        CHECK_THROWS_WITH_AS(make_padded_rows(plans.rows, std::numeric_limits<double>::quiet_NaN()),
                             "write_padded_rows: alpha is nan, expected a finite number", value_error);
        auto rows = make_padded_rows(plans.rows, 0.7);
        plans.rows.pop_back();
        CHECK_THROWS_WITH_AS(write_padded_rows(rows.view(), plans.rows, 0.7),
                             "write_padded_rows: index is [2, 3, 3], expected [1, 3, 3]", shape_error);
        plans.sources[2] = 0x80000000U;
        CHECK_THROWS_WITH_AS(make_padded_rows(plans.rows, 0.7),
                             "write_padded_rows: rows.sources is 2147483648, expected rows of features that an int32 "
                             "counts",
                             value_error);
        stack<double, 3> F({2, 3, 1});
        stack<double, 3> const F_KF({1, 3, 1});
        CHECK_THROWS_WITH_AS(mix_padded_rows(F.view(), F_KF, rows.view()),
                             "mix_padded_rows: index is 5, expected a row of the features' keyframes and tokens",
                             value_error);
        stack<double, 3> narrow({2, 2, 1});
        CHECK_THROWS_WITH_AS(mix_padded_rows(narrow.view(), F_KF, rows.view()),
                             "mix_padded_rows: index is [2, 3, 3], expected [2, 2, 3]", shape_error);
    }
}
