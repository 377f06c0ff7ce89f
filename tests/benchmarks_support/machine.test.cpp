// SPDX-License-Identifier: MIT
// What is read of the processors.
#include <benchmarks/support/machine.hpp>

#include <doctest/doctest.h>

#include <sstream>

using genrender::benchmarks::detail::read_processors;

TEST_SUITE("benchmarks_support/machine") {
    TEST_CASE("threads of one core count once and equal cores of two packages twice") {
        std::istringstream cpuinfo(
            "processor\t: 0\nmodel name\t: A Processor: fast\nphysical id\t: 0\ncore id\t\t: 0\n\n"
            "processor\t: 1\nmodel name\t: A Processor: fast\nphysical id\t: 0\ncore id\t\t: 0\n\n"
            "processor\t: 2\nmodel name\t: A Processor: fast\nphysical id\t: 1\ncore id\t\t: 0\n\n");
        auto const found = read_processors(cpuinfo);
        CHECK(found.name == "A Processor: fast");
        CHECK(found.cores == 2);
    }

    TEST_CASE("a system that does not tell has a processor without a name and no cores") {
        std::istringstream cpuinfo("processor\t: 0\n");
        CHECK(read_processors(cpuinfo).name == "unknown processor");
        std::istringstream none("processor\t: 0\n");
        CHECK(read_processors(none).cores == 0);
    }
}
