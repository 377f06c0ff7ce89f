// SPDX-License-Identifier: MIT
// Many values of N(0, 1) at once are those that come one by one.
#include <genrender/noise/normals.hpp>

#include "support/each_vector_target.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>

#define GENRENDER_KERNELS "noise/normals.test.inl"
#include <genrender/core/each_target.inl>

using namespace genrender;
using testing::at_each_vector_target;

TEST_SUITE("noise/normals") {
    TEST_CASE("values are those of the plain transform to a few units in the last place") {
        at_each_vector_target([] { GENRENDER_KERNEL(testing, check_values)(); });
    }

    TEST_CASE("the ends of the range and all eighths of a turn are right") {
        at_each_vector_target([] { GENRENDER_KERNEL(testing, check_ends)(); });
    }
}
