// SPDX-License-Identifier: MIT
// [GR eq. 1] Tiles of the online softmax by themselves: what a lane gets is its own.
#include <genrender/attention/attention_tile.hpp>

#include <genrender/core/random.hpp>
#include <genrender/core/stack.hpp>

#include "support/each_vector_target.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#define GENRENDER_KERNELS "attention/attention_tile.test.inl"
#include <genrender/core/each_target.inl>

using namespace genrender;
using testing::at_each_vector_target;

TEST_SUITE("attention/attention_tile") {
    TEST_CASE_TEMPLATE("[GR eq. 1] logits of the tile weigh values by powers of 2", Real, float, double) {
        at_each_vector_target([] { GENRENDER_KERNEL(testing, check_weights_of_logits<Real>)(); });
    }

    TEST_CASE_TEMPLATE("a query gets the same in any lane of a full and of a narrow tile", Real, float, double) {
        at_each_vector_target([] { GENRENDER_KERNEL(testing, check_any_lane<Real>)(); });
    }

    TEST_CASE_TEMPLATE("a neighbour that must be rescaled leaves the others alone", Real, float, double) {
        at_each_vector_target([] { GENRENDER_KERNEL(testing, check_rescaling_of_a_neighbour<Real>)(); });
    }

    TEST_CASE_TEMPLATE("rows that lie anywhere weigh like rows that follow each other", Real, float, double) {
        at_each_vector_target([] { GENRENDER_KERNEL(testing, check_far_rows<Real>)(); });
    }
}
