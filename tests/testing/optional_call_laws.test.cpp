// SPDX-License-Identifier: MIT
// The laws of scales and of kept variance can be broken, and are told by their sentences.
#include <genrender/testing/optional_call_laws.hpp>

#include "broken_laws.hpp"
#include "flawed_denoiser.hpp"

#include <genrender/testing/attention_call_laws.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <string>

TEST_SUITE("testing/optional_call_laws") {
    using namespace genrender;
    using namespace genrender::testing;

    TEST_CASE("each flaw of a call that scales logits or keeps variance is told by the law that it breaks") {
        auto const breaks = [](flaw what, std::string const& law) {
            auto const report = check_attention_call_laws(flawed_denoiser{what}, 1.5F);
            INFO(report.text());
            auto const laws = broken_laws(report);
            auto const is_told = std::find(laws.begin(), laws.end(), law) != laws.end();
            CHECK(is_told);
            return is_told;
        };
        CHECK(breaks(flaw::ignores_scales, "scaling_attention_call: attend multiplies logits by sources.scale(i)"));
        CHECK(breaks(flaw::scales_by_pattern_alone,
                     "scaling_attention_call: scales hold by sources.pattern() as by the lists"));
        CHECK(
            breaks(flaw::keeps_variance_unasked, "variance_keeping_call: variance_target::none gives what mix gives"));
        CHECK(
            breaks(flaw::keeps_variance_without_bound, "variance_keeping_call: a most_gain of 1 gives what mix gives"));
        CHECK(breaks(flaw::rescales_uncovered_rows,
                     "variance_keeping_call: rows that are not covered are those of F_hat"));
    }
}
