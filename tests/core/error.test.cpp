// SPDX-License-Identifier: MIT
// What the exceptions say, to the letter.
#include <genrender/core/error.hpp>

#include <doctest/doctest.h>

#include <array>
#include <limits>
#include <string>
#include <type_traits>
#include <vector>

using namespace genrender;

TEST_SUITE("core/error") {
    TEST_CASE("extents are written in brackets with commas") {
        CHECK(extents_text(std::array<std::size_t, 3>{2, 64, 1}) == "[2, 64, 1]");
        CHECK(extents_text({7}) == "[7]");
        CHECK(extents_text({0, 0}) == "[0, 0]");
        CHECK(extents_text(std::vector<int>{}) == "[]");
        CHECK(extents_text({std::numeric_limits<std::size_t>::max()}) ==
              "[" + std::to_string(std::numeric_limits<std::size_t>::max()) + "]");
    }

    TEST_CASE("require_extents names the function and the argument and both extents") {
        CHECK_THROWS_WITH_AS(require_extents("unified_texture", "F_KF", std::array{2, 1, 1}, std::array{2, 2, 1}),
                             "unified_texture: F_KF is [2, 1, 1], expected [2, 2, 1]", shape_error);
        CHECK_NOTHROW(require_extents("f", "x", std::array{2, 3}, std::array{2, 3}));
    }

    TEST_CASE("require_extents tells apart extents whose digits run together") {
        CHECK_THROWS_AS(require_extents("f", "x", std::array{1, 23}, std::array{12, 3}), shape_error);
        CHECK_THROWS_AS(require_extents("f", "x", std::array{12}, std::array{1, 2}), shape_error);
        CHECK_THROWS_AS(require_extents("f", "x", std::array<int, 0>{}, std::array{0}), shape_error);
    }

    TEST_CASE("require_extents compares numbers and not their types") {
        CHECK_NOTHROW(require_extents("f", "x", std::vector<long>{4, 5}, std::array<std::size_t, 2>{4, 5}));
    }

    TEST_CASE("require_value writes numbers and words") {
        CHECK_THROWS_WITH_AS(require_value(false, "draw", "count", std::size_t{5}, "1 to 4"),
                             "draw: count is 5, expected 1 to 4", value_error);
        CHECK_THROWS_WITH_AS(require_value(false, "draw", "count", -1, "1 to 4"), "draw: count is -1, expected 1 to 4",
                             value_error);
        CHECK_THROWS_WITH_AS(require_value(false, "draw", "frames", "empty", "one"),
                             "draw: frames is empty, expected one", value_error);
        CHECK_THROWS_WITH_AS(require_value(false, "draw", "frames", std::string("so"), "one"),
                             "draw: frames is so, expected one", value_error);
        CHECK_THROWS_WITH_AS(require_value(false, "mix", "alpha", 0.5F, "1"), "mix: alpha is 0.500000, expected 1",
                             value_error);
        CHECK_THROWS_WITH_AS(require_value(false, "mix", "alpha", std::numeric_limits<double>::quiet_NaN(), "a number"),
                             "mix: alpha is nan, expected a number", value_error);
        CHECK_NOTHROW(require_value(true, "mix", "alpha", 0, "anything"));
    }

    TEST_CASE("a caller's mistakes are arguments and the world's are not") {
        CHECK(std::is_base_of_v<std::invalid_argument, shape_error>);
        CHECK(std::is_base_of_v<std::invalid_argument, value_error>);
        CHECK(std::is_base_of_v<std::runtime_error, file_error>);
        CHECK(std::is_base_of_v<std::runtime_error, cancelled>);
        CHECK_FALSE(std::is_base_of_v<std::invalid_argument, file_error>);
        CHECK_FALSE(std::is_base_of_v<shape_error, value_error>);
        CHECK_FALSE(std::is_base_of_v<value_error, shape_error>);
    }
}
