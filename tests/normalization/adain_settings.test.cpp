// SPDX-License-Identifier: MIT
// Means of the first frame by default, and settings that say nothing.
#include <genrender/normalization/adain_settings.hpp>

#include <doctest/doctest.h>

#include <limits>

using namespace genrender;

TEST_SUITE("normalization/adain_settings") {
    TEST_CASE_TEMPLATE(
        "a run that normalises has the first frame's means by default, and the paper's form is one setting away", Real,
        float, double) {
        adain_settings<Real> settings;
        CHECK(!settings.enabled);
        CHECK(settings.statistics == adain_statistics::mean);
        CHECK(settings.target == adain_target::first_frame);
        CHECK(settings.least_pixels == 2);
        CHECK(settings.fallback == without_background::skip);
        require_adain_settings("normalize_latents", settings);
        settings.statistics = adain_statistics::mean_and_deviation; // all else is the paper's already
        require_adain_settings("normalize_latents", settings);
    }
    TEST_CASE("settings that no run could honour are refused by name") {
        auto const refuses = [](auto const& change, char const* sentence) {
            adain_settings<double> settings;
            change(settings);
            CHECK_THROWS_WITH_AS(require_adain_settings("render", settings), sentence, value_error);
        };
        refuses([](auto& s) { s.enough_background = 2; },
                "render: settings.enough_background is 2.000000, expected a share in [0, 1]");
        refuses([](auto& s) { s.standard_errors = -1; },
                "render: settings.standard_errors is -1.000000, expected a number of at least 0");
        refuses([](auto& s) { s.most_gain = 0.9; },
                "render: settings.most_gain is 0.900000, expected a factor of at least 1");
        refuses([](auto& s) { s.band_levels = 0; }, "render: settings.band_levels is 0, expected 1 to 12");
        refuses([](auto& s) { s.band_levels = 13; }, "render: settings.band_levels is 13, expected 1 to 12");
        adain_settings<double> settings;
        settings.most_gain = std::numeric_limits<double>::quiet_NaN();
        CHECK_THROWS_AS(require_adain_settings("render", settings), value_error);
    }
}
