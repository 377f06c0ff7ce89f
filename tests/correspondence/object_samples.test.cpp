// SPDX-License-Identifier: MIT
// Of the kept pixels the closest on the screen shows a point; in a moment or by way of the tree, the same one.
#include <genrender/correspondence/object_samples.hpp>

#include <doctest/doctest.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

using namespace genrender;

namespace {

using samples_type = object_samples<2>;

/// Pixel (row, column) of a plane on which pixels are 1/64 apart, in cells of 4 x 4.
samples_type::sample plane_sample(std::uint32_t row, std::uint32_t column) {
    return {{{static_cast<float>(column) / 64, static_cast<float>(row) / 64},
             surface_footprint<2>{{1.0F / 64, 0}, {0, 1.0F / 64}}},
            {token_index{row / 4 * 16 + column / 4}, 4096}};
}

samples_type plane(double reach) {
    std::vector<samples_type::sample> samples;
    for (std::uint32_t row = 0; row < 64; ++row) {
        for (std::uint32_t column = 0; column < 64; ++column) {
            samples.push_back(plane_sample(row, column));
        }
    }
    return {std::move(samples), reach, {4, 4}, 1};
}

/// Who shows a point; none if nobody does.
std::optional<samples_type::speaker> speaker_at(samples_type const& kept, footprint_point<2> const& point) {
    auto const number = kept.number_at(point);
    return number ? std::optional(kept.speaker_of(*number)) : std::nullopt;
}

footprint_point<2> point_at(float u, float v) {
    return {{0}, {u, v}, surface_footprint<2>{{1.0F / 64, 0}, {0, 1.0F / 64}}};
}

} // namespace

TEST_SUITE("correspondence/object_samples") {
    TEST_CASE("a sample is the one that the tree finds wherever the point lies") {
        auto const kept = plane(1);
        std::size_t shown = 0;
        for (int v = -40; v < 300; v += 3) {
            for (int u = -40; u < 300; u += 3) {
                auto const point =
                    point_at(static_cast<float>(u) / 256 + 0.0007F, static_cast<float>(v) / 256 + 0.0004F);
                auto const found = kept.number_at(point);
                REQUIRE(found == kept.number_by_tree(point));
                shown += found ? 1U : 0U;
            }
        }
        CHECK(shown > 6000);
        CHECK(shown < 10000);
    }

    TEST_CASE("a point seen from behind is not shown and one without footprint is") {
        auto const kept = plane(1);
        auto behind = point_at(0.5F, 0.5F);
        std::swap(behind.footprint->across, behind.footprint->down);
        CHECK_FALSE(kept.number_at(behind).has_value());
        auto lonely = point_at(0.501F, 0.5F);
        lonely.footprint.reset();
        auto const speaker = speaker_at(kept, lonely);
        REQUIRE(speaker.has_value());
        CHECK(speaker->token == token_index{8 * 16 + 8});
        CHECK(speaker->quality == 4096);
    }

    TEST_CASE("reach is counted in half cells") {
        // Three pixels beside the last column are 1.5 half cells from it.
        auto const beside = point_at(66.0F / 64, 34.0F / 64);
        CHECK_FALSE(plane(1).number_at(beside).has_value());
        auto const further = speaker_at(plane(1.6), beside);
        REQUIRE(further.has_value());
        CHECK(further->token == token_index{8 * 16 + 15});
    }

    TEST_CASE("nothing kept shows nothing") {
        samples_type const none({}, 1, {4, 4}, 1);
        CHECK_FALSE(none.number_at(point_at(0, 0)).has_value());
        CHECK_FALSE(none.number_by_tree(point_at(0, 0)).has_value());
    }
}
