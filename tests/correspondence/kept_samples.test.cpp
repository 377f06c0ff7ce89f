// SPDX-License-Identifier: MIT
// Of the kept pixels the closest on the screen shows a point; in a moment or by way of the tree, the same one.
#include <genrender/correspondence/kept_samples.hpp>

#include <doctest/doctest.h>

#include <cstddef>
#include <cstdint>
#include <utility>

using namespace genrender;

namespace {

using samples_type = kept_samples<2>;

/// Pixel (row, column) of a plane on which pixels are 1/64 apart, in cells of 4 x 4.
samples_type::sample plane_sample(std::uint32_t row, std::uint32_t column) {
    return {token_index{row / 4 * 16 + column / 4},
            1,
            {static_cast<float>(column) / 64, static_cast<float>(row) / 64},
            surface_footprint<2>{{1.0F / 64, 0}, {0, 1.0F / 64}},
            4096};
}

samples_type plane(double reach) {
    samples_type kept;
    for (std::uint32_t row = 0; row < 64; ++row) {
        for (std::uint32_t column = 0; column < 64; ++column) {
            kept.add(plane_sample(row, column));
        }
    }
    kept.compile(reach, {4, 4}, 1);
    return kept;
}

footprint_point<2> point_at(float u, float v) {
    return {{0}, {u, v}, surface_footprint<2>{{1.0F / 64, 0}, {0, 1.0F / 64}}};
}

} // namespace

TEST_SUITE("correspondence/kept_samples") {
    TEST_CASE("a sample is the one that the tree finds wherever the point lies") {
        auto const kept = plane(1);
        std::size_t shown = 0;
        for (int v = -40; v < 300; v += 3) {
            for (int u = -40; u < 300; u += 3) {
                auto const point =
                    point_at(static_cast<float>(u) / 256 + 0.0007F, static_cast<float>(v) / 256 + 0.0004F);
                auto const* const sample = kept.sample_by_tree(point);
                auto const* const found = kept.sample_at(point);
                REQUIRE(found == sample);
                shown += found != nullptr ? 1U : 0U;
            }
        }
        CHECK(shown > 6000);
        CHECK(shown < 10000);
    }

    TEST_CASE("a point seen from behind is not shown and one without footprint is") {
        auto const kept = plane(1);
        auto behind = point_at(0.5F, 0.5F);
        std::swap(behind.footprint->across, behind.footprint->down);
        CHECK(kept.sample_at(behind) == nullptr);
        auto lonely = point_at(0.501F, 0.5F);
        lonely.footprint.reset();
        REQUIRE(kept.sample_at(lonely) != nullptr);
        CHECK(kept.sample_at(lonely)->token == token_index{8 * 16 + 8});
        CHECK(kept.sample_at(lonely)->quality() == 4096);
    }

    TEST_CASE("reach is counted in half cells") {
        // Three pixels beside the last column are 1.5 half cells from it.
        auto const beside = point_at(66.0F / 64, 34.0F / 64);
        CHECK(plane(1).sample_at(beside) == nullptr);
        auto const further = plane(1.6);
        REQUIRE(further.sample_at(beside) != nullptr);
        CHECK(further.sample_at(beside)->token == token_index{8 * 16 + 15});
    }

    TEST_CASE("nothing kept shows nothing") {
        samples_type none;
        none.compile(1, {4, 4}, 1);
        CHECK(none.sample_at(point_at(0, 0)) == nullptr);
    }
}
