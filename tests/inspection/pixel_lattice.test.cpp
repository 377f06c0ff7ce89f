// SPDX-License-Identifier: MIT
// The lattice takes all pixels where it may, one of each square where it may not, and no line falls between them.
#include <genrender/inspection/pixel_lattice.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <set>
#include <utility>
#include <vector>

TEST_SUITE("inspection/pixel_lattice") {
    using namespace genrender;

    TEST_CASE("as many pixels as are allowed are all pixels in order") {
        pixel_lattice const lattice({3, 4}, 12);
        CHECK(lattice.stride() == 1);
        std::uint32_t next = 0;
        lattice.visit_pixels([&](pixel p) { CHECK(p.row * 4 + p.column == next++); });
        CHECK(next == 12);
    }

    TEST_CASE("every square of the stride has one pixel and those at the borders too") {
        pixel_lattice const lattice({5, 7}, 12); // 3 x 4 squares of 2 x 2, some cut
        CHECK(lattice.stride() == 2);
        CHECK(lattice.size() == 12);
        std::set<std::pair<std::uint32_t, std::uint32_t>> squares;
        lattice.visit_pixels([&](pixel p) {
            CHECK(p.row < 5);
            CHECK(p.column < 7);
            squares.emplace(p.row / 2, p.column / 2);
        });
        CHECK(squares.size() == 12);
    }

    TEST_CASE("every column is met about equally often") {
        pixel_lattice const lattice({512, 512}, 1 << 12); // squares of 8 x 8
        std::vector<std::size_t> met(512);
        lattice.visit_pixels([&](pixel p) { ++met[p.column]; });
        auto const most = *std::max_element(met.begin(), met.end());
        auto const least = *std::min_element(met.begin(), met.end());
        CHECK(least >= 4); // of 64 squares above each other, 8 on average
        CHECK(most <= 16);
    }

    TEST_CASE("nothing has no pixels and a limit of nothing is one") {
        auto const count = [](grid_extents grid, std::size_t most) {
            std::size_t visited = 0;
            pixel_lattice(grid, most).visit_pixels([&](pixel) { ++visited; });
            return visited;
        };
        CHECK(count({0, 0}, 16) == 0);
        CHECK(count({3, 0}, 16) == 0);
        CHECK(count({64, 64}, 0) == 1);
    }
}
