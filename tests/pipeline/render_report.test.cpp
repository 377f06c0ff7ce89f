// SPDX-License-Identifier: MIT
// Sums of a run.
#include <genrender/pipeline/render_report.hpp>

#include <doctest/doctest.h>

using namespace genrender;

TEST_SUITE("pipeline/render_report") {
    TEST_CASE("coverage is summed per resolution and skipped frames are named once") {
        render_report report;
        report_writer writer(report);
        writer.add_coverage({8, 8}, 40, 30);
        writer.add_coverage({8, 8}, 60, 20);
        writer.add_coverage({16, 16}, 0, 0);
        writer.add_skipped({3, 1});
        writer.add_skipped({3});
        writer.add_seconds(2, 0.5);
        writer.add_seconds(1, 0.25);
        CHECK(report.coverage.at({8, 8}).share() == doctest::Approx(0.5));
        CHECK(report.coverage.at({16, 16}).share() == 0);
        CHECK(report.skipped_frames == std::set<std::size_t>{1, 3});
        CHECK(report.denoiser_seconds == doctest::Approx(3));
        CHECK(report.library_seconds == doctest::Approx(0.75));
        CHECK(report.consensus_seconds == 0);
    }

    TEST_CASE("the consensus has coverage of its own and its seconds are the library's") {
        render_report report;
        report_writer writer(report);
        writer.add_seconds(2, 0.5);
        writer.add_consensus_coverage(40, 30);
        writer.add_consensus_coverage(60, 20);
        writer.add_consensus_seconds(0.25);
        CHECK(report.consensus.share() == doctest::Approx(0.5));
        CHECK(report.coverage.empty());
        CHECK(report.consensus_seconds == doctest::Approx(0.25));
        CHECK(report.library_seconds == doctest::Approx(0.75));
        CHECK(report.denoiser_seconds == doctest::Approx(2));
    }

    TEST_CASE("a report of no run tells of nothing") {
        render_report const report;
        CHECK(report.kernels == vector_target::baseline);
        CHECK(report.coverage.empty());
        CHECK(report.denoiser_seconds == 0);
    }
}
