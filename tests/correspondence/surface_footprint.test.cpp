// SPDX-License-Identifier: MIT
// Footprints by hand: areas, offsets, sides and the neighbours they are measured along.
#include <genrender/correspondence/surface_footprint.hpp>

#include <genrender/core/random.hpp>
#include <genrender/core/stack.hpp>

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>

using namespace genrender;

namespace {

/// One frame of canonical coordinates in D dimensions, object 0 everywhere; a model of canonical_maps.
template <std::size_t D>
struct point_maps {
    static constexpr std::size_t dimensions = D;
    stack<float, 3> points; // [height, width, D]
    stack<std::uint32_t, 2> object;
    stack<std::uint8_t, 2> coverage;

    point_maps(grid_extents grid, std::function<std::array<float, D>(pixel)> const& place)
        : points({grid.height, grid.width, D}), object({grid.height, grid.width}), coverage({grid.height, grid.width}) {
        for (std::uint32_t row = 0; row < grid.height; ++row) {
            for (std::uint32_t column = 0; column < grid.width; ++column) {
                auto const point = place({row, column});
                for (std::size_t d = 0; d < D; ++d) {
                    points(row, column, d) = point[d];
                }
                coverage(row, column) = 1;
            }
        }
    }

    std::size_t frame_count() const { return 1; }
    grid_extents grid() const { return {points.extent(0), points.extent(1)}; }
    bool is_covered(frame_index, pixel p) const { return coverage(p.row, p.column) != 0; }
    object_index object_at(frame_index, pixel p) const { return {object(p.row, p.column)}; }
    std::array<float, D> point_at(frame_index, pixel p) const {
        std::array<float, D> point{};
        for (std::size_t d = 0; d < D; ++d) {
            point[d] = points(p.row, p.column, d);
        }
        return point;
    }
};

/// An affine plane: (u, v) = (column / 8, row / 4).
std::array<float, 2> on_plane(pixel p) { return {static_cast<float>(p.column) / 8, static_cast<float>(p.row) / 4}; }

/// A footprint with random sides in [-1, 1] that is not close to flat.
template <std::size_t D>
surface_footprint<D> random_footprint(std::uint32_t number) {
    surface_footprint<D> footprint;
    for (std::uint32_t attempt = 0; footprint.area() < 0.1; ++attempt) {
        for (std::uint32_t d = 0; d < D; ++d) {
            auto const value = [&](std::uint32_t side) {
                return static_cast<float>(2 * uniform_value(number, random_stream::test, {attempt, d, side}) - 1);
            };
            footprint.across[d] = value(0);
            footprint.down[d] = value(1);
        }
    }
    return footprint;
}

} // namespace

