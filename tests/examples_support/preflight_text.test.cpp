// SPDX-License-Identifier: MIT
// The text lines up, says first what to do, and tells the unmeasured from zero.
#include <examples/support/preflight_text.hpp>

#include <genrender/maps/uv_maps.hpp>
#include <support/slanted_maps.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <vector>

TEST_SUITE("examples_support/preflight_text") {
    using namespace genrender;
    using namespace genrender::examples;

    TEST_CASE("sound maps are said to be as they should be") {
        auto const maps = testing::slanted_maps(6);
        auto const text = text_of(preflight(to_uv_view(maps), {{16, 16}}, render_settings<float>{}));
        CHECK(text.find("6 frames of 64x64 pixels, 1 objects, 2 canonical coordinates; 0.3 MB of maps\n") == 0);
        CHECK(text.find("\n  none: these maps are as they should be\n") != std::string::npos);
        CHECK(text.find("\n  16x16       4") != std::string::npos);
    }

    TEST_CASE("recommendations are the program's own words and refusals stand out") {
        auto maps =
            testing::changed_maps(2, [](float& u, float&, std::size_t, std::size_t) { u = std::round(u * 255) / 255; });
        maps.uv(1, 30, 30, 0) = std::numeric_limits<float>::quiet_NaN();
        auto const report = preflight(to_uv_view(maps), {{16, 16}, {7, 7}}, render_settings<float>{});
        auto const text =
            text_of(report, [](recommendation const& one) { return "advice: " + std::string(one.name()); });
        CHECK(text.find("\n  ! advice: not_finite\n") != std::string::npos);
        CHECK(text.find("\n  - advice: eight_bit\n") != std::string::npos);
        CHECK(text.find("by the keyframes of no step\n") != std::string::npos);
        CHECK(text.find("\n  7x7         -     refused\n") != std::string::npos);
        CHECK(text.find("8 bit, 0.4 px") != std::string::npos);
        CHECK(text.find("\nLevels of rounded coordinates\n  object 0, coordinate 0:") != std::string::npos);
    }

    TEST_CASE("what could not be measured is no zero") {
        auto const text = text_of(preflight(to_uv_view(uv_maps(2, {64, 64})), {{16, 16}}, render_settings<float>{}));
        CHECK(text.find("nothing is visible in frames 0-1") != std::string::npos);
        CHECK(text.find("\n  16x16       4           -             -         -           -         0\n") !=
              std::string::npos);
        CHECK(text.find("100.0        0  nothing visible") != std::string::npos);
        CHECK(text_of(preflight_report{}).find("0 frames") == 0);
    }
}
