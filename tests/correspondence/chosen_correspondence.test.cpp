// SPDX-License-Identifier: MIT
// [GR sec. 3.2] The correspondence chosen answers as the map that it stands for.
#include <genrender/correspondence/chosen_correspondence.hpp>

#include <genrender/testing/correspondence_laws.hpp>
#include "../support/random_scene.hpp"

#include <genrender/core/stack.hpp>
#include <genrender/correspondence/reproject.hpp>
#include <genrender/maps/uv_maps.hpp>

#include <doctest/doctest.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

using namespace genrender;

namespace {

static_assert(weighted_correspondence_map<chosen_correspondence<2>>);
static_assert(graded_correspondence_map<chosen_correspondence<2>>);
static_assert(weighted_correspondence_map<chosen_correspondence<3>>);
static_assert(graded_correspondence_map<chosen_correspondence<3>>);

using weighted_tokens = std::vector<std::pair<token_index, double>>;

template <class Map>
weighted_tokens tokens_of(Map const& map, frame_index i, typename Map::point_type const& point) {
    weighted_tokens tokens;
    map.visit_tokens(i, point, [&](token_index token, double weight) { tokens.emplace_back(token, weight); });
    return tokens;
}

/// Calls `compare(frame asked, chosen point, own point)` for every point that both maps show, which must be the same
/// ones, in every frame; returns how many.
template <std::size_t D, class Map, class Compare>
std::size_t for_each_point(chosen_correspondence<D> const& chosen, Map const& own, Compare const& compare) {
    REQUIRE(chosen.frame_count() == own.frame_count());
    REQUIRE(chosen.grid() == own.grid());
    std::size_t shown = 0;
    for (std::uint32_t i = 0; i < own.frame_count(); ++i) {
        for (std::uint32_t t = 0; t < own.grid().size(); ++t) {
            auto const point = chosen.point_at({i}, {t});
            auto const own_point = own.point_at({i}, {t});
            REQUIRE(point.has_value() == own_point.has_value());
            for (std::uint32_t j = 0; point && j < own.frame_count(); ++j) {
                compare(frame_index{j}, *point, *own_point);
                ++shown;
            }
        }
    }
    return shown;
}

} // namespace

