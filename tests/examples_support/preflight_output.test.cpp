// SPDX-License-Identifier: MIT
// The three files hold what the report holds, and the picture shows each defect in its colour where it is.
#include <examples/support/preflight_output.hpp>

#include "../support/scratch_folder.hpp"

#include <genrender/maps/uv_maps.hpp>
#include <support/slanted_maps.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>
#include <string>

namespace preflight_output_test {

using namespace genrender;
using namespace genrender::examples;

inline std::string contents(std::filesystem::path const& path) {
    std::ostringstream text;
    text << std::ifstream(path, std::ios::binary).rdbuf();
    return text.str();
}

/// The picture of maps of 64 x 64 pixels: frames 4 times enlarged, 4 pixels between them.
inline rgb8_image picture_of(uv_maps const& maps) {
    auto const view = to_uv_view(maps);
    return preflight_picture(view, preflight(view, {{16, 16}}, render_settings<float>{}));
}
/// The colour of a map pixel of frame 0 in a column of the sheet.
inline rgb8 shown(rgb8_image const& sheet, std::size_t column_of_sheet, std::size_t row, std::size_t column) {
    return sheet.at(4 + 4 * row + 1, 4 + 260 * column_of_sheet + 4 * column + 1);
}

} // namespace preflight_output_test

TEST_SUITE("examples_support/preflight_output") {
    using namespace genrender;
    using namespace genrender::examples;
    using namespace preflight_output_test;
    using genrender::testing::changed_maps;
    using genrender::testing::slanted_maps;

    TEST_CASE("text and JSON and picture are written and say the program's advice") {
        tests::scratch_folder const folder;
        auto const maps = changed_maps(6, [](float& u, float& v, std::size_t row, std::size_t column) {
            u = 0.13F + 0.0091F * std::abs(static_cast<float>(column) - 31.5F);
            v = 0.19F + 0.0093F * static_cast<float>(row);
        });
        auto const report = write_preflight(
            folder / "out", to_uv_view(maps), {{16, 16}, {7, 7}}, render_settings<float>{}, sequential_loop{},
            [](recommendation const& one) { return sentence_of(one) + " (with an option)"; });
        CHECK_FALSE(report.allows_run());
        CHECK(contents(folder / "out/preflight.txt").find("with an option") != std::string::npos);
        auto const json = nlohmann::json::parse(contents(folder / "out/preflight.json"));
        CHECK(json["allows_run"] == false);
        CHECK(json["objects"][0]["mirrored"] == 1.0);
        CHECK(json["objects"][0]["overlapping"] == 0.0);
        CHECK(json["grids"][0]["grid"] == nlohmann::json({16, 16}));
        CHECK(json["grids"][0]["refusal"].is_null());
        CHECK(json["grids"][0]["hit_rate"].is_number());
        CHECK(json["grids"][1]["refusal"].is_string());
        CHECK(json["grids"][1]["hit_rate"].is_null());
        CHECK(json["frame_contents"].size() == 6);
        auto const is_mirrored = [](nlohmann::json const& one) { return one["kind"] == "mirrored"; };
        auto const found = std::find_if(json["recommendations"].begin(), json["recommendations"].end(), is_mirrored);
        REQUIRE(found != json["recommendations"].end());
        CHECK((*found)["object"] == 0);
        CHECK(read_png(folder / "out/preflight.png").width == 3 * 260 + 4);
    }

    TEST_CASE("each defect has its colour where it is") {
        auto const sound = picture_of(slanted_maps(6));
        CHECK(shown(sound, 1, 30, 10) == examples::detail::sound_colour);
        CHECK(shown(sound, 1, 30, 4) == examples::detail::sound_colour);
        CHECK(shown(sound, 1, 1, 1) == examples::detail::empty_colour);
        CHECK(shown(sound, 0, 30, 10) != shown(sound, 0, 50, 40));

        auto const overlapping =
            picture_of(changed_maps(6, [](float& u, float& v, std::size_t row, std::size_t column) {
                u = 0.13F + 0.0091F * static_cast<float>(column < 32 ? column : column - 28);
                v = 0.19F + 0.0093F * static_cast<float>(row);
            }));
        CHECK(shown(overlapping, 1, 30, 10) == examples::detail::overlap_colour);
        CHECK(shown(overlapping, 1, 30, 31) == examples::detail::seam_colour);

        auto maps = changed_maps(6, [](float& u, float& v, std::size_t, std::size_t column) {
            u *= column == 4 ? 0.6F : 1;
            v *= column == 4 ? 0.6F : 1;
        });
        maps.uv(0, 40, 40, 0) = std::numeric_limits<float>::quiet_NaN();
        auto const broken = picture_of(maps);
        CHECK(shown(broken, 1, 30, 4) == examples::detail::blended_colour);
        CHECK(shown(broken, 1, 40, 40) == examples::detail::not_finite_colour);
        CHECK(shown(broken, 0, 40, 40) == examples::detail::not_finite_colour);
    }

    TEST_CASE("tokens are green where keyframes cover them and orange where not") {
        auto maps = slanted_maps(2);
        genrender::testing::visit_slanted(
            maps, [&](std::size_t row, std::size_t column) { maps.uv(1, row, column, 0) += column < 32 ? 0 : 0.35F; });
        render_settings<float> settings;
        settings.keyframes.drawing = keyframe_drawing::fixed;
        settings.keyframes.frames = {{1}};
        auto const view = to_uv_view(maps);
        auto const sheet = preflight_picture(view, preflight(view, {{16, 16}}, settings));
        CHECK(shown(sheet, 2, 30, 16) == examples::detail::covered_colour);
        CHECK(shown(sheet, 2, 30, 46) == examples::detail::uncovered_colour);
        CHECK(shown(sheet, 2, 1, 1) == examples::detail::empty_colour);
    }

    TEST_CASE("maps that show nothing or have no pixels or no grids have a picture") {
        tests::scratch_folder const folder;
        CHECK(picture_of(uv_maps(2, {64, 64})).width == 3 * 260 + 4);
        auto const none = uv_maps(0, {64, 64});
        write_preflight(folder.path(), to_uv_view(none), {{16, 16}}, render_settings<float>{}, sequential_loop{});
        CHECK(read_png(folder / "preflight.png").width == 256);
        auto const flat = slanted_maps(1);
        write_preflight(folder.path(), to_uv_view(flat), {}, render_settings<float>{}, sequential_loop{});
        CHECK(folder.entries() == 3);
        uv_maps const large(1, {1000, 30}); // 4 x 4 map pixels a picture pixel
        CHECK(preflight_picture(to_uv_view(large), preflight(to_uv_view(large), {{10, 10}}, render_settings<float>{}))
                  .height > 250);
    }
}
