// SPDX-License-Identifier: MIT
// [GR eq. 1-6] Every law of attention calls can be broken, and is told by its sentence.
#include <genrender/testing/attention_call_laws.hpp>

#include "broken_laws.hpp"
#include "flawed_denoiser.hpp"

#include <genrender/testing/analytic_denoiser.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <string>
#include <vector>

TEST_SUITE("testing/attention_call_laws") {
    using namespace genrender;
    using namespace genrender::testing;

    namespace {

    bool breaks(flaw what, std::string const& law) {
        flawed_denoiser const phi{what};
        auto const report = check_attention_call_laws(phi, 1.5F);
        INFO(report.text());
        auto const laws = broken_laws(report);
        auto const is_told = std::find(laws.begin(), laws.end(), law) != laws.end();
        CHECK(is_told);
        return is_told;
    }

    } // namespace

    TEST_CASE("the calls of a denoiser written from the header alone keep the laws") {
        CHECK(check_attention_call_laws(second_engine::denoiser{}, 1.5F).text() == "");
        flawed_denoiser const stores{flaw::none};
        CHECK(check_attention_call_laws(stores, 1.5F, {.frames = {{3}, {0}, {8}, {1}}}).text() == "");
    }
    TEST_CASE_TEMPLATE("the call of features in host memory keeps the laws", Real, float, double) {
        analytic_denoiser<Real> const phi{.grid = {2, 3}, .attention = Real(0.7), .guidance_branches = 2};
        CHECK(check_attention_call_laws(phi, Real(1.5)).text() == "");
    }
    TEST_CASE("each flaw is told by the law that it breaks") {
        CHECK(
            breaks(flaw::adds_blocks_up, "attention_call: the weights of attend sum to 1 over all blocks of a frame"));
        CHECK(breaks(flaw::reads_the_first_block,
                     "attention_call: attend depends on the order of blocks by rounding alone"));
        std::string const kept = "attention_call: keys and values stay what they were after their call, and a block's "
                                 "frame counts in the stack that they are of";
        CHECK(breaks(flaw::reads_its_own_frame, kept));
        CHECK(breaks(flaw::reuses_memory_of_keys, kept));
        CHECK(breaks(flaw::projects_its_own_f, "attention_call: key and value take any stack f, of an ended call too"));
        CHECK(breaks(flaw::swaps_alpha, "attention_call: mix with alpha = 0 returns F_hat"));
        CHECK(breaks(flaw::clears_uncovered_rows, "attention_call: mix leaves rows that are not covered as they are"));
        std::string const sums = "attention_call: mix with alpha = 1 gives covered rows the weighted sums of rows of "
                                 "F_KF, read as [frames * tokens, channels], and F is what it was when its call ended";
        CHECK(breaks(flaw::reads_the_last_entry, sums));
        CHECK(breaks(flaw::reads_the_first_frame_of_F_KF, sums));
        CHECK(breaks(flaw::writes_into_F, sums));
        CHECK(
            breaks(flaw::keeps_too_much_of_F_hat, "attention_call: mix weighs F_bar by alpha and F_hat by 1 - alpha"));
        CHECK(breaks(flaw::joins_what_is_left_out,
                     "attention_call: attend gives by sources.pattern() what it gives by the lists"));
        CHECK(breaks(flaw::projects_keys_twice,
                     "projecting_attention_call: project gives what query, key and value give"));
        CHECK(breaks(flaw::stores_zeros, "storing_attention_call: feature_storage::same returns x"));
        CHECK(breaks(flaw::stores_what_is_infinite, "storing_attention_call: attend takes keys and values of 16 bits"));
    }
    TEST_CASE("a trial has at least two frames") {
        CHECK_THROWS_WITH_AS(check_attention_call_laws(second_engine::denoiser{}, 1.5F, {.frames = {}}),
                             "check_attention_call_laws: trial.frames.size() is 0, expected at least 2 frames",
                             value_error);
    }
}
