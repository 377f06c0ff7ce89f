// SPDX-License-Identifier: MIT
// [GR eq. 1] Keys of blocks in a row of tiles, and queries in and out of the lanes.
#include <genrender/attention/attention_scratch.hpp>

#include <genrender/core/linalg.hpp>
#include <genrender/core/stack.hpp>

#include "support/each_vector_target.hpp"

#include <doctest/doctest.h>

#include <genrender/testing/random_stack.hpp>

#include <algorithm>
#include <utility>
#include <vector>

#define GENRENDER_KERNELS "attention/attention_scratch.test.inl"
#include <genrender/core/each_target.inl>

using namespace genrender;
using testing::at_each_vector_target;

TEST_SUITE("attention/attention_scratch") {
    TEST_CASE_TEMPLATE("tiles hold the keys of all blocks in a row whatever their sizes", Real, float, double) {
        at_each_vector_target([] { GENRENDER_KERNEL(testing, check_tiles_of_blocks<Real>)(); });
    }

    TEST_CASE("keys of other strides or storage are copied even where keys are read in place") {
        at_each_vector_target([] { GENRENDER_KERNEL(testing, check_copies_of_keys)(); });
    }

    TEST_CASE_TEMPLATE("queries that go into a tile come out of it", Real, float, double) {
        at_each_vector_target([] { GENRENDER_KERNEL(testing, check_queries_in_and_out<Real>)(); });
    }

    TEST_CASE("16-bit rows are read as the numbers they store") {
        at_each_vector_target([] { GENRENDER_KERNEL(testing, check_half_rows)(); });
    }
}
