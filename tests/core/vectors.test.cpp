// SPDX-License-Identifier: MIT
// The vectors of every target: what goes in comes out, lane by lane.
#include <genrender/core/vectors.hpp>

#include <genrender/core/linalg.hpp>

#include "support/each_vector_target.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <vector>

#define GENRENDER_KERNELS "core/vectors.test.inl"
#include <genrender/core/each_target.inl>

using namespace genrender;
using testing::at_each_vector_target;

TEST_SUITE("core/vectors") {
    TEST_CASE("a register holds twice as many floats as doubles") {
        at_each_vector_target([] { GENRENDER_KERNEL(testing, check_lane_counts)(); });
    }

    TEST_CASE("elements are loaded from any address and bits stay what they are") {
        at_each_vector_target([] { GENRENDER_KERNEL(testing, check_bits)(); });
    }

    TEST_CASE_TEMPLATE("arithmetic is that of each lane", Real, float, double) {
        at_each_vector_target([] { GENRENDER_KERNEL(testing, check_arithmetic<Real>)(); });
    }

    TEST_CASE_TEMPLATE("a spread number keeps its sign even if it is 0", Real, float, double) {
        at_each_vector_target([] { GENRENDER_KERNEL(testing, check_spread_sign<Real>)(); });
    }

    TEST_CASE_TEMPLATE("the greater number of each lane and the second beside NaN", Real, float, double) {
        at_each_vector_target([] { GENRENDER_KERNEL(testing, check_greater<Real>)(); });
    }

    TEST_CASE_TEMPLATE("one lane is enough for any_greater", Real, float, double) {
        at_each_vector_target([] { GENRENDER_KERNEL(testing, check_any_greater<Real>)(); });
    }

    TEST_CASE_TEMPLATE("the transposed square has rows for columns", Real, float, double) {
        at_each_vector_target([] { GENRENDER_KERNEL(testing, check_transpose<Real>)(); });
    }

    TEST_CASE("unrolled indices come in order") {
        at_each_vector_target([] { GENRENDER_KERNEL(testing, check_unrolled)(); });
    }

    TEST_CASE("any address may be asked for") {
        at_each_vector_target([] { CHECK_NOTHROW(GENRENDER_KERNEL(testing, check_prefetch)()); });
    }

    TEST_CASE_TEMPLATE("every number of a row passes a register once", Real, float, double) {
        at_each_vector_target([] { GENRENDER_KERNEL(testing, check_each_register<Real>)(); });
    }

    TEST_CASE_TEMPLATE("2^x is within an ulp and a half of the standard library over all of its range", Real, float,
                       double) {
        at_each_vector_target([] { GENRENDER_KERNEL(testing, check_exponential_error<Real>)(); });
    }

    TEST_CASE_TEMPLATE("whole numbers are powers of 2 to the last bit", Real, float, double) {
        at_each_vector_target([] { GENRENDER_KERNEL(testing, check_exponential_of_whole_numbers<Real>)(); });
    }

    TEST_CASE_TEMPLATE("2^x of what lies far below counts as next to nothing and never as less", Real, float, double) {
        at_each_vector_target([] { GENRENDER_KERNEL(testing, check_exponential_far_below<Real>)(); });
    }

    TEST_CASE_TEMPLATE("2^x of NaN is NaN", Real, float, double) {
        at_each_vector_target([] { GENRENDER_KERNEL(testing, check_exponential_of_nan<Real>)(); });
    }

    TEST_CASE_TEMPLATE("all numbers of 16 bits are exact in float and double", Real, float, double) {
        at_each_vector_target([] {
            GENRENDER_KERNEL(testing, check_widening<Real, float16>)();
            GENRENDER_KERNEL(testing, check_widening<Real, bfloat16>)();
        });
    }
}