TEST_SUITE("correspondence/surface_footprint") {
    TEST_CASE("the area in two dimensions is the determinant without its sign") {
        CHECK(surface_footprint<2>{{3, 1}, {1, 2}}.area() == doctest::Approx(5));
        CHECK(surface_footprint<2>{{1, 2}, {3, 1}}.area() == doctest::Approx(5));
        CHECK(surface_footprint<2>{{2, 4}, {1, 2}}.area() == 0); // both along one line
    }

    TEST_CASE("the area in three dimensions is the length of the cross product") {
        CHECK(surface_footprint<3>{{2, 0, 0}, {0, 0, 3}}.area() == doctest::Approx(6));
        // (1, 2, 2) x (2, -2, 1) = (6, 3, -6), of length 9.
        CHECK(surface_footprint<3>{{1, 2, 2}, {2, -2, 1}}.area() == doctest::Approx(9));
        CHECK(surface_footprint<3>{{1, 2, 2}, {-1, -2, -2}}.area() == 0);
    }

    TEST_CASE("the offset of a place by hand") {
        surface_footprint<2> const upright{{0.5F, 0}, {0, 0.25F}};
        auto const offset = offset_on<2>(upright, {1, 1}, {2, 0.5F});
        CHECK(offset.right == doctest::Approx(2));
        CHECK(offset.down == doctest::Approx(-2));
        CHECK(offset.off_plane == 0);
        // A pixel of the plane z = 1 and a place 0.75 behind it.
        surface_footprint<3> const facing{{0.5F, 0, 0}, {0, -0.5F, 0}};
        auto const behind = offset_on<3>(facing, {0, 0, 1}, {1, 0.5F, 0.25F});
        CHECK(behind.right == doctest::Approx(2));
        CHECK(behind.down == doctest::Approx(-1));
        CHECK(behind.off_plane == doctest::Approx(0.75));
    }

    TEST_CASE("offset_on undoes steps across and down in two dimensions") {
        for (std::uint32_t n = 0; n < 100; ++n) {
            auto const footprint = random_footprint<2>(n);
            auto const right = static_cast<float>(n) / 10 - 5;
            auto const down = 3 - static_cast<float>(n) / 20;
            std::array<float, 2> const origin{0.25F, -0.5F};
            auto place = origin;
            for (std::size_t d = 0; d < 2; ++d) {
                place[d] += right * footprint.across[d] + down * footprint.down[d];
            }
            auto const offset = offset_on(footprint, origin, place);
            CHECK(std::abs(offset.right - double{right}) < 1e-4);
            CHECK(std::abs(offset.down - double{down}) < 1e-4);
        }
    }

    TEST_CASE("offset_on undoes steps across and down and off the plane in three dimensions") {
        for (std::uint32_t n = 0; n < 100; ++n) {
            auto const footprint = random_footprint<3>(n);
            auto const& a = footprint.across;
            auto const& b = footprint.down;
            auto const area = static_cast<float>(footprint.area());
            std::array const normal{(a[1] * b[2] - a[2] * b[1]) / area, (a[2] * b[0] - a[0] * b[2]) / area,
                                    (a[0] * b[1] - a[1] * b[0]) / area};
            auto const right = static_cast<float>(n) / 50 - 1;
            auto const down = 1.5F - static_cast<float>(n) / 40;
            auto const off = static_cast<float>(n) / 25 - 2;
            std::array<float, 3> const origin{0.25F, -0.5F, 1};
            auto place = origin;
            for (std::size_t d = 0; d < 3; ++d) {
                place[d] += right * a[d] + down * b[d] + off * normal[d];
            }
            auto const offset = offset_on(footprint, origin, place);
            CHECK(std::abs(offset.right - double{right}) < 1e-4);
            CHECK(std::abs(offset.down - double{down}) < 1e-4);
            CHECK(std::abs(offset.off_plane - std::abs(double{off})) < 2e-3); // the root of a difference
        }
    }

    TEST_CASE("a mirrored texture faces the other way and a turned or scaled one does not") {
        surface_footprint<2> const seen{{0.5F, 0.125F}, {0, 0.25F}};
        surface_footprint<2> const mirrored{{-0.5F, 0.125F}, {0, 0.25F}};
        surface_footprint<2> const half_turned{{-0.5F, -0.125F}, {0, -0.25F}};
        surface_footprint<2> const quarter_turned{{0, 0.25F}, {-0.5F, -0.125F}};
        surface_footprint<2> const larger{{5, 1}, {0, 2}};
        CHECK(faces_alike(seen, seen));
        CHECK(faces_alike(mirrored, mirrored));
        CHECK_FALSE(faces_alike(seen, mirrored));
        CHECK_FALSE(faces_alike(mirrored, seen));
        CHECK(faces_alike(seen, half_turned));
        CHECK(faces_alike(seen, quarter_turned));
        CHECK(faces_alike(seen, larger));
    }

    TEST_CASE("surfaces in space face alike up to a right angle") {
        surface_footprint<3> const facing{{1, 0, 0}, {0, 1, 0}};
        auto const turned = [](double degrees) {
            auto const angle = degrees * 3.14159265358979 / 180;
            return surface_footprint<3>{{static_cast<float>(std::cos(angle)), 0, static_cast<float>(std::sin(angle))},
                                        {0, 1, 0}};
        };
        CHECK(faces_alike(facing, turned(0)));
        CHECK(faces_alike(facing, turned(89)));
        CHECK_FALSE(faces_alike(facing, turned(91)));
        CHECK_FALSE(faces_alike(facing, turned(180))); // from behind
        CHECK(faces_alike(turned(60), turned(120)));
    }

    TEST_CASE("a plane has the same footprint everywhere and at its borders too") {
        point_maps<2> const maps({3, 5}, on_plane);
        for (std::uint32_t row = 0; row < 3; ++row) {
            for (std::uint32_t column = 0; column < 5; ++column) {
                auto const footprint = footprint_at(maps, {0}, {row, column});
                REQUIRE(footprint.has_value());
                CHECK(footprint->across == std::array{0.125F, 0.0F});
                CHECK(footprint->down == std::array{0.0F, 0.25F});
            }
        }
    }

    TEST_CASE("at the border of a chart the shorter difference is the footprint") {
        // u leaps by 0.6 between columns 2 and 3; v leaps between rows 1 and 2.
        point_maps<2> const maps({4, 6}, [](pixel p) {
            auto const [u, v] = on_plane(p);
            return std::array{p.column > 2 ? u + 0.6F : u, p.row > 1 ? v - 3 : v};
        });
        for (std::uint32_t row = 0; row < 4; ++row) {
            for (std::uint32_t column = 0; column < 6; ++column) {
                auto const footprint = footprint_at(maps, {0}, {row, column});
                REQUIRE(footprint.has_value());
                CHECK(footprint->across[0] == doctest::Approx(0.125));
                CHECK(footprint->down[1] == doctest::Approx(0.25));
            }
        }
    }

    TEST_CASE("a seam of positions in space is not crossed") {
        // The surface goes 0.1 a column to the right, then lies one unit further away.
        point_maps<3> const maps({2, 4}, [](pixel p) {
            return std::array{static_cast<float>(p.column) / 10, static_cast<float>(p.row) / 5,
                              p.column > 1 ? 1.0F : 0.0F};
        });
        for (std::uint32_t column = 0; column < 4; ++column) {
            auto const footprint = footprint_at(maps, {0}, {1, column});
            REQUIRE(footprint.has_value());
            CHECK(footprint->across[2] == 0);
            CHECK(footprint->area() == doctest::Approx(0.02));
        }
    }

    TEST_CASE("neighbours of another object and of the background do not count") {
        point_maps<2> maps({3, 3}, [](pixel p) {
            auto const column = static_cast<float>(p.column);
            return std::array{column * column, static_cast<float>(p.row)}; // steps of 1, then 3
        });
        CHECK(footprint_at(maps, {0}, {1, 1})->across[0] == 1);
        maps.object(1, 0) = 7;
        CHECK(footprint_at(maps, {0}, {1, 1})->across[0] == 3);
        maps.coverage(1, 2) = 0;
        CHECK_FALSE(footprint_at(maps, {0}, {1, 1}).has_value());
        // Left and right are back, above and below are gone.
        maps.object(1, 0) = 0;
        CHECK(footprint_at(maps, {0}, {1, 1}).has_value());
        maps.coverage(0, 1) = 0;
        maps.object(2, 1) = 7;
        CHECK_FALSE(footprint_at(maps, {0}, {1, 1}).has_value());
    }

    TEST_CASE("maps of one row or of one pixel have no footprint") {
        CHECK_FALSE(footprint_at(point_maps<2>({1, 4}, on_plane), {0}, {0, 1}).has_value());
        CHECK_FALSE(footprint_at(point_maps<2>({4, 1}, on_plane), {0}, {1, 0}).has_value());
        CHECK_FALSE(footprint_at(point_maps<2>({1, 1}, on_plane), {0}, {0, 0}).has_value());
    }

    TEST_CASE("constant coordinates and those that are not numbers have no footprint") {
        point_maps<2> maps({3, 3}, [](pixel) { return std::array{0.5F, 0.5F}; });
        CHECK_FALSE(footprint_at(maps, {0}, {1, 1}).has_value());
        // Along one axis alone they change: there is still no area.
        point_maps<3> const line({3, 3}, [](pixel p) { return std::array{static_cast<float>(p.column), 0.0F, 0.0F}; });
        CHECK_FALSE(footprint_at(line, {0}, {1, 1}).has_value());
        for (auto const odd : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
            point_maps<2> broken({3, 3}, on_plane);
            broken.points(1, 1, 0) = odd;
            CHECK_FALSE(footprint_at(broken, {0}, {1, 1}).has_value());
        }
    }
}
