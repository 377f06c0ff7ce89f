// SPDX-License-Identifier: MIT
// Of the samples nearest in canonical space the closest on the screen shows a point, as sorting all of them says.
#include <genrender/correspondence/object_samples.hpp>

#include <genrender/core/random.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <type_traits>
#include <utility>
#include <vector>

using namespace genrender;

namespace {

using samples_type = object_samples<2>;

/// Pixel (row, column) of a plane on which pixels are 1/64 apart, in cells of 4 x 4.
samples_type::sample plane_sample(std::uint32_t row, std::uint32_t column) {
    return {{static_cast<float>(column) / 64, static_cast<float>(row) / 64},
            surface_footprint<2>{{1.0F / 64, 0}, {0, 1.0F / 64}},
            {token_index{row / 4 * 16 + column / 4}, 4096}};
}

samples_type plane(double reach) {
    std::vector<samples_type::sample> samples;
    for (std::uint32_t row = 0; row < 64; ++row) {
        for (std::uint32_t column = 0; column < 64; ++column) {
            samples.push_back(plane_sample(row, column));
        }
    }
    return {std::move(samples), reach, {4, 4}};
}

footprint_point<2> point_at(float u, float v) {
    return {{0}, {u, v}, surface_footprint<2>{{1.0F / 64, 0}, {0, 1.0F / 64}}};
}

double uniform(std::uint32_t kind, std::uint32_t number, std::uint32_t axis) {
    return uniform_value(3, random_stream::test, {kind, number, axis});
}

/// Where a bent sheet is seen on a screen of `side` x `side` pixels, from (0, 0) on or turned around.
template <std::size_t D>
footprint_point<D> sheet_point(std::size_t side, double row, double column, bool is_turned = false) {
    auto const scale = 1 / static_cast<double>(side);
    auto const place_of = [&](double y, double x) {
        auto const u = x * scale;
        auto const v = y * scale * (1 + 0.5 * x * scale);
        std::array<float, D> place{};
        place[0] = static_cast<float>(is_turned ? -u : u);
        place[1] = static_cast<float>(0.3 * u + v);
        if constexpr (D == 3) {
            place[2] = static_cast<float>(0.4 * u * u + 0.2 * std::sin(5 * v));
        }
        return place;
    };
    footprint_point<D> point{{0}, place_of(row, column), surface_footprint<D>{}};
    auto const right = place_of(row, column + 1);
    auto const below = place_of(row + 1, column);
    for (std::size_t d = 0; d < D; ++d) {
        point.footprint->across[d] = right[d] - point.place[d];
        point.footprint->down[d] = below[d] - point.place[d];
    }
    return point;
}

/// All pixels of the sheet, each the sample of a token of its own.
template <std::size_t D>
std::vector<typename object_samples<D>::sample> sheet(std::size_t side) {
    std::vector<typename object_samples<D>::sample> samples;
    for (std::uint32_t row = 0; row < side; ++row) {
        for (std::uint32_t column = 0; column < side; ++column) {
            auto const point = sheet_point<D>(side, row, column);
            samples.push_back({point.place, point.footprint, {{static_cast<std::uint32_t>(samples.size())}, 1}});
        }
    }
    return samples;
}

/// The definition: all samples sorted by canonical distance, of the first few the closest on the screen of cells of
/// 4 x 4.
template <std::size_t D>
std::optional<token_index> token_by_sorting(std::vector<typename object_samples<D>::sample> const& samples,
                                            footprint_point<D> const& point, double reach) {
    std::vector<std::pair<float, std::size_t>> by_distance;
    for (std::size_t n = 0; n < samples.size(); ++n) {
        float square = 0;
        for (std::size_t d = 0; d < D; ++d) {
            square += (samples[n].place[d] - point.place[d]) * (samples[n].place[d] - point.place[d]);
        }
        by_distance.emplace_back(square, n);
    }
    std::sort(by_distance.begin(), by_distance.end());
    by_distance.resize(std::min(by_distance.size(), nearest_samples<D>::visited));
    std::optional<std::pair<double, token_index>> closest;
    for (auto const& [square, n] : by_distance) {
        auto const& s = samples[n];
        if (s.footprint && !faces_alike(*s.footprint, *point.footprint)) {
            continue;
        }
        auto const& measure = s.footprint ? *s.footprint : *point.footprint;
        auto const offset = offset_on(measure, s.place, point.place);
        if (s.place != point.place && offset.off_plane > 0.5 * std::sqrt(measure.area() * 16)) {
            continue;
        }
        auto const distance = s.place == point.place ? 0 : std::max(std::abs(offset.down), std::abs(offset.right)) / 2;
        if (distance <= reach) {
            std::pair const found(distance, s.match.token);
            closest = closest ? std::min(*closest, found) : found;
        }
    }
    return closest ? std::optional(closest->second) : std::nullopt;
}

/// Asks 400 times around the sheet; the number of points that are shown.
template <std::size_t D>
std::size_t check_against_sorting(std::vector<typename object_samples<D>::sample> const& samples, std::size_t side,
                                  double reach) {
    object_samples<D> const of(samples, reach, {4, 4});
    std::size_t shown = 0;
    for (std::uint32_t number = 0; number < 400; ++number) {
        auto const row = (1.6 * uniform(1, number, 0) - 0.3) * static_cast<double>(side);
        auto const column = (1.6 * uniform(1, number, 1) - 0.3) * static_cast<double>(side);
        auto const point = sheet_point<D>(side, row, column, number % 7 == 0);
        auto const* const found = of.sample_of(point);
        auto const expected = token_by_sorting<D>(samples, point, reach);
        REQUIRE((found != nullptr) == expected.has_value());
        if (found != nullptr) {
            CHECK(found->match.token == *expected);
            ++shown;
        }
    }
    return shown;
}

template <std::size_t D>
using dimension = std::integral_constant<std::size_t, D>;

} // namespace

