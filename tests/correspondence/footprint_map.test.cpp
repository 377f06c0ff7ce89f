// SPDX-License-Identifier: MIT
// [GR sec. 3.2] Tokens that meet where a surface point lies under a cell: by hand, by search and on a rasterised scene.
#include <genrender/correspondence/footprint_map.hpp>

#include <genrender/testing/correspondence_laws.hpp>
#include "../support/random_scene.hpp"
#include "../support/small_maps.hpp"

#include <genrender/core/stack.hpp>
#include <genrender/correspondence/reproject.hpp>
#include <genrender/evaluation/pixel_correspondence.hpp>
#include <genrender/scene/rasterizer.hpp>
#include <genrender/scene/animation.hpp>
#include <genrender/scene/primitives.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <type_traits>
#include <utility>
#include <vector>

using namespace genrender;

namespace {

/// A place of a map in map pixels from its upper left corner.
struct map_place {
    double x, y;
};

/// UV maps of object 0 alone, which fills every frame: frame i shows `uv(i, middle of the pixel)`.
template <class Uv>
uv_maps filled_uv_maps(std::size_t frames, grid_extents grid, Uv const& uv) {
    uv_maps maps(frames, grid);
    maps.coverage.fill(1);
    for (std::size_t i = 0; i < frames; ++i) {
        for (std::size_t row = 0; row < grid.height; ++row) {
            for (std::size_t column = 0; column < grid.width; ++column) {
                std::array<double, 2> const at =
                    uv(i, map_place{static_cast<double>(column) + 0.5, static_cast<double>(row) + 0.5});
                maps.uv(i, row, column, 0) = static_cast<float>(at[0]);
                maps.uv(i, row, column, 1) = static_cast<float>(at[1]);
            }
        }
    }
    return maps;
}

/// The same in rest positions.
struct space_maps {
    stack<float, 4> position;
    stack<std::uint32_t, 3> object;
    stack<std::uint8_t, 3> coverage;

    template <class Place>
    space_maps(std::size_t frames, grid_extents grid, Place const& place)
        : position({frames, grid.height, grid.width, 3}), object({frames, grid.height, grid.width}),
          coverage({frames, grid.height, grid.width}) {
        for (std::size_t i = 0; i < frames; ++i) {
            for (std::size_t row = 0; row < grid.height; ++row) {
                for (std::size_t column = 0; column < grid.width; ++column) {
                    std::array<double, 3> const at =
                        place(i, map_place{static_cast<double>(column) + 0.5, static_cast<double>(row) + 0.5});
                    for (std::size_t d = 0; d < 3; ++d) {
                        position(i, row, column, d) = static_cast<float>(at[d]);
                    }
                    coverage(i, row, column) = 1;
                }
            }
        }
    }

    position_maps_view view() const { return {position.view(), object.view(), coverage.view()}; }
};

/// The middle of a token in a grid of that many columns, in tokens.
map_place middle_of(token_index token, std::size_t columns) {
    auto const width = static_cast<std::uint32_t>(columns);
    return {token.value % width + 0.5, token.value / width + 0.5};
}

/// How many tokens of frame `to` find one in frame `from`.
template <class Map>
std::size_t count_found(Map const& map, frame_index from, frame_index to) {
    std::size_t found = 0;
    for (std::uint32_t t = 0; t < map.grid().size(); ++t) {
        found += corresponding_token(map, from, to, {t}) ? 1U : 0U;
    }
    return found;
}

/// Things on a round floor, seen by a camera that goes around them and nearer; a model of animation.
struct turning_table {
    std::vector<posed_object> objects;

    turning_table() {
        place(make_disk(6, 64), {0, 0, 0});
        place(make_sphere(0.9F, 48), {0, 0.9F, 0});
        place(make_box({0.9F, 1.5F, 0.9F}), {-1.6F, 0.75F, 0.5F});
        place(make_capsule(0.4F, 0.9F, 32), {1.5F, 0.85F, 0.4F});
        place(make_sphere(0.35F, 32), {0.4F, 0.35F, 1.6F});
    }
    std::size_t frame_count() const { return 6; }
    posed_scene frame(frame_index i) const {
        auto const time = static_cast<float>(i.value);
        auto const angle = 0.3F + 0.14F * time;
        auto const distance = 5.8F - 0.15F * time;
        auto const eye = glm::vec3(distance * std::sin(angle), 2.4F, distance * std::cos(angle));
        return {look_at(eye, {0, 0.8F, 0}, 0.75F), objects};
    }

private:
    void place(mesh surface, glm::vec3 at) {
        object_index const number{static_cast<std::uint32_t>(objects.size())};
        auto shared = std::make_shared<mesh const>(std::move(surface));
        objects.push_back(pose(number, std::move(shared), glm::translate(glm::mat4(1), at)));
    }
};

static_assert(correspondence_map<footprint_map<2>>);
static_assert(correspondence_map<footprint_map<3>>);
static_assert(graded_correspondence_map<footprint_map<2>>);
static_assert(!weighted_correspondence_map<footprint_map<2>>);
static_assert(std::is_same_v<decltype(footprint_map(std::declval<uv_maps_view>(), grid_extents{})), footprint_map<2>>);
static_assert(
    std::is_same_v<decltype(footprint_map(std::declval<position_maps_view>(), grid_extents{})), footprint_map<3>>);

} // namespace

