// SPDX-License-Identifier: MIT
// [GR sec. 3.3] UV noise: it moves with the surfaces, it is white in every frame, and any frame can be made alone.
#include <genrender/noise/initial_noise.hpp>

#include <genrender/core/stack.hpp>
#include <genrender/correspondence/texel_grid.hpp>
#include <genrender/maps/uv_maps.hpp>

#include <doctest/doctest.h>

#include "support/random_scene.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <utility>
#include <vector>

using namespace genrender;
using genrender::testing::random_scene;

TEST_SUITE("noise/initial_noise") {
    namespace {

    template <class Real = double>
    stack<Real, 4> noise_of(uv_maps const& maps, std::size_t channels, grid_extents grid,
                            std::vector<frame_index> const& frames, noise_settings const& settings,
                            any_loop const& loop = {}) {
        stack<Real, 4> z({frames.size(), channels, grid.height, grid.width});
        std::fill(z.data(), z.data() + z.size(), std::numeric_limits<Real>::quiet_NaN());
        initial_noise(z.view(), to_uv_view(maps), frames, settings, loop);
        return z;
    }

    /// Settings of the paper's own reading of noise textures.
    noise_settings by_texel(noise_kind kind, background_noise background, std::size_t T, std::uint64_t seed) {
        return {kind, background, T > 0 ? std::optional(T) : std::nullopt, seed, noise_reading::nearest_texel, {}};
    }

    std::vector<frame_index> all_frames(uv_maps const& maps) {
        std::vector<frame_index> frames;
        for (std::uint32_t i = 0; i < maps.frame_count(); ++i) {
            frames.push_back({i});
        }
        return frames;
    }

    /// One object that fills the frame and moves right by `step` pixels a frame; a pixel is a texel of its texture.
    uv_maps sliding_plane(std::size_t frames, grid_extents grid, std::size_t step, std::size_t T,
                          std::uint32_t object) {
        uv_maps maps(frames, grid);
        for (std::size_t i = 0; i < frames; ++i) {
            for (std::size_t row = 0; row < grid.height; ++row) {
                for (std::size_t column = 0; column < grid.width; ++column) {
                    auto const texel_column = (column + T - step * i) % T;
                    maps.uv(i, row, column, 0) = (static_cast<float>(texel_column) + 0.5F) / static_cast<float>(T);
                    maps.uv(i, row, column, 1) = (static_cast<float>(row) + 0.5F) / static_cast<float>(T);
                    maps.object(i, row, column) = object;
                    maps.coverage(i, row, column) = 1;
                }
            }
        }
        return maps;
    }

    struct moments {
        double mean = 0;
        double variance = 0;
        double kurtosis = 0;
    };

    template <class Real>
    moments moments_of(stack<Real, 4> const& z) {
        moments m;
        auto const n = static_cast<double>(z.size());
        for (std::size_t e = 0; e < z.size(); ++e) {
            m.mean += static_cast<double>(z.data()[e]) / n;
        }
        for (std::size_t e = 0; e < z.size(); ++e) {
            auto const d = static_cast<double>(z.data()[e]) - m.mean;
            m.variance += d * d / n;
            m.kurtosis += d * d * d * d / n;
        }
        m.kurtosis /= m.variance * m.variance;
        return m;
    }

    /// Correlation of all pairs of pixels of frames 0 and `other` that show the same surface point, over all channels.
    struct paired {
        double correlation = 0;
        std::size_t pairs = 0;
    };

    paired correlation_along(uv_maps const& maps, stack<double, 4> const& z, std::uint32_t other) {
        grid_extents const grid{z.extent(2), z.extent(3)};
        texel_grid const map(to_uv_view(maps), grid);
        double product = 0;
        double squares_1 = 0;
        double squares_2 = 0;
        paired result;
        for (std::uint32_t t = 0; t < grid.size(); ++t) {
            auto const point = map.point_at({other}, {t});
            auto const source = point ? map.token_at({0}, *point) : std::nullopt;
            if (!source) {
                continue;
            }
            ++result.pairs;
            for (std::size_t c = 0; c < z.extent(1); ++c) {
                auto const a = z(std::size_t{0}, c, source->value / grid.width, source->value % grid.width);
                auto const b = z(std::size_t{other}, c, t / grid.width, t % grid.width);
                product += a * b;
                squares_1 += a * a;
                squares_2 += b * b;
            }
        }
        result.correlation = product / std::sqrt(squares_1 * squares_2);
        return result;
    }

    template <class Real>
    bool equal_bits(stack<Real, 4> const& a, stack<Real, 4> const& b) {
        return a.extents() == b.extents() && std::equal(a.data(), a.data() + a.size(), b.data());
    }

    } // namespace

    TEST_CASE_TEMPLATE("[GR sec. 3.3] noise is N(0; 1) in every frame and of every kind", Real, float, double) {
        auto const maps = random_scene(3, 3, {64, 64}, 3);
        for (auto const kind : {noise_kind::uv, noise_kind::fixed, noise_kind::independent}) {
            for (std::size_t const T : {0U, 32U, 1000U}) {
                CAPTURE(static_cast<int>(kind));
                CAPTURE(T);
                for (auto const frame : all_frames(maps)) {
                    auto const m = moments_of(noise_of<Real>(maps, 256, {16, 16}, {frame}, by_texel(kind, {}, T, 11)));
                    // 65536 values, of which about four pixels repeat a texel: four standard errors of 16384.
                    CHECK(std::abs(m.mean) < 0.032);
                    CHECK(std::abs(m.variance - 1) < 0.045);
                    CHECK(std::abs(m.kurtosis - 3) < 0.16);
                }
            }
        }
    }

    TEST_CASE("[GR sec. 3.3] pixels that read the same texel share its value exactly") {
        for (std::uint64_t seed = 0; seed < 4; ++seed) {
            CAPTURE(seed);
            auto const maps = random_scene(seed, 4, {64, 64}, 3);
            grid_extents const grid{16, 16};
            auto const z = noise_of(maps, 2, grid, all_frames(maps), by_texel(noise_kind::uv, {}, 8, 5));
            std::map<texel, std::pair<double, std::size_t>> seen;
            std::size_t shared = 0;
            std::size_t differing = 0;
            for (std::uint32_t i = 0; i < 4; ++i) {
                for (std::uint32_t t = 0; t < grid.size(); ++t) {
                    auto const sample = representative_sample(to_uv_view(maps), {i}, grid, {t});
                    if (!sample) {
                        continue;
                    }
                    auto const value = z(i, 1, t / 16, t % 16);
                    auto const [entry, is_new] =
                        seen.try_emplace(texel_of(*sample, texture_resolution::same(8)), value, i);
                    shared += !is_new && entry->second.second != i ? 1U : 0U;
                    differing += entry->second.first != value ? 1U : 0U;
                }
            }
            CHECK(differing == 0);
            CHECK(shared > 50);
        }
    }

    TEST_CASE("[GR sec. 3.3] corresponding pixels correlate under UV noise and not under independent noise") {
        for (std::uint64_t seed = 0; seed < 4; ++seed) {
            CAPTURE(seed);
            auto const maps = random_scene(seed, 3, {64, 64}, 3);
            auto const frames = all_frames(maps);
            auto const uv =
                correlation_along(maps, noise_of(maps, 64, {16, 16}, frames, by_texel(noise_kind::uv, {}, 0, 5)), 2);
            auto const independent = correlation_along(
                maps, noise_of(maps, 64, {16, 16}, frames, {noise_kind::independent, {}, std::nullopt, 5}), 2);
            REQUIRE(uv.pairs > 40);
            // The nearest texel of about a pixel's size is shared about half the time.
            CHECK(uv.correlation > 0.3);
            CHECK(std::abs(independent.correlation) <
                  4 / std::sqrt(static_cast<double>(64 * independent.pairs)) + 0.02);
        }
    }

    TEST_CASE("[GR sec. 3.3] noise moves with a surface that slides by whole pixels") {
        for (std::uint32_t const object : {0U, 1U, 77U}) {
            CAPTURE(object);
            auto const maps = sliding_plane(3, {8, 8}, 2, 32, object);
            auto const z = noise_of(maps, 3, {8, 8}, all_frames(maps), by_texel(noise_kind::uv, {}, 32, 9));
            std::size_t moved = 0;
            for (std::size_t c = 0; c < 3; ++c) {
                for (std::size_t row = 0; row < 8; ++row) {
                    for (std::size_t column = 2; column < 8; ++column) {
                        moved += z(1, c, row, column) == z(0, c, row, column - 2) ? 1U : 0U;
                        moved += z(2, c, row, column) == z(1, c, row, column - 2) ? 1U : 0U;
                    }
                }
            }
            CHECK(moved == 2 * 3 * 8 * 6);
            CHECK(z(1, 0, 4, 4) != z(0, 0, 4, 4));
            // By hand: frame 1 shows texel (row 4, column 6 - 2) of the object at pixel (4, 6).
            CHECK(z(1, 2, 4, 6) == noise_texture{9}({{object}, 4, 4}, 2));
        }
    }

    TEST_CASE("[GR sec. 3.3] object 0 is an object and not the background") {
        // A frame that is half object 0: its left half moves with the object, its right half stays.
        auto maps = sliding_plane(2, {8, 8}, 1, 32, 0);
        for (std::size_t i = 0; i < 2; ++i) {
            for (std::size_t row = 0; row < 8; ++row) {
                for (std::size_t column = 4; column < 8; ++column) {
                    maps.coverage(i, row, column) = 0;
                }
            }
        }
        auto const z =
            noise_of(maps, 1, {8, 8}, all_frames(maps), by_texel(noise_kind::uv, background_noise::fixed, 32, 9));
        CHECK(z(1, 0, 3, 2) == z(0, 0, 3, 1));
        CHECK(z(1, 0, 3, 2) != z(0, 0, 3, 2));
        CHECK(z(1, 0, 3, 5) == z(0, 0, 3, 5));
        CHECK(z(1, 0, 3, 6) != z(0, 0, 3, 5));
    }

    TEST_CASE("[GR sec. 3.3] objects with equal UVs have textures of their own") {
        auto const first = sliding_plane(1, {16, 16}, 0, 16, 0);
        auto const second = sliding_plane(1, {16, 16}, 0, 16, 1);
        auto const settings = by_texel(noise_kind::uv, {}, 16, 4);
        auto const z_0 = noise_of(first, 32, {16, 16}, {{0}}, settings);
        auto const z_1 = noise_of(second, 32, {16, 16}, {{0}}, settings);
        double product = 0;
        for (std::size_t e = 0; e < z_0.size(); ++e) {
            product += z_0.data()[e] * z_1.data()[e] / static_cast<double>(z_0.size());
        }
        CHECK(std::abs(product) < 4 / std::sqrt(static_cast<double>(z_0.size())));
    }

    TEST_CASE("the background is one image for all frames or another for each") {
        uv_maps const nothing(3, {8, 8});
        auto const frames = all_frames(nothing);
        auto const fixed =
            noise_of(nothing, 2, {8, 8}, frames, by_texel(noise_kind::uv, background_noise::fixed, 0, 1));
        auto const independent =
            noise_of(nothing, 2, {8, 8}, frames, by_texel(noise_kind::uv, background_noise::independent, 0, 1));
        std::size_t equal_fixed = 0;
        std::size_t equal_independent = 0;
        for (std::size_t e = 0; e < 128; ++e) {
            equal_fixed +=
                fixed.data()[e] == fixed.data()[128 + e] && fixed.data()[e] == fixed.data()[256 + e] ? 1U : 0U;
            equal_independent += independent.data()[e] == independent.data()[128 + e] ? 1U : 0U;
        }
        CHECK(equal_fixed == 128);
        CHECK(equal_independent == 0);
        // They are the noise of the ablations, so a frame's background does not depend on what else is in view.
        CHECK(equal_bits(fixed, noise_of(nothing, 2, {8, 8}, frames, {noise_kind::fixed, {}, std::nullopt, 1})));
        CHECK(equal_bits(independent,
                         noise_of(nothing, 2, {8, 8}, frames, {noise_kind::independent, {}, std::nullopt, 1})));
    }

    TEST_CASE("the ablations do not look at the objects") {
        auto const maps = random_scene(6, 2, {32, 32}, 3);
        uv_maps const nothing(2, {32, 32});
        for (auto const kind : {noise_kind::fixed, noise_kind::independent}) {
            CHECK(equal_bits(noise_of(maps, 4, {16, 16}, {{0}, {1}}, by_texel(kind, {}, 0, 3)),
                             noise_of(nothing, 4, {16, 16}, {{0}, {1}}, by_texel(kind, {}, 0, 3))));
        }
    }

    TEST_CASE("another seed is other noise everywhere") {
        auto const maps = random_scene(6, 1, {32, 32}, 2);
        for (auto const kind : {noise_kind::uv, noise_kind::fixed, noise_kind::independent}) {
            auto const a = noise_of(maps, 4, {16, 16}, {{0}}, by_texel(kind, {}, 0, 3));
            auto const b = noise_of(maps, 4, {16, 16}, {{0}}, by_texel(kind, {}, 0, 4));
            std::size_t equal = 0;
            for (std::size_t e = 0; e < a.size(); ++e) {
                equal += a.data()[e] == b.data()[e] ? 1U : 0U;
            }
            CHECK(equal == 0);
        }
    }

    TEST_CASE_TEMPLATE("a frame alone and frames in any order and threads are the same to the bit", Real, float,
                       double) {
        auto const maps = random_scene(8, 5, {32, 32}, 3);
        grid_extents const grid{16, 16};
        for (auto const kind : {noise_kind::uv, noise_kind::fixed, noise_kind::independent}) {
            for (auto const background : {background_noise::fixed, background_noise::independent}) {
                auto const settings = by_texel(kind, background, 0, 21);
                auto const together = noise_of<Real>(maps, 4, grid, all_frames(maps), settings);
                auto const shuffled = noise_of<Real>(maps, 4, grid, {{3}, {0}, {4}, {3}}, settings);
                auto const frame_size = 4 * grid.size();
                auto const shows = [&](stack<Real, 4> const& z, std::size_t entry, std::size_t frame) {
                    auto const* const begin = z.data() + entry * frame_size;
                    return std::equal(begin, begin + frame_size, together.data() + frame * frame_size);
                };
                CHECK(shows(shuffled, 0, 3));
                CHECK(shows(shuffled, 1, 0));
                CHECK(shows(shuffled, 2, 4));
                CHECK(shows(shuffled, 3, 3));
                CHECK(shows(noise_of<Real>(maps, 4, grid, {{2}}, settings), 0, 2));
                CHECK(
                    equal_bits(together, noise_of<Real>(maps, 4, grid, all_frames(maps), settings, threaded_loop(2))));
            }
        }
    }

    TEST_CASE("channels of a latent are made one by one and more of them change none") {
        auto const maps = random_scene(8, 1, {32, 32}, 3);
        auto const four = noise_of(maps, 4, {16, 16}, {{0}}, {});
        auto const sixteen = noise_of(maps, 16, {16, 16}, {{0}}, {});
        CHECK(std::equal(four.data(), four.data() + four.size(), sixteen.data()));
    }

    TEST_CASE("latents of any strides receive the same noise") {
        auto const maps = random_scene(8, 2, {32, 32}, 2);
        auto const expected = noise_of<float>(maps, 4, {16, 8}, {{0}, {1}}, {});
        std::vector<float> memory(2 * 16 * 8 * 4);
        // Channels last, as some engines keep their latents.
        strided_view<float, 4> const z(memory.data(), {2, 4, 16, 8}, {512, 1, 32, 4});
        std::vector<frame_index> const frames{{0}, {1}};
        initial_noise(z, to_uv_view(maps), frames, {});
        std::size_t equal = 0;
        for (std::size_t e = 0; e < expected.size(); ++e) {
            equal += z(e / 512, e / 128 % 4, e / 8 % 16, e % 8) == expected.data()[e] ? 1U : 0U;
        }
        CHECK(equal == expected.size());
    }

    TEST_CASE("a low T repeats values in neighbouring pixels and a texture of one texel fills an object") {
        auto const maps = sliding_plane(1, {8, 8}, 0, 8, 2);
        auto const one = noise_of(maps, 1, {8, 8}, {{0}}, by_texel(noise_kind::uv, {}, 1, 3));
        CHECK(std::all_of(one.data(), one.data() + 64, [&](double value) { return value == one.data()[0]; }));
        auto const four = noise_of(maps, 1, {8, 8}, {{0}}, by_texel(noise_kind::uv, {}, 4, 3));
        CHECK(four(0, 0, 0, 0) == four(0, 0, 1, 1));
        CHECK(four(0, 0, 1, 1) != four(0, 0, 2, 2));
    }

    TEST_CASE("T = 0 finds the T at which a latent pixel is a texel") {
        // A pixel steps 1 / 32 in u and v, and a latent pixel of 8 x 8 spans two of them: T = 16.
        auto const maps = sliding_plane(2, {16, 16}, 2, 32, 0);
        auto const matched = noise_of(maps, 2, {8, 8}, all_frames(maps), by_texel(noise_kind::uv, {}, 0, 3));
        auto const given = noise_of(maps, 2, {8, 8}, all_frames(maps), by_texel(noise_kind::uv, {}, 16, 3));
        CHECK(equal_bits(matched, given));
    }

    TEST_CASE("UVs that are no numbers are refused where they are read and only there") {
        auto maps = sliding_plane(1, {8, 8}, 0, 8, 2);
        auto const NaN = std::numeric_limits<float>::quiet_NaN();
        maps.uv(0, 3, 3, 1) = NaN;
        for (std::size_t const T : {0U, 8U}) {
            CHECK_THROWS_WITH_AS(noise_of(maps, 1, {8, 8}, {{0}}, by_texel(noise_kind::uv, {}, T, 0)),
                                 "texel_of: uv is nan, expected finite texture coordinates", value_error);
            CHECK_NOTHROW(noise_of(maps, 1, {8, 8}, {{0}}, by_texel(noise_kind::fixed, {}, T, 0)));
        }
        maps.uv(0, 3, 3, 1) = std::numeric_limits<float>::infinity();
        CHECK_THROWS_WITH_AS(noise_of(maps, 1, {8, 8}, {{0}}, by_texel(noise_kind::uv, {}, 0, 0)),
                             "texel_of: uv is inf, expected finite texture coordinates", value_error);
        // On the background nobody reads them.
        maps.coverage(0, 3, 3) = 0;
        CHECK_NOTHROW(noise_of(maps, 1, {8, 8}, {{0}}, by_texel(noise_kind::uv, {}, 0, 0)));
    }

    TEST_CASE("UVs that are no numbers do not disturb the T of others") {
        auto maps = sliding_plane(1, {16, 16}, 0, 32, 0);
        auto const expected = noise_of(maps, 2, {8, 8}, {{0}}, by_texel(noise_kind::uv, {}, 0, 0));
        // A cell's sample is its upper left pixel, so nobody reads the lower right one.
        for (std::size_t row = 1; row < 14; row += 2) {
            for (std::size_t column = 1; column < 16; column += 2) {
                maps.uv(0, row, column, 0) = std::numeric_limits<float>::quiet_NaN();
            }
        }
        CHECK(equal_bits(noise_of(maps, 2, {8, 8}, {{0}}, by_texel(noise_kind::uv, {}, 0, 0)), expected));
    }

    TEST_CASE("UVs beyond the texture read its border") {
        auto maps = sliding_plane(1, {8, 8}, 0, 8, 2);
        maps.uv(0, 3, 3, 0) = 1;
        maps.uv(0, 3, 3, 1) = -0.25F;
        auto const z = noise_of(maps, 1, {8, 8}, {{0}}, by_texel(noise_kind::uv, {}, 8, 6));
        CHECK(z(0, 0, 3, 3) == noise_texture{6}({{2}, 0, 7}, 0));
    }

    TEST_CASE("an error inside a thread reaches the caller") {
        auto maps = random_scene(1, 4, {16, 16}, 2);
        maps.uv.fill(std::numeric_limits<float>::quiet_NaN());
        CHECK_THROWS_AS(
            noise_of(maps, 1, {16, 16}, all_frames(maps), by_texel(noise_kind::uv, {}, 8, 0), threaded_loop(2)),
            value_error);
    }

    TEST_CASE("shapes and frames that do not fit are refused with a sentence") {
        uv_maps const maps(2, {16, 16});
        CHECK_THROWS_WITH_AS(noise_of(maps, 1, {5, 4}, {{0}}, {}),
                             "initial_noise: grid is [5, 4], expected extents that divide the maps' [16, 16]",
                             value_error);
        CHECK_THROWS_WITH_AS(noise_of(maps, 1, {32, 16}, {{0}}, {}),
                             "initial_noise: grid is [32, 16], expected extents that divide the maps' [16, 16]",
                             value_error);
        CHECK_THROWS_WITH_AS(noise_of(maps, 1, {8, 8}, {{0}, {7}}, {}),
                             "initial_noise: frames is 7, expected frames of the UV maps", value_error);
        CHECK_THROWS_WITH_AS(
            noise_of(maps, 1, {8, 8}, {{0}}, by_texel(noise_kind::uv, {}, (std::size_t{1} << 20) + 1, 0)),
            "texture_resolution: T is 1048577, expected 1 to 1048576 texels", value_error);
        stack<float, 4> z({2, 1, 8, 8});
        std::vector<frame_index> const one{{0}};
        CHECK_THROWS_WITH_AS(initial_noise(z.view(), to_uv_view(maps), one, {}),
                             "initial_noise: frames is [1], expected [2]", shape_error);
    }

    TEST_CASE("no frames are no work") {
        uv_maps const maps(2, {16, 16});
        CHECK(noise_of(maps, 1, {8, 8}, {}, {}).size() == 0);
    }
}
