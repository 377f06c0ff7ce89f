// SPDX-License-Identifier: MIT
// Distances in registers are those of offset_on, and what is counted and found among them is what is there.
#include <genrender/correspondence/sample_distances.hpp>

#include "support/each_vector_target.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <type_traits>
#include <utility>
#include <vector>

#define GENRENDER_KERNELS "correspondence/sample_distances.test.inl"
#include <genrender/core/each_target.inl>

using namespace genrender;
using testing::at_each_vector_target;

namespace {

template <std::size_t D>
using dimension = std::integral_constant<std::size_t, D>;

} // namespace

TEST_SUITE("correspondence/sample_distances") {
    TEST_CASE_TEMPLATE("what is found within a radius is what a search through all pixels finds", Dim, dimension<2>,
                       dimension<3>) {
        at_each_vector_target([] { GENRENDER_KERNEL(testing, check_search<Dim>)(); });
    }
}
