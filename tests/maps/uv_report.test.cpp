// SPDX-License-Identifier: MIT
// The report counts what it is given, and only where something is shown.
#include <genrender/maps/uv_report.hpp>

#include <genrender/maps/uv_maps.hpp>

#include <doctest/doctest.h>

#include <limits>

TEST_SUITE("maps/uv_report") {
    using namespace genrender;

    TEST_CASE("each kind of coordinate is counted once") {
        uv_maps maps(3, {2, 2});
        auto const show = [&](std::size_t frame, std::size_t row, std::size_t column, float u, float v) {
            maps.coverage(frame, row, column) = 1;
            maps.uv(frame, row, column, 0) = u;
            maps.uv(frame, row, column, 1) = v;
        };
        show(0, 0, 0, 0, 1); // the borders are on the texture
        show(0, 0, 1, 1.001f, 0.5f);
        show(0, 1, 0, -0.001f, 2);
        show(0, 1, 1, std::numeric_limits<float>::quiet_NaN(), 5);
        show(2, 0, 0, 0.5f, std::numeric_limits<float>::infinity());
        maps.uv(2, 1, 1, 0) = 7; // not shown
        auto const report = inspect(to_uv_view(maps));
        CHECK(report.pixels == 12);
        CHECK(report.covered == 5);
        CHECK(report.out_of_range == 2);
        CHECK(report.not_finite == 2);
        CHECK(report.background_share() == doctest::Approx(7.0 / 12));
        REQUIRE(report.empty_frames.size() == 1);
        CHECK(report.empty_frames[0] == frame_index{1});
        CHECK_FALSE(report.all_on_texture());
    }

    TEST_CASE("a faultless animation has nothing to report") {
        uv_maps maps(1, {2, 2});
        maps.coverage.fill(1);
        auto const report = inspect(to_uv_view(maps));
        CHECK(report.all_on_texture());
        CHECK(report.empty_frames.empty());
        CHECK(report.background_share() == 0);
    }

    TEST_CASE("maps without pixels have no background share") {
        CHECK(uv_report{}.background_share() == 0);
        CHECK(inspect(to_uv_view(uv_maps(0, {2, 2}))).pixels == 0);
    }
}
