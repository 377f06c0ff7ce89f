// SPDX-License-Identifier: MIT
// [GR sec. 3.3] Surface noise: white in every frame at any zoom, and between frames as correlated as surfaces overlap.
#include <genrender/noise/surface_noise.hpp>

#include <genrender/core/stack.hpp>
#include <genrender/maps/uv_maps.hpp>
#include <genrender/noise/initial_noise.hpp>

#include <doctest/doctest.h>

#include "support/random_scene.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

using namespace genrender;
using genrender::testing::random_scene;

TEST_SUITE("noise/surface_noise") {
    namespace {

    constexpr grid_extents pixels{64, 64};
    constexpr grid_extents grid{16, 16};

    /// A frame that shows one object from (u, v) at its upper left corner, `zoom` times smaller than a texture a frame.
    uv_maps view_of_plane(double u, double v, double zoom, double shear = 0) {
        uv_maps maps(1, pixels);
        for (std::size_t row = 0; row < pixels.height; ++row) {
            for (std::size_t column = 0; column < pixels.width; ++column) {
                auto const y = (static_cast<double>(row) + 0.5) / 64;
                auto const x = (static_cast<double>(column) + 0.5) / 64;
                maps.uv(0, row, column, 0) = static_cast<float>(u + zoom * (x + shear * y));
                maps.uv(0, row, column, 1) = static_cast<float>(v + zoom * y);
                maps.object(0, row, column) = 3;
                maps.coverage(0, row, column) = 1;
            }
        }
        return maps;
    }

    template <class Settings = noise_settings>
    stack<double, 4> noise_of(uv_maps const& maps, std::size_t channels, Settings const& settings = {},
                              std::vector<frame_index> const& frames = {{0}}) {
        stack<double, 4> z({frames.size(), channels, grid.height, grid.width});
        initial_noise(z.view(), to_uv_view(maps), frames, settings);
        return z;
    }

    noise_settings by_texel(std::size_t T) { return {noise_kind::uv, {}, T, 0, noise_reading::nearest_texel, {}}; }

    /// How noise departs from white noise of N(0, 1).
    struct departures {
        double mean = 0;
        double variance = 0;   ///< minus 1
        double kurtosis = 0;   ///< minus 3
        double beside = 0;     ///< correlation of neighbours in a row
        double below = 0;      ///< correlation of neighbours in a column
        double kolmogorov = 0; ///< greatest distance of the distribution function from that of N(0, 1)
    };

    departures departures_of(stack<double, 4> const& z) {
        departures d;
        std::vector<double> values(z.data(), z.data() + z.size());
        auto const n = static_cast<double>(values.size());
        double squares = 0;
        double fourths = 0;
        for (auto const value : values) {
            d.mean += value / n;
            squares += value * value / n;
            fourths += value * value * value * value / n;
        }
        d.variance = squares - 1;
        d.kurtosis = fourths / (squares * squares) - 3;
        auto const pairs = static_cast<double>(z.extent(1) * 16 * 15);
        for (std::size_t c = 0; c < z.extent(1); ++c) {
            for (std::size_t a = 0; a < 16; ++a) {
                for (std::size_t b = 0; b + 1 < 16; ++b) {
                    d.beside += z(std::size_t{0}, c, a, b) * z(std::size_t{0}, c, a, b + 1) / pairs;
                    d.below += z(std::size_t{0}, c, b, a) * z(std::size_t{0}, c, b + 1, a) / pairs;
                }
            }
        }
        std::sort(values.begin(), values.end());
        for (std::size_t k = 0; k < values.size(); ++k) {
            auto const expected = 0.5 * std::erfc(-values[k] / std::sqrt(2.0));
            d.kolmogorov = std::max({d.kolmogorov, std::abs(expected - static_cast<double>(k) / n),
                                     std::abs(expected - static_cast<double>(k + 1) / n)});
        }
        return d;
    }

    /// Mean product of two frames' values at two latent pixels over all channels.
    double correlation(stack<double, 4> const& a, pixel p, stack<double, 4> const& b, pixel q) {
        double sum = 0;
        for (std::size_t c = 0; c < a.extent(1); ++c) {
            sum += a(std::size_t{0}, c, p.row, p.column) * b(std::size_t{0}, c, q.row, q.column);
        }
        return sum / static_cast<double>(a.extent(1));
    }

    /// The same, averaged over all latent pixels and their neighbours `right` of them in the other frame.
    double correlation_beside(stack<double, 4> const& a, stack<double, 4> const& b, std::uint32_t right) {
        double sum = 0;
        std::size_t count = 0;
        for (std::uint32_t row = 0; row < 16; ++row) {
            for (std::uint32_t column = 0; column + right < 16; ++column) {
                sum += correlation(a, {row, column + right}, b, {row, column});
                ++count;
            }
        }
        return sum / static_cast<double>(count);
    }

    } // namespace

    TEST_CASE("[GR sec. 3.3] every frame is white noise of N(0; 1) at any zoom and shear") {
        constexpr std::size_t channels = 256; // 65536 values: four standard errors, and Kolmogorov's 0.01 % point
        for (auto const zoom : {0.013, 0.25, 0.5, 1.0, 2.0, 4.0, 300.0}) {
            for (auto const shear : {0.0, 6.0}) {
                CAPTURE(zoom);
                CAPTURE(shear);
                auto const d = departures_of(noise_of(view_of_plane(0.123, 0.456, zoom, shear), channels));
                CHECK(std::abs(d.mean) < 4.0 / 256);
                CHECK(std::abs(d.variance) < 4 * std::sqrt(2.0) / 256);
                CHECK(std::abs(d.kurtosis) < 4 * std::sqrt(24.0) / 256);
                CHECK(std::abs(d.beside) < 4.0 / 248);
                CHECK(std::abs(d.below) < 4.0 / 248);
                CHECK(d.kolmogorov < 2.23 / 256);
            }
        }
    }

    TEST_CASE("[GR sec. 3.3] frames of many objects and background are white noise too") {
        for (std::uint64_t seed = 0; seed < 3; ++seed) {
            auto const maps = random_scene(seed, 2, {64, 64}, 4);
            for (auto const background : {background_noise::fixed, background_noise::independent}) {
                noise_settings settings;
                settings.background = background;
                settings.seed = seed;
                auto const d = departures_of(noise_of(maps, 256, settings));
                CHECK(std::abs(d.mean) < 4.0 / 256);
                CHECK(std::abs(d.variance) < 4 * std::sqrt(2.0) / 256);
                CHECK(std::abs(d.kurtosis) < 4 * std::sqrt(24.0) / 256);
                CHECK(std::abs(d.beside) < 4.0 / 248);
                CHECK(std::abs(d.below) < 4.0 / 248);
            }
        }
    }

    TEST_CASE("the literal nearest texel fails the same tests where a texel is larger than a latent pixel") {
        auto const coarse = departures_of(noise_of(view_of_plane(0.123, 0.456, 1.0), 256, by_texel(8)));
        CHECK(coarse.beside > 0.4);
        CHECK(coarse.below > 0.4);
    }

    TEST_CASE("corresponding pixels are as correlated as the surfaces under them overlap") {
        constexpr std::size_t channels = 200;
        auto const frame = noise_of(view_of_plane(0.2, 0.3, 1), channels);
        // The plane moves right by a share of a latent pixel: so much of the surface under a pixel is left behind.
        for (auto const share : {0.0, 0.25, 0.5, 0.75}) {
            CAPTURE(share);
            auto const moved = noise_of(view_of_plane(0.2 - share / 16, 0.3, 1), channels);
            CHECK(correlation_beside(moved, frame, 0) == doctest::Approx(1 - share).epsilon(0.06));
            CHECK(correlation_beside(moved, frame, 1) == doctest::Approx(share).epsilon(0.06));
        }
        // The nearest of 4096 texels is another one as soon as anything moves.
        auto const texels = noise_of(view_of_plane(0.02, 0, 0.96), channels, by_texel(4096));
        auto const moved = noise_of(view_of_plane(0.005, 0, 0.96), channels, by_texel(4096));
        CHECK(std::abs(correlation_beside(moved, texels, 0)) < 0.05);
    }

    TEST_CASE("a pixel seen from afar is the sum of those seen close by") {
        constexpr std::size_t channels = 4000;
        // A latent pixel of the far frame shows what 2 x 2 of the near one show.
        auto const far = noise_of(view_of_plane(0, 0, 2), channels);
        auto const near = noise_of(view_of_plane(0, 0, 1), channels);
        for (std::uint32_t row = 0; row < 2; ++row) {
            for (std::uint32_t column = 0; column < 2; ++column) {
                CHECK(correlation(far, {3, 2}, near, {6 + row, 4 + column}) == doctest::Approx(0.5).epsilon(0.12));
            }
        }
        CHECK(std::abs(correlation(far, {3, 2}, near, {6, 6})) < 4 / std::sqrt(double{channels}));
    }

    TEST_CASE("a frame of its own by any other way is the same frame") {
        auto const maps = random_scene(2, 4, {64, 64}, 3);
        stack<double, 4> alone({4, 3, 16, 16});
        stack<double, 4> together({4, 3, 16, 16});
        std::vector<frame_index> const backwards{{3}, {2}, {1}, {0}};
        initial_noise(together.view(), to_uv_view(maps), backwards, {}, threaded_loop(3));
        for (std::uint32_t i = 0; i < 4; ++i) {
            surface_noise(alone.view()[3 - i], to_uv_view(maps), {i}, 0);
        }
        CHECK(std::equal(alone.data(), alone.data() + alone.size(), together.data()));
    }

    TEST_CASE("identical frames have identical noise and other steps have other noise") {
        auto maps = random_scene(2, 1, {64, 64}, 3);
        stack<double, 4> z({3, 4, 16, 16});
        auto const uv = to_uv_view(maps);
        surface_noise(z.view()[0], uv, {0}, 7);
        surface_noise(z.view()[1], uv, {0}, 7);
        surface_noise(z.view()[2], uv, {0}, 7, background_noise::fixed, {}, 1);
        auto const values = std::size_t{4 * 16 * 16};
        CHECK(std::equal(z.data(), z.data() + values, z.data() + values));
        double product = 0;
        for (std::size_t e = 0; e < values; ++e) {
            product += z.data()[e] * z.data()[2 * values + e] / static_cast<double>(values);
        }
        CHECK(std::abs(product) < 4 / std::sqrt(static_cast<double>(values)));
    }

    TEST_CASE("the background of an environment turns with the camera and is white") {
        uv_maps const nothing(2, pixels);
        noise_settings settings;
        settings.background = background_noise::environment;
        // Frame 1 has turned by exactly four latent pixels, at the equator where directions are evenly spaced.
        constexpr double pixel_angle = 0.002;
        settings.rays.direction = [](frame_index i, double row, double column) {
            auto const azimuth = (column + 16 * i.value - 32) * pixel_angle;
            auto const height = (32 - row) * pixel_angle;
            return std::array<double, 3>{std::sin(azimuth), height, -std::cos(azimuth)};
        };
        auto const first = noise_of(nothing, 256, settings, {{0}});
        auto const second = noise_of(nothing, 256, settings, {{1}});
        CHECK(correlation_beside(first, second, 4) > 0.95);
        CHECK(std::abs(correlation_beside(first, second, 0)) < 0.05);
        auto const d = departures_of(second);
        CHECK(std::abs(d.variance) < 4 * std::sqrt(2.0) / 256);
        CHECK(std::abs(d.beside) < 4.0 / 248);
    }

    TEST_CASE("settings that contradict each other are refused with a sentence") {
        uv_maps const maps(1, pixels);
        noise_settings settings;
        settings.T = 64;
        CHECK_THROWS_WITH_AS(
            noise_of(maps, 1, settings),
            "initial_noise: settings.T is 64, expected none, since noise_reading::surface has no texture "
            "resolution",
            value_error);
        settings.T.reset();
        settings.background = background_noise::environment;
        CHECK_THROWS_WITH_AS(noise_of(maps, 1, settings),
                             "initial_noise: settings.background is environment, expected noise_reading::surface and "
                             "settings.rays beside it",
                             value_error);
    }

    TEST_CASE("an object of one pixel and UVs that stand still have noise of unit variance") {
        auto maps = view_of_plane(0.1, 0.1, 1);
        maps.coverage.fill(0);
        maps.coverage(0, 10, 10) = 1;
        auto const one = departures_of(noise_of(maps, 256));
        CHECK(std::abs(one.variance) < 4 * std::sqrt(2.0) / 256);
        maps.coverage.fill(1);
        maps.uv.fill(0.5F);
        auto const still = departures_of(noise_of(maps, 256));
        CHECK(std::abs(still.variance) < 4 * std::sqrt(2.0) / 256);
        CHECK(std::abs(still.beside) < 4.0 / 248);
    }

    TEST_CASE("UVs that are no numbers are refused and the background's are not read") {
        auto maps = view_of_plane(0.1, 0.1, 1);
        maps.uv(0, 3, 2, 1) = std::numeric_limits<float>::quiet_NaN();
        CHECK_THROWS_AS(noise_of(maps, 1), value_error);
        maps.coverage(0, 3, 2) = 0;
        CHECK_NOTHROW(noise_of(maps, 1));
    }
}
