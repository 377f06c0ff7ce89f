// SPDX-License-Identifier: MIT
// [GR sec. 3.2] Shares by quality by hand, and qualities over the steps of a run.
#include <genrender/blending/quality_weights.hpp>

#include <doctest/doctest.h>

#include <limits>
#include <vector>

using namespace genrender;

TEST_SUITE("blending/quality_weights") {
    namespace {

    std::vector<double> shares_of(std::vector<double> qualities, texel_average average, double exponent = 1) {
        std::vector<frame_index> const frames{{5}, {2}, {9}};
        average_shares(qualities, std::span(frames).first(qualities.size()), average, exponent);
        return qualities;
    }

    } // namespace

    TEST_CASE("shares by hand") {
        using shares = std::vector<double>;
        CHECK(shares_of({1, 3}, texel_average::plain) == shares{0.5, 0.5});
        CHECK(shares_of({1, 3}, texel_average::by_quality) == shares{0.25, 0.75});
        CHECK(shares_of({1, 3}, texel_average::by_quality, 2)[1] == doctest::Approx(0.9));
        CHECK(shares_of({1, 3}, texel_average::by_quality, 0) == shares{0.5, 0.5});
        CHECK(shares_of({1, 3, 2}, texel_average::winner) == shares{0, 1, 0});
        CHECK(shares_of({3, 3, 3}, texel_average::winner) == shares{0, 1, 0}); // frame 2 is the earliest
        CHECK(shares_of({0, 0}, texel_average::by_quality, 2) == shares{0.5, 0.5});
        CHECK(shares_of({}, texel_average::winner).empty());
    }
    TEST_CASE("qualities of any size and large exponents stay numbers") {
        auto const shares = shares_of({1e30, 2e30, 1e-30}, texel_average::by_quality, 40);
        CHECK(shares[1] == doctest::Approx(1));
        CHECK(shares[0] + shares[1] + shares[2] == doctest::Approx(1));
    }
    TEST_CASE("the exponent runs in a straight line from the first step to the last") {
        quality_settings const rising{0, 6, 0.25};
        CHECK(rising.at(0, 4).exponent == 0);
        CHECK(rising.at(1, 4).exponent == 2);
        CHECK(rising.at(3, 4).exponent == 6);
        CHECK(rising.at(0, 1).exponent == 0);
        CHECK(rising.at(2, 4).threshold == 0.25);
        CHECK_FALSE(rising.at(3, 4).are_plain());
        CHECK(quality_settings{}.at(3, 4).are_plain());
        CHECK_FALSE(quality_weights{1, 0.1}.are_plain());
    }
    TEST_CASE("a match is as good as its share of the frame's own quality, and where one is not known it is good") {
        CHECK(is_good_match(1, 2, 0.5));
        CHECK_FALSE(is_good_match(0.9, 2, 0.5));
        CHECK(is_good_match(0, 2, 0.5));
        CHECK(is_good_match(0.1, 0, 0.5));
    }
    TEST_CASE("numbers that are none or negative are refused in a sentence") {
        CHECK_NOTHROW(require_quality_settings("here", {0, 6, 1}));
        CHECK_THROWS_WITH_AS(require_quality_settings("here", {-1, 1, 0}),
                             "here: quality.exponent_begin is -1.000000, expected a finite number, 0 or more",
                             value_error);
        CHECK_THROWS_AS(require_quality_settings("here", {1, std::numeric_limits<double>::infinity(), 0}), value_error);
        CHECK_THROWS_AS(require_quality_settings("here", {1, 1, std::numeric_limits<double>::quiet_NaN()}),
                        value_error);
    }
}
