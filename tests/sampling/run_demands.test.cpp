// SPDX-License-Identifier: MIT
// What a denoiser's calls cannot do is refused before a run, where their type is known.
#include <genrender/sampling/run_demands.hpp>

#include <genrender/testing/analytic_denoiser.hpp>

#include <doctest/doctest.h>

using namespace genrender;

TEST_SUITE("sampling/run_demands") {
    namespace {

    struct names_a_plain_call : testing::analytic_denoiser<double> {
        using call_type = attention_call_archetype<features_type, double>;
    };

    } // namespace

    TEST_CASE("calls that are known not to scale logits or keep variance are refused in a sentence") {
        run_shapes shapes;
        CHECK_NOTHROW(require_demands<names_a_plain_call>(shapes));
        shapes.scales_logits = true;
        CHECK_THROWS_WITH_AS(require_demands<names_a_plain_call>(shapes),
                             "render: settings.injection.length_correction is above 0, expected 0 for a denoiser whose "
                             "call_type has no `scales_logits`",
                             value_error);
        shapes.scales_logits = false;
        shapes.counts_keys = true;
        CHECK_THROWS_WITH_AS(require_demands<names_a_plain_call>(shapes),
                             "render: settings.injection.counts_points is true, expected false for a denoiser whose "
                             "call_type has no `counts_keys`",
                             value_error);
        shapes.counts_keys = false;
        shapes.keeps_variance = true;
        CHECK_THROWS_WITH_AS(require_demands<names_a_plain_call>(shapes),
                             "render: settings.injection.variance is to be kept, expected variance_target::none for a "
                             "denoiser whose call_type has no `mix_keeping_variance`",
                             value_error);
    }
    TEST_CASE("denoisers that name no call are asked later") {
        run_shapes shapes;
        shapes.scales_logits = shapes.keeps_variance = true;
        CHECK_NOTHROW(require_demands<testing::analytic_denoiser<double>>(shapes));
    }
}
