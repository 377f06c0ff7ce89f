// SPDX-License-Identifier: MIT
// Sentences name figure, place and remedy.
#include <examples/support/recommendation_text.hpp>

#include <doctest/doctest.h>

#include <cstddef>
#include <cstdint>
#include <set>
#include <string>
#include <string_view>
#include <vector>

TEST_SUITE("examples_support/recommendation_text") {
    using namespace genrender;
    using namespace genrender::examples;
    using enum recommendation_kind;

    TEST_CASE("frames are told in ranges") {
        CHECK(ranges_text({}).empty());
        CHECK(ranges_text({{4}}) == "4");
        CHECK(ranges_text({{0}, {1}, {2}, {5}, {7}, {8}}) == "0-2, 5, 7-8");
        std::vector<frame_index> odd;
        for (std::uint32_t i = 1; i < 40; i += 2) {
            odd.push_back({i});
        }
        CHECK(ranges_text(odd) == "1, 3, 5, 7, 9, 11, 13, 15, ...");
    }

    TEST_CASE("sentences name the object with its share and what to do") {
        recommendation const one{.kind = mirrored, .figure = 0.48, .object = object_index{3}};
        CHECK(sentence_of(one) ==
              "UVs of object 3 are mirrored over 48 % of its pixels: use rest positions as canonical "
              "coordinates");
        CHECK(one.name() == "mirrored");
        CHECK_FALSE(one.forbids_run());
        recommendation const few{.kind = out_of_range, .figure = 0.004, .object = object_index{0}};
        CHECK(sentence_of(few) == "UVs of object 0 lie outside [0, 1] at less than 1 % of its pixels: say whether the "
                                  "texture repeats or ends there");
    }

    TEST_CASE("sentences name frames and grids") {
        CHECK(sentence_of(recommendation{.kind = nothing_visible, .figure = 3, .frames = {{2}, {3}, {4}}}) ==
              "nothing is visible in frames 2-4: leave them out, or look where the objects are");
        CHECK(sentence_of(recommendation{.kind = low_coverage, .figure = 0.55, .grid = grid_extents{64, 32}}) ==
              "keyframes cover 55 % of the tokens of grid 64x32: draw more keyframes");
        recommendation const refused{.kind = grid_refused, .grid = grid_extents{7, 7}, .detail = "footprint_map: no"};
        CHECK(sentence_of(refused) == "grid 7x7 cannot be used: footprint_map: no");
        CHECK(refused.forbids_run());
    }

    TEST_CASE("sentences of what a run refuses say why") {
        CHECK(
            sentence_of({.kind = not_finite, .figure = 2, .object = object_index{0}, .frames = {{2}, {3}}}) ==
            "coordinates of object 0 are NaN or infinite at 2 pixels of frames 2-3, which a run refuses: mark them as "
            "background or write them again");
        CHECK(sentence_of({.kind = keyframes_refused, .detail = "draw_keyframes: count is 4, expected"}) ==
              "keyframes cannot be drawn: draw_keyframes: count is 4, expected");
    }

    TEST_CASE("every kind has a name and a sentence of its own") {
        std::set<std::string> sentences;
        std::set<std::string_view> names;
        for (std::size_t k = 0; k < recommendation_names.size(); ++k) {
            recommendation const one{.kind = static_cast<recommendation_kind>(k), .figure = 0.5, .frames = {{1}}};
            CHECK(sentence_of(one).size() > 20);
            CHECK(sentence_of(one).find("--") == std::string::npos); // programs have options, the library has none
            sentences.insert(sentence_of(one));
            names.insert(one.name());
        }
        CHECK(sentences.size() == recommendation_names.size());
        CHECK(names.size() == recommendation_names.size());
        CHECK(recommendation{.kind = maps_finer_than_needed}.name() == "maps_finer_than_needed");
    }
}
