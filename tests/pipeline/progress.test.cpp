// SPDX-License-Identifier: MIT
// What the observer is told.
#include <genrender/pipeline/progress.hpp>

#include <doctest/doctest.h>

#include <vector>

using namespace genrender;

TEST_SUITE("pipeline/progress") {
    TEST_CASE("frames are counted per pass and what is left is estimated from what was done") {
        std::vector<progress> told;
        progress_meter meter(2, 10, [&](progress const& state) {
            told.push_back(state);
            return true;
        });
        meter.begin(0, render_pass::keyframes, 2);
        meter.add(2);
        meter.begin(0, render_pass::frames, 3);
        meter.add(1);
        meter.add(2);
        REQUIRE(told.size() == 3);
        CHECK(told[0].frames_done == 2);
        CHECK(told[1].frames_done == 1);
        CHECK(told[1].frames == 3);
        CHECK(told[2].frames_done == 3);
        CHECK(told[2].remaining_seconds == doctest::Approx(told[2].elapsed_seconds)); // 5 of 10 done
    }
    TEST_CASE("an observer that says no cancels") {
        progress_meter meter(3, 1, [](progress const&) { return false; });
        meter.begin(1, render_pass::frames, 1);
        CHECK_THROWS_WITH_AS(meter.add(1), "render: cancelled by its observer in step 2 of 3", cancelled);
    }
    TEST_CASE("without an observer nothing happens") {
        progress_meter meter(1, 0, {});
        meter.begin(0, render_pass::frames, 1);
        CHECK_NOTHROW(meter.add(1));
    }
}
