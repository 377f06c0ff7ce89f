// SPDX-License-Identifier: MIT
// Joint angles of the walk are periodic and stay within what joints can do.
#include <examples/scenes/walk_cycle.hpp>

#include <doctest/doctest.h>

TEST_SUITE("scenes/walk_cycle") {
    using namespace genrender::scenes;

    TEST_CASE("the cycle ends where it began") {
        auto const begin = limbs_at(0), end = limbs_at(1);
        CHECK(begin.hip == doctest::Approx(end.hip).epsilon(1e-4));
        CHECK(begin.knee == doctest::Approx(end.knee).epsilon(1e-4));
        CHECK(begin.ankle == doctest::Approx(end.ankle).epsilon(1e-4));
        CHECK(begin.shoulder == doctest::Approx(end.shoulder).epsilon(1e-4));
        CHECK(begin.elbow == doctest::Approx(end.elbow).epsilon(1e-4));
        CHECK(trunk_at(0).chest_turn == doctest::Approx(trunk_at(1).chest_turn));
    }

    TEST_CASE("knees and elbows bend one way only and no joint beyond its range") {
        for (int i = 0; i < 100; ++i) {
            auto const limbs = limbs_at(static_cast<float>(i) / 100);
            REQUIRE(limbs.knee > 0);
            REQUIRE(limbs.knee < glm::radians(70.0f));
            REQUIRE(limbs.elbow > 0);
            REQUIRE(limbs.elbow < glm::radians(60.0f));
            REQUIRE(std::abs(limbs.hip) < glm::radians(40.0f));
            REQUIRE(std::abs(limbs.ankle) < glm::radians(30.0f));
        }
    }

    TEST_CASE("the arm swings against the leg of its side") {
        CHECK(limbs_at(0).hip > 0);
        CHECK(limbs_at(0).shoulder < 0);
        CHECK(limbs_at(0.5f).hip < 0);
        CHECK(limbs_at(0.5f).shoulder > 0);
    }

    TEST_CASE("a bump is 1 at its centre and the same on both sides of the seam of phases") {
        CHECK(phase_bump(0.3f, 0.3f, 0.1f) == 1);
        CHECK(phase_bump(0.95f, 0, 0.1f) == doctest::Approx(phase_bump(0.05f, 0, 0.1f)).epsilon(1e-4));
        CHECK(phase_bump(0.4f, 0.3f, 0.1f) == doctest::Approx(std::exp(-1.0)).epsilon(1e-4));
    }
}