TEST_SUITE("correspondence/object_samples") {
    TEST_CASE_TEMPLATE("a sample is the one that sorting finds", D, dimension<2>, dimension<3>) {
        for (std::size_t const side : {16U, 33U}) {
            for (auto const reach : {0.3, 1.0, 2.0}) {
                CAPTURE(side);
                CAPTURE(reach);
                auto const shown = check_against_sorting<D::value>(sheet<D::value>(side), side, reach);
                CHECK(shown > 100);
                CHECK(shown < 350);
            }
        }
    }

    TEST_CASE_TEMPLATE("so it is among samples without footprint and other sheets", D, dimension<2>, dimension<3>) {
        auto samples = sheet<D::value>(32);
        for (std::size_t n = 0; n < samples.size(); n += 97) {
            samples[n].footprint.reset();
        }
        // Parts of a sheet close to the first, and of one that faces the other way.
        for (auto s : sheet<D::value>(32)) {
            for (auto& coordinate : s.place) {
                coordinate += 0.001F;
            }
            if (s.match.token.value % 3 == 1) {
                std::swap(s.footprint->across, s.footprint->down);
            }
            if (s.match.token.value % 3 != 2) {
                s.match.token.value += 32 * 32;
                samples.push_back(s);
            }
        }
        CHECK(check_against_sorting<D::value>(samples, 32, 1) > 50);
    }

    TEST_CASE("a point seen from behind is not shown and one without footprint is") {
        auto const samples = plane(1);
        auto behind = point_at(0.5F, 0.5F);
        std::swap(behind.footprint->across, behind.footprint->down);
        CHECK(samples.sample_of(behind) == nullptr);
        auto isolated = point_at(0.501F, 0.5F);
        isolated.footprint.reset();
        auto const* const sample = samples.sample_of(isolated);
        REQUIRE(sample != nullptr);
        CHECK(sample->match.token == token_index{8 * 16 + 8});
        CHECK(sample->match.quality == 4096);
    }

    TEST_CASE("reach is counted in half cells") {
        // Three pixels beside the last column are 1.5 half cells from it.
        auto const beside = point_at(66.0F / 64, 34.0F / 64);
        CHECK(plane(1).sample_of(beside) == nullptr);
        auto const samples = plane(1.6);
        auto const* const further = samples.sample_of(beside);
        REQUIRE(further != nullptr);
        CHECK(further->match.token == token_index{8 * 16 + 15});
    }

    TEST_CASE("of samples at one place the lowest token shows it") {
        std::vector<samples_type::sample> samples;
        for (std::uint32_t const token : {5U, 3U, 9U}) {
            samples.push_back(plane_sample(4, 4));
            samples.back().match.token = {token};
        }
        samples_type const of(samples, 1, {4, 4});
        auto const* const sample = of.sample_of(point_at(4.0F / 64, 4.0F / 64));
        REQUIRE(sample != nullptr);
        CHECK(sample->match.token == token_index{3});
    }

    TEST_CASE("no samples show nothing") {
        samples_type const none({}, 1, {4, 4});
        CHECK(none.sample_of(point_at(0, 0)) == nullptr);
    }
}
