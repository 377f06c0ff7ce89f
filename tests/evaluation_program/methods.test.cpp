// SPDX-License-Identifier: MIT
// The rows that are compared: names, presets and what they share.
#include <examples/evaluation/methods.hpp>

#include <doctest/doctest.h>

#include <cstddef>
#include <map>
#include <set>
#include <string>

using namespace genrender;
using namespace genrender::examples;

TEST_SUITE("evaluation_program/methods") {
    TEST_CASE("names are of one row each in a group, and every row renders by a preset") {
        std::set<std::string> names;
        std::map<std::string, std::size_t> rows;
        for (auto const& row : compared_rows()) {
            CHECK_MESSAGE(names.insert(row.group + ": " + row.name).second, row.name);
            CHECK((row.preset != nullptr));
            ++rows[row.group];
        }
        CHECK(rows["method"] == 11);
        CHECK(rows["ablation"] == 15);
        CHECK(painted_row().method == row_method::painted);
    }

    TEST_CASE("a row begins with its preset, takes what all share and then its own change") {
        shared_settings const shared{.steps = 7, .keyframes = 3, .sigma_min = 0.1F, .sigma_max = 9, .seed = 5};
        compared_row const row{"fewer", "ablation", row_method::generative_rendering, paper,
                               [](row_settings& x) { x.keyframes.count = 2; }};
        auto const settings = settings_of(row, shared);
        CHECK(settings.steps == 7);
        CHECK(settings.keyframes.count == 2);
        CHECK(settings.noise.seed == 5);
        CHECK(settings.keyframes.seed == 5);
        CHECK(settings.sigma_min == 0.1F);
        CHECK(settings.sigma_max == 9);
        CHECK(settings.normalization.statistics == adain_statistics::mean_and_deviation);
        CHECK(settings.correspondence.kind == correspondence_kind::texel_grid);
    }

    TEST_CASE(
        "baselines have the paper's noise or ours, and no normalisation; frames alone have nothing of the others") {
        CHECK(baseline_fixed().noise.kind == noise_kind::fixed);
        CHECK(baseline_uv().noise.kind == noise_kind::uv);
        CHECK(baseline_uv().noise.reading == vivid().noise.reading);
        CHECK_FALSE(baseline_uv().normalization.enabled);
        CHECK(alone().noise.kind == noise_kind::independent);
        CHECK(alone_uv().window_end == 0);
        CHECK(rows_of({"texels", "method"}).front().group == "method");
    }
}
