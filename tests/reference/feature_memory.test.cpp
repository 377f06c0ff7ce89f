// SPDX-License-Identifier: MIT
// Tests of memory for features.
#include <genrender/reference/feature_memory.hpp>

#include <doctest/doctest.h>

#include <cstdint>
#include <utility>

using namespace genrender;

using namespace genrender::reference;

TEST_SUITE("reference/feature_memory") {
    TEST_CASE_TEMPLATE("it begins at a cache line", Real, float, double) {
        for (std::size_t const size : {1U, 3U, 1000U}) {
            feature_memory<Real> const memory(size);
            CHECK(memory.size() == size);
            CHECK(reinterpret_cast<std::uintptr_t>(memory.data()) % 64 == 0);
        }
        CHECK(feature_memory<Real>().size() == 0);
    }

    TEST_CASE("copies own their numbers and moves take them along") {
        feature_memory<float> a(2);
        a.data()[0] = 1;
        a.data()[1] = 2;
        auto b = a;
        b.data()[0] = 5;
        CHECK(a.data()[0] == 1);
        CHECK(b.data()[1] == 2);
        auto const* const where = b.data();
        a = std::move(b);
        CHECK(a.data() == where);
        CHECK(a.data()[0] == 5);
        auto const c = std::move(a);
        CHECK(c.data() == where);
        CHECK(c.size() == 2);
    }
}
