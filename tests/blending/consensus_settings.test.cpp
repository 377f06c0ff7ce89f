// SPDX-License-Identifier: MIT
// What a consensus is by default, and what is no consensus.
#include <genrender/blending/consensus_settings.hpp>

#include <doctest/doctest.h>

#include <cstddef>
#include <limits>
#include <string>

using namespace genrender;

TEST_SUITE("blending/consensus_settings") {
    namespace {

    /// What settings changed by `change` are refused with; empty if they are not.
    template <class Change>
    std::string refusal_of(Change const& change) {
        consensus_settings<double> settings;
        change(settings);
        try {
            require_consensus_settings("render", settings, 5);
        } catch (value_error const& error) {
            return error.what();
        }
        return "";
    }

    } // namespace

    TEST_CASE_TEMPLATE("defaults are what development scenes chose", Real, float, double) {
        consensus_settings<Real> const settings;
        CHECK(settings.enabled);
        CHECK(settings.window_begin == 0);
        CHECK(settings.window_end == Real(0.7));
        CHECK(settings.strength(7) == 1);
        CHECK(settings.sources.count == 16);
        CHECK(settings.sources.drawing == keyframe_drawing::stratified);
        CHECK(settings.first_fill_share == 0);
        CHECK(settings.average == texel_average::by_quality);
        CHECK(settings.quality.at(3, 10).are_plain());
        CHECK(settings.agrees_on_background);
        require_consensus_settings("render", settings, 50);
    }
    TEST_CASE("settings that no run could honour are refused by name") {
        CHECK(refusal_of([](auto&) {}).empty());
        CHECK(refusal_of([](auto& s) { s.window_end = 1.5; }) ==
              "render: settings.consensus.window_end is 1.500000, expected 0 <= window_begin <= window_end <= 1");
        CHECK(refusal_of([](auto& s) { s.window_begin = 0.8; }).find("window_end is 0.7") != std::string::npos);
        CHECK(!refusal_of([](auto& s) { s.window_begin = std::numeric_limits<double>::quiet_NaN(); }).empty());
        CHECK(refusal_of([](auto& s) { s.strength = nullptr; }) ==
              "render: settings.consensus.strength is empty, expected a function");
        CHECK(refusal_of([](auto& s) { s.strength = [](std::size_t step) { return step == 4 ? 1.25 : 1.0; }; }) ==
              "render: settings.consensus.strength is 1.250000, expected shares in [0, 1]");
        CHECK(refusal_of([](auto& s) { s.first_fill_share = -1; }).find("first_fill_share is -1") != std::string::npos);
        CHECK(refusal_of([](auto& s) { s.most_gain = 0.5; }) ==
              "render: settings.consensus.most_gain is 0.500000, expected a factor of at least 1");
        CHECK(refusal_of([](auto& s) { s.sources.count = 0; }) ==
              "render: settings.consensus.sources.count is 0, expected at least one frame");
        CHECK(refusal_of([](auto& s) { s.quality.exponent_end = -2; }) ==
              "render: settings.consensus.quality.exponent_end is -2.000000, expected a finite number, 0 or more");
    }
}
