// SPDX-License-Identifier: MIT
// [GR sec. 3.3] z_UV: every texel of every object and every channel has a value of its own.
#include <genrender/noise/noise_texture.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <cstdint>
#include <set>
#include <vector>

using namespace genrender;

namespace {

constexpr std::uint32_t last = (1U << 20) - 1;

} // namespace

TEST_SUITE("noise/noise_texture") {
    TEST_CASE("[GR sec. 3.3] z_UV ~ N(0; 1) over rows and columns and channels and objects") {
        noise_texture const z_UV{7};
        double mean = 0;
        double square = 0;
        double fourth = 0;
        std::uint32_t count = 0;
        for (std::uint32_t object = 0; object < 5; ++object) {
            for (std::uint32_t row = 0; row < 64; ++row) {
                for (std::uint32_t column = 0; column < 64; ++column) {
                    for (std::uint32_t channel = 0; channel < 4; ++channel, ++count) {
                        auto const z = z_UV({{object}, row, column}, channel);
                        mean += z;
                        square += z * z;
                        fourth += z * z * z * z;
                    }
                }
            }
        }
        // 81920 values: standard errors 0.0035, 0.0049 and 0.034, four of each.
        CHECK(std::abs(mean / count) < 0.014);
        CHECK(std::abs(square / count - 1) < 0.02);
        CHECK(std::abs(fourth / count - 3) < 0.14);
    }

    TEST_CASE("a value is a function of its address and of the seed") {
        texel const t{{3}, 5, 8};
        CHECK(noise_texture{7}(t, 1) == noise_texture{7}(t, 1));
        CHECK(noise_texture{7}(t, 1) != noise_texture{8}(t, 1));
        CHECK(noise_texture{7}(t, 1) != noise_texture{7 + (std::uint64_t{1} << 40)}(t, 1));
        // Small numbers are their own address in the texture's stream.
        CHECK(noise_texture{7}({{0}, 5, 8}, 1) == normal_value(7, random_stream::texture_noise, {5, 8, 1}));
    }

    TEST_CASE("no two addresses meet up to the ends of their ranges") {
        noise_texture const z_UV{1};
        std::vector<std::uint32_t> const objects{
            0, 1, 2, 4095, 4096, 4097, 1U << 23, 1U << 24, (1U << 24) + 1, 1U << 31, 0xFFFFFFFFU};
        std::set<double> values;
        std::size_t count = 0;
        for (auto const object : objects) {
            for (auto const row : {0U, 1U, last}) {
                for (auto const column : {0U, 1U, last}) {
                    for (auto const channel : {0U, 1U, 3U, (1U << 24) - 1}) {
                        values.insert(z_UV({{object}, row, column}, channel));
                        ++count;
                    }
                }
            }
        }
        CHECK(values.size() == count);
    }

    TEST_CASE("neighbouring texels and channels and objects are uncorrelated") {
        noise_texture const z_UV{3};
        double by_row = 0;
        double by_column = 0;
        double by_channel = 0;
        double by_object = 0;
        double transposed = 0;
        constexpr std::uint32_t side = 150;
        for (std::uint32_t row = 0; row < side; ++row) {
            for (std::uint32_t column = 0; column < side; ++column) {
                auto const z = z_UV({{1}, row, column + side}, 0);
                by_row += z * z_UV({{1}, row + 1, column + side}, 0);
                by_column += z * z_UV({{1}, row, column + side + 1}, 0);
                by_channel += z * z_UV({{1}, row, column + side}, 1);
                by_object += z * z_UV({{2}, row, column + side}, 0);
                transposed += z * z_UV({{1}, column + side, row}, 0);
            }
        }
        auto const bound = 4.0 * side; // four standard errors of a sum of side^2 products
        CHECK(std::abs(by_row) < bound);
        CHECK(std::abs(by_column) < bound);
        CHECK(std::abs(by_channel) < bound);
        CHECK(std::abs(by_object) < bound);
        CHECK(std::abs(transposed) < bound);
    }
}
