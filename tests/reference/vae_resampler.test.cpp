// SPDX-License-Identifier: MIT
// Tests of the steps between the autoencoder's levels.
#include <genrender/reference/vae_resampler.hpp>

#include "small_vae.hpp"

#include <doctest/doctest.h>

#include <cstddef>

using namespace genrender;

using namespace genrender::reference;
using namespace genrender::testing;

TEST_SUITE("reference/vae_resampler") {
    TEST_CASE_TEMPLATE("the way down sees zeros right of and below the map alone", Real, float, double) {
        auto source = weights<Real>::seeded(1, "test");
        vae_downsampler<Real> const down(source, "d", 3);
        auto const weight = source.take("d.conv.weight", {3, 3, 3, 3});
        auto const bias = source.take("d.conv.bias", {3});
        grid_extents const grid{8, 6};
        auto const x = random_map<Real>(grid, 3, 3);
        stack<Real, 2> expected({12, 3});
        for (std::size_t y = 0; y < 4; ++y) {
            for (std::size_t column = 0; column < 3; ++column) {
                for (std::size_t o = 0; o < 3; ++o) {
                    auto sum = static_cast<double>(bias[o]);
                    for (std::size_t i = 0; i < 3; ++i) {
                        for (std::size_t tap = 0; tap < 9; ++tap) {
                            auto const row = 2 * y + tap / 3;
                            auto const at = 2 * column + tap % 3;
                            if (row < grid.height && at < grid.width) {
                                sum += static_cast<double>(weight[(o * 3 + i) * 9 + tap]) *
                                       static_cast<double>(x.view()(row * grid.width + at, i));
                            }
                        }
                    }
                    expected(y * 3 + column, o) = static_cast<Real>(sum);
                }
            }
        }
        for (std::size_t const bytes : {1U, 700U, 1200U, 100000U}) {
            for (auto const& loop : {any_loop{}, any_loop(threaded_loop(3))}) {
                auto const result = down(x, {loop, bytes});
                CHECK(result.grid() == grid_extents{4, 3});
                check_close<Real const, 2>(result.view(), expected);
            }
        }
    }

    TEST_CASE_TEMPLATE("the way up is a convolution over nearest neighbours", Real, float, double) {
        auto source = weights<Real>::seeded(1, "test");
        vae_upsampler<Real> const up(source, "u", 3);
        grid_extents const grid{3, 4};
        auto const x = random_map<Real>(grid, 3, 3);
        stack<Real, 2> repeated({48, 3});
        for (std::size_t t = 0; t < 48; ++t) {
            for (std::size_t c = 0; c < 3; ++c) {
                repeated(t, c) = x.view()(t / 16 * 4 + t % 8 / 2, c);
            }
        }
        auto const expected = plain_conv2d<Real>(repeated, {6, 8}, source.take("u.conv.weight", {3, 3, 3, 3}),
                                                 source.take("u.conv.bias", {3}), 3, 1);
        for (std::size_t const bytes : {1U, 500U, 100000U}) {
            auto const result = up(x, {{}, bytes});
            CHECK(result.grid() == grid_extents{6, 8});
            check_close<Real const, 2>(result.view(), expected);
        }
    }

    TEST_CASE("an odd extent cannot be halved") {
        auto source = weights<float>::seeded(1, "test");
        vae_downsampler<float> const down(source, "d", 3);
        CHECK_THROWS_WITH_AS(down(random_map<float>({5, 4}, 3, 1), {}),
                             "vae_downsampler: height is 5, expected an even number", value_error);
        CHECK_THROWS_WITH_AS(down(random_map<float>({4, 3}, 3, 1), {}),
                             "vae_downsampler: width is 3, expected an even number", value_error);
    }
}
