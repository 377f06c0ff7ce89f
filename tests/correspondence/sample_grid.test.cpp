// SPDX-License-Identifier: MIT
// Where the grid is sure, it says what the tree's nearest few say in double precision; and it is sure nearly always.
#include <genrender/correspondence/sample_grid.hpp>

#include <genrender/core/random.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

using namespace genrender;

namespace {

double uniform(std::uint32_t kind, std::uint32_t number, std::uint32_t axis) {
    return uniform_value(3, random_stream::test, {kind, number, axis});
}

/// A bent sheet seen on a screen of `side` x `side` pixels, from (0, 0) on or shifted.
template <std::size_t D>
grid_sample<D> sheet_sample(std::size_t side, double row, double column, bool is_turned = false) {
    auto const scale = 1 / static_cast<double>(side);
    auto const point_at = [&](double y, double x) {
        auto const u = x * scale;
        auto const v = y * scale * (1 + 0.5 * x * scale);
        std::array<float, D> point{};
        point[0] = static_cast<float>(is_turned ? -u : u);
        point[1] = static_cast<float>(0.3 * u + v);
        if constexpr (D == 3) {
            point[2] = static_cast<float>(0.4 * u * u + 0.2 * std::sin(5 * v));
        }
        return point;
    };
    grid_sample<D> sample;
    sample.place = point_at(row, column);
    sample.footprint.emplace();
    auto const right = point_at(row, column + 1);
    auto const below = point_at(row + 1, column);
    for (std::size_t d = 0; d < D; ++d) {
        sample.footprint->across[d] = right[d] - sample.place[d];
        sample.footprint->down[d] = below[d] - sample.place[d];
    }
    return sample;
}

/// footprint_map's definition, in double precision and by way of the tree.
template <std::size_t D>
std::optional<std::uint32_t> number_by_tree(sample_tree<D> const& tree, std::vector<grid_sample<D>> const& samples,
                                            grid_sample<D> const& asked, double reach, double rows, double columns) {
    std::optional<std::pair<double, std::uint32_t>> closest;
    tree.visit_nearest(asked.place, [&](std::size_t number) {
        auto const& s = samples[number];
        if (s.footprint && !faces_alike(*s.footprint, *asked.footprint)) {
            return;
        }
        auto const& measure = s.footprint ? *s.footprint : *asked.footprint;
        auto const offset = offset_on(measure, s.place, asked.place);
        if (s.place != asked.place && offset.off_plane > 0.5 * std::sqrt(measure.area() * rows * columns)) {
            return;
        }
        auto const distance =
            s.place == asked.place ? 0 : std::max(std::abs(offset.down) / rows, std::abs(offset.right) / columns) * 2;
        if (distance <= reach) {
            std::pair const found(distance, static_cast<std::uint32_t>(number));
            closest = closest ? std::min(*closest, found) : found;
        }
    });
    return closest ? std::optional(closest->second) : std::nullopt;
}

struct tally {
    std::size_t shown = 0;
    std::size_t not_shown = 0;
    std::size_t unsure = 0;
};

/// Asks 4000 times around the samples and compares every answer that is sure.
template <std::size_t D>
tally compare(std::vector<grid_sample<D>> samples, std::size_t side, double reach) {
    constexpr double rows = 4;
    constexpr double columns = 4;
    sample_grid<D> const grid(samples, reach, rows, columns, 1);
    std::vector<std::array<float, D>> places;
    for (auto const& s : samples) {
        places.push_back(s.place);
    }
    sample_tree<D> const tree(std::move(places));
    using verdict = typename sample_grid<D>::verdict;
    tally count;
    for (std::uint32_t number = 0; number < 4000; ++number) {
        auto const row = (1.6 * uniform(1, number, 0) - 0.3) * static_cast<double>(side);
        auto const column = (1.6 * uniform(1, number, 1) - 0.3) * static_cast<double>(side);
        auto const asked = sheet_sample<D>(side, row, column, number % 7 == 0);
        auto const answer = grid.find(asked.place, *asked.footprint);
        auto const expected = number_by_tree(tree, samples, asked, reach, rows, columns);
        if (answer.is == verdict::unsure) {
            ++count.unsure;
        } else if (answer.is == verdict::shown) {
            ++count.shown;
            REQUIRE(expected.has_value());
            CHECK(answer.number == *expected);
        } else {
            ++count.not_shown;
            CHECK_FALSE(expected.has_value());
        }
    }
    return count;
}

/// All pixels of the sheet.
template <std::size_t D>
std::vector<grid_sample<D>> sheet(std::size_t side) {
    std::vector<grid_sample<D>> samples;
    for (std::size_t row = 0; row < side; ++row) {
        for (std::size_t column = 0; column < side; ++column) {
            samples.push_back(sheet_sample<D>(side, static_cast<double>(row), static_cast<double>(column)));
        }
    }
    return samples;
}

template <std::size_t D>
using dimension = std::integral_constant<std::size_t, D>;

} // namespace

TEST_SUITE("correspondence/sample_grid") {
    TEST_CASE_TEMPLATE("sure answers are those of the tree", D, dimension<2>, dimension<3>) {
        for (std::size_t const side : {16U, 33U, 64U}) {
            for (auto const reach : {0.3, 1.0, 2.0}) {
                CAPTURE(side);
                CAPTURE(reach);
                auto const count = compare<D::value>(sheet<D::value>(side), side, reach);
#if defined(__GNUC__)
                CHECK(count.shown > 1000);
                CHECK(count.not_shown > 500);
                CHECK(count.unsure < 1000);
#else
                CHECK(count.unsure == 4000);
#endif
            }
        }
    }

    TEST_CASE_TEMPLATE("pixels without footprint and other sheets do not make it wrong", D, dimension<2>,
                       dimension<3>) {
        auto samples = sheet<D::value>(32);
        for (std::size_t n = 0; n < samples.size(); n += 97) {
            samples[n].footprint.reset();
        }
        // Parts of the same sheet again, and of one that faces the other way.
        std::size_t number = 0;
        for (auto s : sheet<D::value>(32)) {
            if (number % 3 == 0) {
                samples.push_back(s);
            } else if (number % 3 == 1) {
                std::swap(s.footprint->across, s.footprint->down);
                samples.push_back(s);
            }
            ++number;
        }
        auto const count = compare<D::value>(samples, 32, 1);
        CHECK(count.shown + count.not_shown + count.unsure == 4000);
    }

    TEST_CASE("coordinates too large for single precision make it unsure and never wrong") {
        auto samples = sheet<2>(32);
        for (auto& s : samples) {
            s.place[0] += 4096;
        }
        sample_grid<2> const grid(samples, 1, 4, 4, 1);
        for (auto const& s : samples) {
            auto const answer = grid.find(s.place, *s.footprint);
            CHECK(answer.is == sample_grid<2>::verdict::unsure);
        }
    }

    TEST_CASE("few pixels in one place and none at all") {
        using verdict = sample_grid<2>::verdict;
        for (std::size_t const many : {1U, 3U, 40U}) {
            std::vector<grid_sample<2>> const samples(many, sheet_sample<2>(16, 3, 5));
            auto const count = compare<2>(samples, 16, 1);
            CHECK(count.shown + count.not_shown + count.unsure == 4000);
        }
        auto const asked = sheet_sample<2>(16, 3, 5);
        std::vector<grid_sample<2>> none;
        auto const answer = sample_grid<2>(none, 1, 4, 4, 1).find(asked.place, *asked.footprint);
        CHECK(answer.is != verdict::shown);
    }
}
