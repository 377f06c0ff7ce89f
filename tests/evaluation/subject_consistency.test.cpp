// SPDX-License-Identifier: MIT
// VBench's subject consistency by hand.
#include <genrender/evaluation/subject_consistency.hpp>

#include <genrender/core/stack.hpp>
#include <genrender/evaluation/frame_consistency.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <cstddef>
#include <numbers>

using namespace genrender;

TEST_SUITE("evaluation/subject_consistency") {
    /// Vectors of different lengths that turn by `step` radians a frame.
    stack<double, 2> turning(std::size_t frames, double step) {
        stack<double, 2> rows({frames, 2});
        for (std::size_t t = 0; t < frames; ++t) {
            auto const length = 1 + static_cast<double>(t);
            rows(t, 0) = length * std::cos(step * static_cast<double>(t));
            rows(t, 1) = length * std::sin(step * static_cast<double>(t));
        }
        return rows;
    }

    TEST_CASE("a frame is compared with the first and with the one before it") {
        auto const a = std::numbers::pi / 6;
        auto const expected = ((std::cos(a) + std::cos(a)) / 2 + (std::cos(2 * a) + std::cos(a)) / 2) / 2;
        CHECK(*subject_consistency(turning(3, a).view()) == doctest::Approx(expected));
    }

    TEST_CASE("it sees a drift that consecutive frames do not") {
        auto const drifting = turning(40, 0.04);
        CHECK(*frame_consistency(drifting.view()) > 0.999);
        CHECK(*subject_consistency(drifting.view()) < 0.9);
    }

    TEST_CASE("a single frame has none") {
        CHECK_FALSE(subject_consistency(turning(1, 1).view()));
        CHECK_FALSE(subject_consistency(stack<float, 2>({0, 3}).view()));
    }
}
