// SPDX-License-Identifier: MIT
// Sums of a run.
#include <genrender/pipeline/render_report.hpp>

#include <doctest/doctest.h>

using namespace genrender;

TEST_SUITE("pipeline/render_report") {
    TEST_CASE("coverage is summed per resolution and skipped frames are named once") {
        render_report report;
        report.add_coverage({8, 8}, 40, 30);
        report.add_coverage({8, 8}, 60, 20);
        report.add_coverage({16, 16}, 0, 0);
        report.add_skipped({3, 1});
        report.add_skipped({3});
        report.add_seconds(2, 0.5);
        report.add_seconds(1, 0.25);
        CHECK(report.coverage().at({8, 8}).share() == doctest::Approx(0.5));
        CHECK(report.coverage().at({16, 16}).share() == 0);
        CHECK(report.skipped_frames() == std::set<std::size_t>{1, 3});
        CHECK(report.denoiser_seconds() == doctest::Approx(3));
        CHECK(report.library_seconds() == doctest::Approx(0.75));
    }

    TEST_CASE("the vector target of a run is told") {
        render_report report;
        CHECK(report.vector_target() == vector_target::baseline);
        report.set_vector_target(vector_target::v4);
        CHECK(report.vector_target() == vector_target::v4);
    }
}