TEST_SUITE("correspondence/footprint_map") {
    TEST_CASE("[GR sec. 3.2] random scenes keep the laws at every grid") {
        std::size_t shown_in_all = 0;
        for (std::uint64_t seed = 0; seed < 4; ++seed) {
            auto const maps = testing::random_scene(seed, 3, {48, 64}, 3);
            for (auto const grid :
                 {grid_extents{48, 64}, {24, 32}, {16, 16}, {12, 16}, {6, 8}, {3, 4}, {1, 1}, {48, 1}}) {
                footprint_map const map(to_uv_view(maps), grid);
                CHECK(map.grid() == grid);
                std::size_t expected = 0;
                for (std::uint32_t i = 0; i < 3; ++i) {
                    for (std::uint32_t t = 0; t < grid.size(); ++t) {
                        expected += representative_pixel(to_uv_view(maps), {i}, grid, {t}) ? 1U : 0U;
                    }
                }
                auto const laws = testing::check_correspondence_laws(map);
                CHECK(laws.text() == "");
                CHECK(laws.shown_tokens == expected);
                shown_in_all += laws.shown_tokens;
            }
        }
        CHECK(shown_in_all > 10000);
    }

    TEST_CASE("[GR sec. 3.2] a token finds itself in its own frame and in one that is the same") {
        for (auto const grid : {grid_extents{48, 48}, {16, 16}, {12, 12}, {6, 6}, {2, 3}}) {
            auto maps = testing::random_scene(7, 2, {48, 48}, 3);
            for (std::size_t e = 0; e < 48 * 48; ++e) {
                maps.uv.data()[2 * (48 * 48 + e)] = maps.uv.data()[2 * e];
                maps.uv.data()[2 * (48 * 48 + e) + 1] = maps.uv.data()[2 * e + 1];
                maps.object.data()[48 * 48 + e] = maps.object.data()[e];
                maps.coverage.data()[48 * 48 + e] = maps.coverage.data()[e];
            }
            footprint_map const map(to_uv_view(maps), grid);
            std::size_t shown = 0;
            for (std::uint32_t t = 0; t < grid.size(); ++t) {
                if (map.point_at({0}, {t})) {
                    CHECK(corresponding_token(map, {0}, {0}, {t}) == token_index{t});
                    CHECK(corresponding_token(map, {1}, {0}, {t}) == token_index{t});
                    ++shown;
                }
            }
            CHECK(shown > grid.size() / 4);
        }
    }

    TEST_CASE("[GR sec. 3.2] a plane that slides by whole cells corresponds cell by cell") {
        // Cells of 4 x 4 pixels; frame i shows what frame 0 shows `slides[i]` cells further right and down.
        std::array<std::array<int, 2>, 5> const slides{{{0, 0}, {2, 0}, {0, 1}, {-3, 2}, {1, -1}}};
        auto const maps = filled_uv_maps(5, {16, 32}, [&](std::size_t i, map_place p) {
            return std::array{(p.x + 4 * slides[i][0] + 20) / 80, (p.y + 4 * slides[i][1] + 20) / 80};
        });
        footprint_map const map(to_uv_view(maps), {4, 8}, {.reach = 0.5});
        for (std::uint32_t i = 0; i < 5; ++i) {
            for (int row = 0; row < 4; ++row) {
                for (int column = 0; column < 8; ++column) {
                    auto const there_row = row + slides[i][1];
                    auto const there_column = column + slides[i][0];
                    auto const is_seen = there_row >= 0 && there_row < 4 && there_column >= 0 && there_column < 8;
                    auto const found =
                        corresponding_token(map, {0}, {i}, {static_cast<std::uint32_t>(row * 8 + column)});
                    REQUIRE(found.has_value() == is_seen);
                    if (found) {
                        CHECK(found->value == static_cast<std::uint32_t>(there_row * 8 + there_column));
                    }
                }
            }
        }
    }

    TEST_CASE("reach is told in half cells from the last pixel that is seen") {
        // Tokens of frame 1 show the columns 9, 13, ..., 33, 37 of frame 0, whose last is column 31: the points of its
        // last two tokens lie one and three half cells beyond.
        auto const maps = filled_uv_maps(2, {8, 32}, [](std::size_t i, map_place p) {
            return std::array{(p.x + 8.0 * static_cast<double>(i)) / 64, p.y / 64};
        });
        auto const found = [&](double reach, std::uint32_t token) {
            footprint_map const map(to_uv_view(maps), {2, 8}, {.reach = reach});
            return corresponding_token(map, {0}, {1}, {token});
        };
        CHECK(found(0.01, 5) == token_index{7});
        CHECK_FALSE(found(0.99, 6).has_value());
        CHECK(found(1.01, 6) == token_index{7});
        CHECK_FALSE(found(2.99, 7).has_value());
        CHECK(found(3.01, 7) == token_index{7});
    }

    TEST_CASE("reach is told along each axis of cells that are not square") {
        // Cells of 2 x 8 pixels; the frame goes on for one pixel below and for three on the right.
        auto const maps = filled_uv_maps(3, {8, 32}, [](std::size_t i, map_place p) {
            return std::array{(p.x + (i == 1 ? 12 : 0)) / 64, (p.y + (i == 2 ? 3 : 0)) / 64};
        });
        footprint_map const map(to_uv_view(maps), {4, 4});
        // Column 3 + 24 + 12 = 39, eight pixels or two half cells beyond 31.
        CHECK_FALSE(corresponding_token(map, {0}, {1}, {3}).has_value());
        CHECK(corresponding_token(map, {0}, {1}, {2}) == token_index{3}); // column 31
        // Row 0 + 6 + 3 = 9, two pixels or two half cells beyond 7; row 7 belongs to the last cell.
        CHECK_FALSE(corresponding_token(map, {0}, {2}, {12}).has_value());
        CHECK(corresponding_token(map, {0}, {2}, {8}) == token_index{12});
    }

    TEST_CASE("[GR supplement: effect of texture resolution] tokens of a surface twice as near still meet") {
        // Frame 1 shows the upper left quarter of frame 0 twice as large.
        auto const maps = filled_uv_maps(2, {32, 32}, [](std::size_t i, map_place p) {
            auto const scale = i == 0 ? 1.0 / 40 : 0.5 / 40;
            return std::array{0.1 + p.x * scale, 0.1 + p.y * scale};
        });
        footprint_map const map(to_uv_view(maps), {8, 8});
        for (std::uint32_t row = 0; row < 8; ++row) {
            for (std::uint32_t column = 0; column < 8; ++column) {
                token_index const here{row * 8 + column};
                CHECK(corresponding_token(map, {0}, {1}, here) == token_index{row / 2 * 8 + column / 2});
                if (row < 4 && column < 4) {
                    CHECK(corresponding_token(map, {1}, {0}, here) == token_index{row * 2 * 8 + column * 2});
                } else {
                    CHECK_FALSE(corresponding_token(map, {1}, {0}, here).has_value());
                }
            }
        }
    }

    TEST_CASE("every point is shown by the cell of the pixel closest to it on the screen") {
        // Textures of the scene are affine, so a search through all pixels is easy; cells of 4 x 4 keep every pixel.
        std::size_t compared = 0;
        std::size_t missed = 0;
        double worst = 0;
        for (std::uint64_t seed = 20; seed < 24; ++seed) {
            auto const maps = testing::random_scene(seed, 2, {48, 64}, 3);
            auto const view = to_uv_view(maps);
            footprint_map const map(view, {12, 16});
            for (std::uint32_t t = 0; t < 12 * 16; ++t) {
                auto const point = map.point_at({0}, {t});
                if (!point || !point->footprint) {
                    continue;
                }
                // Half cells to the closest pixel of the frame, and to that of the cell found.
                auto const found = map.token_at({1}, *point);
                auto closest = std::numeric_limits<double>::infinity();
                auto closest_in_cell = closest;
                for (std::uint32_t row = 0; row < 48; ++row) {
                    for (std::uint32_t column = 0; column < 64; ++column) {
                        pixel const p{row, column};
                        if (!view.is_covered({1}, p) || view.object_at({1}, p) != point->object) {
                            continue;
                        }
                        auto const footprint = footprint_at(view, {1}, p);
                        auto const offset =
                            offset_on(footprint.value_or(*point->footprint), view.point_at({1}, p), point->place);
                        auto const distance = std::max(std::abs(offset.right), std::abs(offset.down)) / 2;
                        closest = std::min(closest, distance);
                        if (found && row / 4 * 16 + column / 4 == found->value) {
                            closest_in_cell = std::min(closest_in_cell, distance);
                        }
                    }
                }
                if (closest < 0.999) {
                    missed += found ? 0U : 1U;
                } else if (closest > 1.001) {
                    CHECK_FALSE(found.has_value());
                }
                if (found) {
                    worst = std::max(worst, closest_in_cell - closest);
                    ++compared;
                }
            }
        }
        CHECK(compared > 200);
        CHECK(missed == 0);
        CHECK(worst < 1e-3);
    }

    TEST_CASE("closest is told on the screen and not on the texture") {
        // A row is three times as far as a column on the texture. The upper left quarter of frame 0 is not seen; the
        // first token of frame 1 shows the place of its pixel (7, 14): pixel (7, 16) is two pixels off and closest on
        // the texture, pixel (8, 14) is one pixel off.
        auto maps = filled_uv_maps(2, {16, 32}, [](std::size_t i, map_place p) {
            return std::array{(p.x + 13 * static_cast<double>(i)) / 128, 3 * (p.y + 6 * static_cast<double>(i)) / 128};
        });
        for (std::size_t row = 0; row < 8; ++row) {
            for (std::size_t column = 0; column < 16; ++column) {
                maps.coverage(0, row, column) = 0;
            }
        }
        footprint_map const map(to_uv_view(maps), {4, 8}, {.reach = 2});
        CHECK(corresponding_token(map, {0}, {1}, {0}) == token_index{2 * 8 + 3});
    }

    TEST_CASE("objects that share every part of a cell all have samples") {
        // Columns of two objects in turn under cells of 8 x 8 pixels; frame 1 shows object 1 alone, frame 2 object 0.
        auto maps = filled_uv_maps(3, {16, 16}, [](std::size_t, map_place p) {
            return std::array{p.x / 16, p.y / 16};
        });
        for (std::size_t row = 0; row < 16; ++row) {
            for (std::size_t column = 0; column < 16; ++column) {
                maps.object(0, row, column) = column % 2 == 0 ? 0 : 1;
                maps.object(1, row, column) = 1;
            }
        }
        footprint_map const map(to_uv_view(maps), {2, 2});
        CHECK(count_found(map, {0}, {1}) == 4);
        CHECK(count_found(map, {0}, {2}) == 4);
    }

    TEST_CASE("what a token shows is found in its own frame at the shortest reach") {
        auto const maps = testing::random_scene(2, 2, {48, 64}, 3);
        for (auto const grid : {grid_extents{12, 16}, {6, 8}, {3, 4}}) {
            footprint_map const map(to_uv_view(maps), grid, {.reach = 1e-6});
            auto const laws = testing::check_correspondence_laws(map);
            CHECK(laws.text() == "");
            CHECK(laws.shown_tokens > grid.size() / 2);
        }
    }

    TEST_CASE("equal UVs of different objects never correspond") {
        auto maps = filled_uv_maps(2, {16, 16}, [](std::size_t, map_place p) {
            return std::array{p.x / 16, p.y / 16};
        });
        footprint_map const same(to_uv_view(maps), {4, 4});
        CHECK(count_found(same, {0}, {1}) == 16);
        std::fill(maps.object.data() + 256, maps.object.data() + 512, 1U + (1U << 31));
        std::fill(maps.object.data(), maps.object.data() + 256, 1U);
        footprint_map const map(to_uv_view(maps), {4, 4});
        CHECK(count_found(map, {0}, {1}) == 0);
        CHECK(count_found(map, {1}, {0}) == 0);
    }

    TEST_CASE("a token found shows the object asked for somewhere in its cell") {
        std::size_t found_in_all = 0;
        for (std::uint64_t seed = 0; seed < 3; ++seed) {
            auto const maps = testing::random_scene(seed, 4, {48, 48}, 4);
            footprint_map const map(to_uv_view(maps), {12, 12});
            for (std::uint32_t i = 1; i < 4; ++i) {
                for (std::uint32_t t = 0; t < 144; ++t) {
                    auto const found = corresponding_token(map, {0}, {i}, {t});
                    if (!found) {
                        continue;
                    }
                    auto const object = map.point_at({i}, {t})->object.value;
                    std::size_t owned = 0;
                    for (std::size_t e = 0; e < 16; ++e) {
                        auto const row = found->value / 12 * 4 + e / 4;
                        auto const column = found->value % 12 * 4 + e % 4;
                        owned += maps.coverage(0, row, column) != 0 && maps.object(0, row, column) == object ? 1U : 0U;
                    }
                    CHECK(owned > 0);
                    ++found_in_all;
                }
            }
        }
        CHECK(found_in_all > 300);
    }

    TEST_CASE("what is hidden in a frame is not found there") {
        auto maps = filled_uv_maps(2, {16, 32}, [](std::size_t, map_place p) {
            return std::array{p.x / 32, p.y / 32};
        });
        for (std::size_t row = 0; row < 16; ++row) {
            for (std::size_t column = 0; column < 16; ++column) {
                maps.object(1, row, column) = 1;
            }
        }
        footprint_map const map(to_uv_view(maps), {4, 8}, {.reach = 0.5});
        for (std::uint32_t t = 0; t < 32; ++t) {
            CHECK(corresponding_token(map, {1}, {0}, {t}).has_value() == (t % 8 > 3));
        }
    }

    TEST_CASE("the two halves of a mirrored texture do not meet") {
        // An object 32 pixels wide whose halves share their texture, mirrored about the middle line. Frame 0 shows the
        // left half alone, frames 1 and 2 the right half alone: at exactly the same UVs, and a third of a pixel moved.
        auto maps = filled_uv_maps(4, {16, 32}, [](std::size_t i, map_place p) {
            auto const slide = i == 2 ? 1.0 / 3 : i == 3 ? 4.0 : 0.0;
            return std::array{std::abs(p.x + slide - 16) / 32, p.y / 32};
        });
        for (std::size_t row = 0; row < 16; ++row) {
            for (std::size_t column = 0; column < 16; ++column) {
                maps.coverage(0, row, column + 16) = 0;
                maps.coverage(1, row, column) = 0;
                maps.coverage(2, row, column) = 0;
            }
        }
        footprint_map const map(to_uv_view(maps), {4, 8});
        CHECK(count_found(map, {1}, {0}) == 0);
        CHECK(count_found(map, {2}, {0}) == 0);
        CHECK(count_found(map, {0}, {1}) == 0);
        CHECK(count_found(map, {0}, {2}) == 0);
        CHECK(count_found(map, {1}, {2}) == 16);
        // Frame 3 shows both halves one cell further left: each meets its own.
        for (std::uint32_t t = 0; t < 32; ++t) {
            auto const is_left = t % 8 < 4;
            auto const found = corresponding_token(map, {3}, {is_left ? 0U : 1U}, {t});
            if (t % 8 > 0) {
                REQUIRE(found.has_value());
                CHECK(found->value == t - 1);
            } else {
                CHECK_FALSE(found.has_value());
            }
        }
    }

    TEST_CASE("rest positions tell places apart whose UVs overlap") {
        // Frames 0 and 2 show the first tile of a repeated texture, frame 1 the second.
        auto const tiled = filled_uv_maps(3, {16, 16}, [](std::size_t, map_place p) {
            return std::array{p.x / 16, p.y / 16};
        });
        footprint_map const by_uv(to_uv_view(tiled), {4, 4});
        CHECK(count_found(by_uv, {1}, {0}) == 16);
        space_maps const at_rest(3, {16, 16}, [](std::size_t i, map_place p) {
            return std::array{p.x + (i == 1 ? 32.0 : 0.0), p.y, 1.0};
        });
        footprint_map const by_position(at_rest.view(), {4, 4});
        CHECK(count_found(by_position, {1}, {0}) == 0);
        CHECK(count_found(by_position, {2}, {0}) == 16);
        auto const laws = testing::check_correspondence_laws(by_position);
        CHECK(laws.text() == "");
        CHECK(laws.shown_tokens == 48);
    }

    TEST_CASE("a seam of the texture joins nothing and parts nothing") {
        // u leaps from 1 to 0 inside the frame, and the texture goes around by four cells and a pixel.
        auto const maps = filled_uv_maps(2, {16, 64}, [](std::size_t i, map_place p) {
            auto const u = (p.x + 30 + 17 * static_cast<double>(i)) / 64;
            return std::array{u - std::floor(u), p.y / 64};
        });
        footprint_map const map(to_uv_view(maps), {4, 16});
        for (std::uint32_t t = 0; t < 64; ++t) {
            CHECK(corresponding_token(map, {0}, {1}, {t}) == token_index{t / 16 * 16 + (t % 16 + 4) % 16});
        }
    }

    TEST_CASE("the two sides of a thin sheet do not meet") {
        // Pixels are 0.1 wide. Frames 0 and 1 see the sheet from the front, frames 2 and 3 from behind: without
        // thickness, where both sides have the same places, and 0.01 thick.
        space_maps const maps(4, {16, 16}, [](std::size_t i, map_place p) {
            auto const x = (i == 1 ? p.x + 4 : i > 1 ? 16 - p.x : p.x) * 0.1;
            return std::array{x, p.y * 0.1, i == 3 ? -0.01 : 0.0};
        });
        footprint_map const map(maps.view(), {4, 4}, {.reach = 0.5});
        CHECK(count_found(map, {2}, {0}) == 0);
        CHECK(count_found(map, {3}, {0}) == 0);
        CHECK(count_found(map, {0}, {2}) == 0);
        CHECK(count_found(map, {0}, {3}) == 0);
        CHECK(count_found(map, {2}, {3}) == 16);
        CHECK(count_found(map, {1}, {0}) == 12); // the same side one cell further left
    }

    TEST_CASE("layers that face the same way meet up to half a cell apart") {
        // A cell is 0.4 wide.
        space_maps const maps(3, {16, 16}, [](std::size_t i, map_place p) {
            return std::array{p.x * 0.1, p.y * 0.1, i == 1 ? 0.19 : i == 2 ? 0.21 : 0.0};
        });
        footprint_map const map(maps.view(), {4, 4});
        CHECK(count_found(map, {1}, {0}) == 16);
        CHECK(count_found(map, {2}, {0}) == 0);
    }

    TEST_CASE("an object seen by one pixel is found and nothing is known of its quality") {
        // Frame 0 shows one pixel of object 0 on object 1, frame 1 object 0 all over, each at the same texture
        // coordinates. Tokens of frame 1 show the pixels (1, 1), (1, 5), (5, 1) and (5, 5); half a cell is two pixels.
        auto const maps =
            testing::drawn_maps({"bbbbbbbb bbbbbbbb bbabbbbb bbbbbbbb bbbbbbbb bbbbbbbb bbbbbbbb bbbbbbbb",
                                 "aaaaaaaa aaaaaaaa aaaaaaaa aaaaaaaa aaaaaaaa aaaaaaaa aaaaaaaa aaaaaaaa"});
        footprint_map const map(to_uv_view(maps), {2, 2});
        CHECK(corresponding_token(map, {0}, {1}, {0}) == token_index{0}); // a pixel away
        CHECK_FALSE(corresponding_token(map, {0}, {1}, {1}).has_value()); // three pixels away
        CHECK_FALSE(corresponding_token(map, {0}, {1}, {2}).has_value());
        CHECK_FALSE(corresponding_token(map, {0}, {1}, {3}).has_value());
        auto const point = *map.point_at({1}, {0});
        CHECK(map.quality_at({0}, point) == 0);
        CHECK(map.quality_at({1}, point) > 0);
    }

    TEST_CASE("two isolated pixels meet at one place alone") {
        auto const maps = testing::drawn_maps({".... .a.. .... ....", ".... .a.. .... ....", ".... ..a. .... ...."});
        footprint_map const map(to_uv_view(maps), {4, 4});
        CHECK_FALSE(map.point_at({0}, {5})->footprint.has_value());
        CHECK(corresponding_token(map, {1}, {0}, {5}) == token_index{5});
        CHECK_FALSE(corresponding_token(map, {2}, {0}, {5}).has_value()); // no footprint tells how far they are
        auto const laws = testing::check_correspondence_laws(map);
        CHECK(laws.text() == "");
        CHECK(laws.shown_tokens == 3);
    }

    TEST_CASE("an animation that shows nothing has no points") {
        uv_maps const maps(2, {4, 4});
        footprint_map const map(to_uv_view(maps), {2, 2});
        auto const laws = testing::check_correspondence_laws(map);
        CHECK(laws.text() == "");
        CHECK(laws.shown_tokens == 0);
        footprint_map<2>::point_type const point{{0}, {0.5F, 0.5F}, surface_footprint<2>{{1, 0}, {0, 1}}};
        CHECK_FALSE(map.token_at({1}, point).has_value());
        CHECK(map.quality_at({1}, point) == 0);
    }

    TEST_CASE("one frame corresponds with itself and every frame of a still one with every other") {
        auto const maps = filled_uv_maps(3, {16, 16}, [](std::size_t, map_place p) {
            return std::array{p.x / 16, p.y / 16};
        });
        footprint_map const still(to_uv_view(maps), {4, 4});
        auto const one = filled_uv_maps(1, {16, 16}, [](std::size_t, map_place p) {
            return std::array{p.x / 16, p.y / 16};
        });
        footprint_map const alone(to_uv_view(one), {4, 4});
        CHECK(alone.frame_count() == 1);
        CHECK(alone.grid() == grid_extents{4, 4});
        for (std::uint32_t t = 0; t < 16; ++t) {
            CHECK(corresponding_token(alone, {0}, {0}, {t}) == token_index{t});
            for (std::uint32_t i = 0; i < 3; ++i) {
                CHECK(corresponding_token(still, {i}, {2 - i}, {t}) == token_index{t});
            }
        }
    }

    TEST_CASE("quality counts the pixels that a surface fills") {
        // Frame 1 shows everything twice as large, frame 2 half as high.
        auto const maps = filled_uv_maps(3, {32, 32}, [](std::size_t i, map_place p) {
            return std::array{p.x * (i == 1 ? 0.5 : 1) / 128, p.y * (i == 1 ? 0.5 : i == 2 ? 2 : 1) / 128};
        });
        footprint_map const map(to_uv_view(maps), {8, 8});
        auto const point = *map.point_at({0}, {0});
        CHECK(map.quality_at({0}, point) == doctest::Approx(128 * 128));
        CHECK(map.quality_at({1}, point) == doctest::Approx(4 * 128 * 128));
        CHECK(map.quality_at({2}, point) == doctest::Approx(0.5 * 128 * 128));
    }

    TEST_CASE("quality falls with the share of the cell that another object owns and is 0 where nothing is seen") {
        // Object 0 keeps all of each cell in frame 0, a quarter in frame 1, and its left half in frame 2.
        auto maps = filled_uv_maps(3, {16, 16}, [](std::size_t, map_place p) {
            return std::array{p.x / 16, p.y / 16};
        });
        for (std::size_t row = 0; row < 16; ++row) {
            for (std::size_t column = 0; column < 16; ++column) {
                maps.object(1, row, column) = row % 4 < 2 && column % 4 < 2 ? 0 : 1;
                maps.object(2, row, column) = column < 8 ? 0 : 1;
            }
        }
        footprint_map const map(to_uv_view(maps), {4, 4}, {.reach = 0.5});
        auto const left = *map.point_at({0}, {0});
        auto const right = *map.point_at({0}, {3});
        CHECK(map.quality_at({0}, left) == doctest::Approx(256));
        CHECK(map.quality_at({1}, left) == doctest::Approx(64));
        CHECK(map.quality_at({2}, left) == doctest::Approx(256));
        CHECK(map.quality_at({1}, right) == doctest::Approx(64));
        CHECK_FALSE(map.token_at({2}, right).has_value());
        CHECK(map.quality_at({2}, right) == 0);
    }

    TEST_CASE("threads that make frames in turn find what one finds") {
        auto const maps = testing::random_scene(6, 8, {64, 64}, 4);
        footprint_map const one(to_uv_view(maps), {16, 16});
        std::vector<frame_index> const KF{{5}, {0}, {7}};
        for (std::size_t const frames : {0U, 1U, 8U}) {
            footprint_map const many(to_uv_view(maps), {16, 16}, {.match_cache_bytes = 0, .cached_frames = frames});
            std::vector<std::vector<std::shared_ptr<token_matches const>>> found(64);
            threaded_loop(4)(64,
                             [&](std::size_t n) { found[n] = many.matches({static_cast<std::uint32_t>(n % 8)}, KF); });
            for (std::size_t n = 0; n < 64; ++n) {
                auto const expected = one.matches({static_cast<std::uint32_t>(n % 8)}, KF);
                for (std::size_t k = 0; k < 3; ++k) {
                    CHECK(found[n][k]->tokens == expected[k]->tokens);
                    CHECK(found[n][k]->is_shown == expected[k]->is_shown);
                    CHECK(found[n][k]->qualities == expected[k]->qualities);
                }
            }
        }
    }

    TEST_CASE("threads read maps as one does") {
        auto const maps = testing::random_scene(5, 4, {64, 64}, 4);
        footprint_map const one(to_uv_view(maps), {16, 16});
        footprint_map const two(to_uv_view(maps), {16, 16}, footprint_map_settings{}, threaded_loop(2));
        std::size_t shown = 0;
        for (std::uint32_t i = 0; i < 4; ++i) {
            for (std::uint32_t t = 0; t < 256; ++t) {
                auto const point = one.point_at({i}, {t});
                REQUIRE(point.has_value() == two.point_at({i}, {t}).has_value());
                if (point) {
                    CHECK(one.token_at({(i + 1) % 4}, *point) == two.token_at({(i + 1) % 4}, *point));
                    CHECK(one.quality_at({(i + 1) % 4}, *point) == two.quality_at({(i + 1) % 4}, *point));
                    ++shown;
                }
            }
        }
        CHECK(shown > 300);
    }

    TEST_CASE("what cannot be is refused with a sentence") {
        auto maps = filled_uv_maps(1, {16, 32}, [](std::size_t, map_place p) {
            return std::array{p.x / 32, p.y / 32};
        });
        CHECK_THROWS_WITH_AS(footprint_map(to_uv_view(maps), {4, 8}, {.reach = 0}),
                             "footprint_map: settings.reach is 0.000000, expected a number above 0", value_error);
        CHECK_THROWS_WITH_AS(footprint_map(to_uv_view(maps), {4, 8}, {.reach = -1}),
                             "footprint_map: settings.reach is -1.000000, expected a number above 0", value_error);
        CHECK_THROWS_AS(footprint_map(to_uv_view(maps), {4, 8}, {.reach = std::nan("")}), value_error);
        CHECK_THROWS_WITH_AS(footprint_map(to_uv_view(maps), {5, 8}),
                             "footprint_map: grid is [5, 8], expected extents that divide the maps' [16, 32]",
                             value_error);
        maps.uv(0, 3, 3, 1) = std::numeric_limits<float>::quiet_NaN();
        CHECK_THROWS_WITH_AS(footprint_map(to_uv_view(maps), {4, 8}),
                             "footprint_map: maps is nan, expected finite canonical coordinates", value_error);
        maps.coverage(0, 3, 3) = 0; // what is not covered is not read
        CHECK_NOTHROW(footprint_map(to_uv_view(maps), {4, 8}));
    }

    TEST_CASE("[GR sec. 3.2] on a rasterised scene tokens that have a partner find it within half a token") {
        grid_extents const pixels{256, 256};
        auto const guidance = rasterize(turning_table{}, pixels);
        auto const maps = to_uv_view(guidance.uv);
        pixel_correspondence const truth(maps, pixels, 0.5);
        std::array<frame_index, 4> const KF{{{0}, {2}, {3}, {5}}};
        for (std::size_t const side : {64U, 32U, 16U, 8U}) {
            CAPTURE(side);
            grid_extents const grid{side, side};
            auto const cell = static_cast<double>(pixels.width / side);
            footprint_map const map(maps, grid);
            std::size_t pairs = 0, pairs_found = 0, tokens = 0, tokens_found = 0;
            double distance = 0;
            for (auto const i : {frame_index{1}, frame_index{4}}) {
                for (std::uint32_t t = 0; t < grid.size(); ++t) {
                    auto const p = representative_pixel(maps, i, grid, {t});
                    auto const seen =
                        p ? truth.point_at(i, {static_cast<std::uint32_t>(p->row * 256 + p->column)}) : std::nullopt;
                    auto const point = map.point_at(i, {t});
                    std::size_t partners = 0, found_here = 0;
                    for (auto const k : KF) {
                        auto const there = seen ? truth.token_at(k, *seen) : std::nullopt;
                        if (!there) {
                            continue;
                        }
                        ++partners;
                        if (auto const found = map.token_at(k, *point)) {
                            ++found_here;
                            auto const place = middle_of(*there, pixels.width);
                            auto const middle = middle_of(*found, side);
                            distance += std::hypot(place.x / cell - middle.x, place.y / cell - middle.y);
                        }
                    }
                    pairs += partners;
                    pairs_found += found_here;
                    tokens += partners > 0 ? 1U : 0U;
                    tokens_found += found_here > 0 ? 1U : 0U;
                }
            }
            auto const share = [](std::size_t part, std::size_t whole) {
                return static_cast<double>(part) / static_cast<double>(whole);
            };
            CHECK(tokens > grid.size() / 2);
            CHECK(share(tokens_found, tokens) >= 0.95);
            CHECK(share(pairs_found, pairs) >= 0.95);
            CHECK(distance / static_cast<double>(pairs_found) <= 0.5);
        }
    }
}
