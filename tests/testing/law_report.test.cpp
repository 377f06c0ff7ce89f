// SPDX-License-Identifier: MIT
// A report tells all broken laws at once, each of them once.
#include <genrender/testing/law_report.hpp>

#include <genrender/core/stack.hpp>

#include <doctest/doctest.h>

#include <string>
#include <vector>

TEST_SUITE("testing/law_report") {
    using namespace genrender;
    using namespace genrender::testing;

    TEST_CASE("a report of nothing is empty and says nothing") {
        law_report report;
        report.require(true, "thing: it holds", "this", "that");
        CHECK(report.empty());
        CHECK(report.text() == "");
    }
    TEST_CASE("a law is told where it was broken first, and every law is told") {
        law_report report;
        report.add("thing: it holds", "this", "that");
        report.require(false, "thing: it holds", "something else", "that");
        report.add("thing: it holds still", "1", "2");
        CHECK_FALSE(report.empty());
        CHECK(report.violations == std::vector<std::string>{"thing: it holds: found this, expected that",
                                                            "thing: it holds still: found 1, expected 2"});
        CHECK(report.text() ==
              "thing: it holds: found this, expected that\nthing: it holds still: found 1, expected 2\n");
    }
    TEST_CASE("elements are compared in order and the first that differs is named by its address") {
        stack<double, 2> a({2, 3});
        auto b = a;
        law_report report;
        genrender::testing::detail::require_same(report, "thing: a is b", "a", a, b);
        CHECK(report.empty());
        b(1, 0) = 0.25;
        b(1, 2) = 7;
        genrender::testing::detail::require_same(report, "thing: a is b", "a", a, b, 0.1);
        CHECK(report.text() == "thing: a is b: found a[1, 0] = 0, expected 0.25 up to rounding\n");
        genrender::testing::detail::require_same(report, "thing: a is b nearly", "a", a, b, 0.3);
        CHECK(report.violations.back() == "thing: a is b nearly: found a[1, 2] = 0, expected 7 up to rounding");
    }
    TEST_CASE("what is not a number is near nothing") {
        using genrender::testing::detail::are_close;
        CHECK(are_close(1, 1, 0));
        CHECK_FALSE(are_close(1, 1.0000001, 0));
        CHECK(are_close(1000, 1000.5, 1e-3));
        CHECK_FALSE(are_close(std::nan(""), 1, 1e9));
        CHECK_FALSE(are_close(1, std::nan(""), 1e9));
    }
}