TEST_SUITE("correspondence/chosen_correspondence") {
    TEST_CASE("footprints are what is chosen where nothing is said") {
        CHECK(correspondence_settings{}.kind == correspondence_kind::footprint);
    }

    TEST_CASE("[GR sec. 3.2] by footprints it is the footprint map token by token") {
        std::size_t compared = 0;
        std::size_t missing = 0;
        for (std::uint64_t seed = 0; seed < 3; ++seed) {
            auto const maps = testing::random_scene(seed, 3, {48, 48}, 3);
            // A reach of its own shows that the settings arrive.
            chosen_correspondence<2> const chosen(to_uv_view(maps), {12, 12}, {.footprint = {.reach = 0.4}});
            footprint_map const own(to_uv_view(maps), {12, 12}, {.reach = 0.4});
            compared += for_each_point(chosen, own, [&](frame_index j, auto const& point, auto const& own_point) {
                auto const token = own.token_at(j, own_point);
                CHECK(chosen.token_at(j, point) == token);
                CHECK(chosen.quality_at(j, point) == own.quality_at(j, own_point));
                CHECK(tokens_of(chosen, j, point) == (token ? weighted_tokens{{*token, 1.0}} : weighted_tokens{}));
                missing += token ? 0U : 1U;
            });
        }
        CHECK(compared > 500);
        CHECK(missing > 20);
    }

    TEST_CASE("[GR sec. 3.2] by texels it is the texel grid token by token") {
        for (auto const reading : {texel_reading::nearest_sample, texel_reading::average}) {
            std::size_t compared = 0;
            std::size_t missing = 0;
            std::size_t shared = 0;
            for (std::uint64_t seed = 0; seed < 3; ++seed) {
                auto const maps = testing::random_scene(seed, 3, {48, 48}, 3);
                texel_grid_settings const texels{.T = 9, .reading = reading};
                chosen_correspondence<2> const chosen(to_uv_view(maps), {12, 12},
                                                      {.kind = correspondence_kind::texel_grid, .texels = texels});
                texel_grid const own(to_uv_view(maps), {12, 12}, texels);
                compared += for_each_point(chosen, own, [&](frame_index j, auto const& point, auto const& own_point) {
                    auto const token = own.token_at(j, own_point);
                    auto const tokens = tokens_of(chosen, j, point);
                    CHECK(chosen.token_at(j, point) == token);
                    CHECK(tokens == tokens_of(own, j, own_point));
                    CHECK(chosen.quality_at(j, point) == (token ? 1 : 0)); // all alike
                    missing += token ? 0U : 1U;
                    shared += tokens.size() > 1 ? 1U : 0U;
                });
            }
            CHECK(compared > 500);
            CHECK(missing > 5);
            CHECK((shared > 0) == (reading == texel_reading::average));
        }
    }

    TEST_CASE("[GR sec. 3.2] matches of whole frames are told by footprints and not by texels") {
        auto const maps = testing::random_scene(8, 4, {48, 48}, 3);
        chosen_correspondence<2> const map(to_uv_view(maps), {12, 12}, {});
        std::vector<frame_index> const frames{{2}, {0}, {3}};
        auto const matches = map.matches({0}, frames);
        REQUIRE(matches.size() == 3);
        std::size_t shown = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            for (std::uint32_t t = 0; t < 144; ++t) {
                auto const point = map.point_at({0}, {t});
                auto const token = point ? map.token_at(frames[k], *point) : std::nullopt;
                REQUIRE((matches[k]->is_shown[t] != 0) == token.has_value());
                CHECK(matches[k]->tokens[t] == (token ? token->value : 0));
                CHECK(matches[k]->qualities[t] == (point ? map.quality_at(frames[k], *point) : 0));
                shown += token ? 1U : 0U;
            }
        }
        CHECK(shown > 90);
        chosen_correspondence<2> const texels(to_uv_view(maps), {12, 12}, {.kind = correspondence_kind::texel_grid});
        CHECK(texels.matches({0}, frames).empty());
    }

    TEST_CASE("[GR sec. 3.2] both kinds keep the laws") {
        for (std::uint64_t seed = 0; seed < 3; ++seed) {
            auto const maps = testing::random_scene(seed, 3, {48, 32}, 3);
            for (auto const kind : {correspondence_kind::footprint, correspondence_kind::texel_grid}) {
                chosen_correspondence<2> const map(to_uv_view(maps), {12, 8}, {.kind = kind});
                auto const laws = testing::check_correspondence_laws(map);
                CHECK(laws.text() == "");
                CHECK(laws.shown_tokens > 50);
            }
        }
    }

    TEST_CASE("rest positions correspond by footprints and are refused by texels") {
        // A plane in space that slides by two cells of 4 x 4 pixels.
        stack<float, 4> position({2, 16, 16, 3});
        stack<std::uint32_t, 3> const object({2, 16, 16});
        stack<std::uint8_t, 3> coverage({2, 16, 16});
        for (std::size_t i = 0; i < 2; ++i) {
            for (std::size_t row = 0; row < 16; ++row) {
                for (std::size_t column = 0; column < 16; ++column) {
                    position(i, row, column, 0) = static_cast<float>(column + 8 * i);
                    position(i, row, column, 2) = static_cast<float>(row);
                    coverage(i, row, column) = 1;
                }
            }
        }
        position_maps_view const maps(position.view(), object.view(), coverage.view());
        chosen_correspondence<3> const map(maps, {4, 4}, {.footprint = {.reach = 0.5}});
        for (std::uint32_t t = 0; t < 16; ++t) {
            auto const found = corresponding_token(map, {0}, {1}, {t});
            REQUIRE(found.has_value() == (t % 4 < 2));
            if (found) {
                CHECK(found->value == t + 2);
            }
        }
        auto const laws = testing::check_correspondence_laws(map);
        CHECK(laws.text() == "");
        CHECK(laws.shown_tokens == 32);
        CHECK_THROWS_WITH_AS(
            chosen_correspondence<3>(maps, {4, 4}, {.kind = correspondence_kind::texel_grid}),
            "chosen_correspondence: settings.kind is texel_grid, expected footprint for maps that are not UV maps",
            value_error);
    }

    TEST_CASE("what the map chosen refuses is refused in its words") {
        auto const maps = testing::random_scene(1, 1, {16, 16}, 1);
        CHECK_THROWS_WITH_AS(chosen_correspondence<2>(to_uv_view(maps), {5, 4}, {}),
                             "footprint_map: grid is [5, 4], expected extents that divide the maps' [16, 16]",
                             value_error);
        CHECK_THROWS_WITH_AS(chosen_correspondence<2>(to_uv_view(maps), {4, 4}, {.footprint = {.reach = 0}}),
                             "footprint_map: settings.reach is 0.000000, expected a number above 0", value_error);
        CHECK_THROWS_WITH_AS(
            chosen_correspondence<2>(to_uv_view(maps), {5, 4}, {.kind = correspondence_kind::texel_grid}),
            "texel_grid: grid is [5, 4], expected extents that divide the maps' [16, 16]", value_error);
    }

    TEST_CASE("threads compile what one compiles") {
        auto const maps = testing::random_scene(3, 4, {32, 32}, 3);
        for (auto const kind : {correspondence_kind::footprint, correspondence_kind::texel_grid}) {
            chosen_correspondence<2> const one(to_uv_view(maps), {8, 8}, {.kind = kind});
            chosen_correspondence<2> const two(to_uv_view(maps), {8, 8}, {.kind = kind}, threaded_loop(2));
            CHECK(for_each_point(one, two, [&](frame_index j, auto const& point, auto const& other) {
                      CHECK(one.token_at(j, point) == two.token_at(j, other));
                  }) > 50);
        }
    }
}
