// SPDX-License-Identifier: MIT
// Low bands of the target and high bands of the content.
#include <genrender/normalization/low_band_latents.hpp>

#include <genrender/core/stack.hpp>
#include <genrender/testing/random_stack.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

using namespace genrender;

TEST_SUITE("normalization/low_band_latents") {
    namespace {

    constexpr std::size_t frames = 3;
    constexpr std::size_t side = 16;

    /// Frames of one content each and a block of four columns that is no background and moves by four a frame.
    struct moving_block {
        stack<double, 4> z = testing::random_stack<double, 4>({frames, 2, side, side}, 4);
        stack<std::uint8_t, 3> background{{frames, side, side}};
        adain_settings<double> settings;

        moving_block() {
            settings.statistics = adain_statistics::low_band;
            settings.band_levels = 2;
            for (std::size_t e = 0; e < background.size(); ++e) {
                auto const column = e % side;
                auto const i = e / (side * side);
                background.data()[e] = column < 4 * i || column >= 4 * i + 4 ? 1 : 0;
            }
        }

        std::vector<std::size_t> normalize() {
            return normalize_low_bands(z.view(), std::as_const(background).view(), settings);
        }
    };

    } // namespace

    TEST_CASE("a frame that differs from the target by a constant becomes the target") {
        moving_block world;
        for (std::size_t e = 0; e < 2 * side * side; ++e) {
            world.z.data()[2 * side * side + e] = world.z.data()[e] + 3;
        }
        auto const before = world.z;
        CHECK(world.normalize().empty());
        for (std::size_t e = 0; e < 2 * side * side; ++e) {
            CHECK(world.z.data()[e] == before.data()[e]); // the target stays
            CHECK(world.z.data()[2 * side * side + e] == doctest::Approx(before.data()[e]).epsilon(1e-9));
        }
    }
    TEST_CASE("a frame is moved by the low band of its difference to the target over their common background") {
        moving_block world;
        auto const before = world.z;
        world.normalize();
        std::vector<std::uint8_t> common(side * side);
        std::vector<double> apart(side * side);
        for (std::size_t e = 0; e < side * side; ++e) {
            common[e] = world.background(0, e / side, e % side) != 0 && world.background(2, e / side, e % side) != 0;
            apart[e] = before(0, 1, e / side, e % side) - before(2, 1, e / side, e % side);
        }
        auto const added = low_band({side, side}, common, 2)(apart);
        for (std::size_t e = 0; e < side * side; ++e) {
            CHECK(world.z(2, 1, e / side, e % side) ==
                  doctest::Approx(before(2, 1, e / side, e % side) + added[e]).epsilon(1e-12));
        }
    }
    TEST_CASE("a slow drift of the background goes and the fine pattern of an object stays") {
        moving_block world;
        for (std::size_t e = 0; e < world.z.size(); ++e) {
            auto const i = e / (2 * side * side);
            auto const column = e % side;
            auto const row = e / side % side;
            auto const is_object = column >= 4 * i && column < 4 * i + 4;
            auto const drift = 0.05 * static_cast<double>(i * row);
            world.z.data()[e] = is_object ? ((row + column) % 2 == 0 ? 1.0 : -1.0) : drift;
        }
        world.normalize();
        // The background has frame 0's, which is 0, but for the edges of the picture.
        CHECK(std::abs(world.z(2, 0, 8, 6)) < 0.02);
        CHECK(std::abs(world.z(2, 0, 11, 14)) < 0.02);
        // Neighbours on the object are still as far apart as they were, within what the drift changes in a row.
        CHECK(std::abs(world.z(2, 0, 8, 10) - world.z(2, 0, 8, 9)) == doctest::Approx(2).epsilon(0.01));
    }
    TEST_CASE("the low band of all frames is what they have in common and every frame moves to it") {
        moving_block world;
        world.settings.target = adain_target::all_frames;
        for (std::size_t e = 0; e < world.z.size(); ++e) {
            world.z.data()[e] = static_cast<double>(e / (2 * side * side)); // 0, 1, 2
        }
        world.normalize();
        // Column 14 is background in all frames: their mean is 1.
        for (std::size_t i = 0; i < frames; ++i) {
            CHECK(world.z(i, 0, 8, 14) == doctest::Approx(1).epsilon(0.05));
        }
    }
    TEST_CASE("without common background a frame is skipped or all pixels stand in") {
        moving_block world;
        std::fill_n(world.background.data() + side * side, side * side, std::uint8_t{0});
        auto const before = world.z;
        CHECK(world.normalize() == std::vector<std::size_t>{1});
        CHECK(std::equal(before.data() + 2 * side * side, before.data() + 4 * side * side,
                         world.z.data() + 2 * side * side));
        world.z = before;
        world.settings.fallback = without_background::all_pixels;
        CHECK(world.normalize().empty());
        std::vector<double> apart(side * side);
        for (std::size_t e = 0; e < side * side; ++e) {
            apart[e] = before(0, 0, e / side, e % side) - before(1, 0, e / side, e % side);
        }
        auto const added = low_band({side, side}, std::vector<std::uint8_t>(side * side, 1), 2)(apart);
        CHECK(world.z(1, 0, 3, 5) == doctest::Approx(before(1, 0, 3, 5) + added[3 * side + 5]).epsilon(1e-12));
    }
    TEST_CASE("no frame is no work and a mask that does not fit is refused") {
        stack<double, 4> none({0, 2, 4, 4});
        stack<std::uint8_t, 3> const no_mask({0, 4, 4});
        CHECK(normalize_low_bands(none.view(), no_mask.view(), {}).empty());
        moving_block world;
        CHECK_THROWS_AS(normalize_low_bands(world.z.view(), no_mask.view(), {}), shape_error);
    }
}
