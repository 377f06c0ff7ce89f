// SPDX-License-Identifier: MIT
// Sheets of frames and their labels, pixel by pixel.
#include <examples/support/contact_sheet.hpp>

#include <doctest/doctest.h>

#include <set>

using namespace genrender;
using namespace genrender::examples;

namespace {

std::vector<rgb8_image> frames(std::size_t count, grid_extents grid) {
    std::vector<rgb8_image> result;
    for (std::size_t i = 0; i < count; ++i) {
        result.emplace_back(grid, rgb8{static_cast<std::uint8_t>(i + 1), 0, 0});
    }
    return result;
}

} // namespace

TEST_SUITE("examples_support/contact_sheet") {
    TEST_CASE("frames lie row by row with a margin around each") {
        auto const sheet =
            contact_sheet(frames(5, {2, 3}), {.columns = 2, .margin = 1, .enlargement = 2, .paper = {7, 7, 7}});
        CHECK(sheet.grid() == grid_extents{3 * 5 + 1, 2 * 7 + 1});
        CHECK(sheet.at(0, 0) == rgb8{7, 7, 7});
        CHECK(sheet.at(1, 1) == rgb8{1, 0, 0});
        CHECK(sheet.at(4, 6) == rgb8{1, 0, 0});
        CHECK(sheet.at(4, 7) == rgb8{7, 7, 7});
        CHECK(sheet.at(1, 8) == rgb8{2, 0, 0});
        CHECK(sheet.at(11, 1) == rgb8{5, 0, 0});
        CHECK(sheet.at(11, 8) == rgb8{7, 7, 7});
    }

    TEST_CASE("without a number of columns the sheet is about square") {
        CHECK(contact_sheet(frames(16, {8, 8}), {.margin = 0}).grid() == grid_extents{32, 32});
        CHECK(contact_sheet(frames(3, {100, 8}), {.margin = 0}).grid() == grid_extents{100, 24});
        CHECK(contact_sheet(frames(3, {8, 100}), {.margin = 0}).grid() == grid_extents{24, 100});
    }

    TEST_CASE("labels stand below their frames and end at their width") {
        auto const sheet =
            contact_sheet(frames(2, {4, 8}), {.columns = 2, .margin = 0, .labels = {"HHH", ""}, .ink = {9, 9, 9}});
        CHECK(sheet.grid() == grid_extents{13, 16});
        CHECK(sheet.at(5, 1) == rgb8{9, 9, 9}); // the left stem of H
        CHECK(sheet.at(5, 5) == rgb8{9, 9, 9}); // its right stem
        CHECK(sheet.at(5, 7) == rgb8{9, 9, 9}); // the second H's left stem, the rest is cut
        for (std::size_t row = 4; row < 13; ++row) {
            for (std::size_t column = 8; column < 16; ++column) {
                CHECK(sheet.at(row, column) == rgb8{48, 48, 48});
            }
        }
    }

    TEST_CASE("every printable character has a look of its own within five columns") {
        std::set<std::array<std::uint8_t, 7>> looks;
        for (char c = ' '; c <= '~'; ++c) {
            looks.insert(glyph(c));
            for (auto const row : glyph(c)) {
                CHECK(row < 32);
            }
        }
        CHECK(looks.size() == 95);
        CHECK(glyph('\n') == glyph('?'));
        CHECK(glyph(static_cast<char>(200)) == glyph('?'));
    }

    TEST_CASE("frames that do not fit each other are refused") {
        CHECK_THROWS_WITH_AS(contact_sheet({}), "contact_sheet: frames is empty, expected at least one frame",
                             value_error);
        auto mixed = frames(2, {4, 4});
        mixed[1] = rgb8_image({4, 5}, {0, 0, 0});
        CHECK_THROWS_WITH_AS(contact_sheet(mixed), "contact_sheet: frames is [4, 5], expected [4, 4]", shape_error);
        CHECK_THROWS_WITH_AS(contact_sheet(frames(2, {4, 4}), {.labels = {"one"}}),
                             "contact_sheet: labels is [1], expected [2]", shape_error);
    }
}
