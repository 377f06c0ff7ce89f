// SPDX-License-Identifier: MIT
// Tests of the random parameters.
#include <genrender/reference/seeded_tensor.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <vector>

using namespace genrender;

using namespace genrender::reference;

TEST_SUITE("reference/seeded_tensor") {
    TEST_CASE("a tensor depends on seed and network and name") {
        std::vector<std::size_t> const shape{4, 6};
        auto const tensor = seeded_tensor(1, "unet", "a.weight", shape);
        CHECK(tensor == seeded_tensor(1, "unet", "a.weight", shape));
        CHECK(tensor != seeded_tensor(2, "unet", "a.weight", shape));
        CHECK(tensor != seeded_tensor(1, "controlnet", "a.weight", shape));
        CHECK(tensor != seeded_tensor(1, "unet", "b.weight", shape));
    }

    TEST_CASE("matrices keep the variance of what they multiply") {
        auto const tensor = seeded_tensor(3, "unet", "mid_block.proj.weight", {200, 50});
        double sum = 0;
        double squares = 0;
        for (auto const value : tensor) {
            sum += static_cast<double>(value);
            squares += static_cast<double>(value) * static_cast<double>(value);
        }
        CHECK(std::abs(sum / 10000) < 0.006);                            // 4 standard errors
        CHECK(squares / 10000 * 50 == doctest::Approx(1).epsilon(0.06)); // 4 standard errors
    }

    TEST_CASE("norms begin as the identity and their biases small") {
        CHECK(seeded_tensor(1, "unet", "norm1.weight", {5}) == std::vector<float>(5, 1.0f));
        for (auto const value : seeded_tensor(1, "unet", "norm1.bias", {50})) {
            CHECK(std::abs(value) < 0.6f);
            CHECK(value != 0);
        }
    }

    TEST_CASE("3x3 kernels lean to low frequencies") {
        auto const tensor = seeded_tensor(1, "unet", "conv1.weight", {20, 30, 3, 3});
        double low = 0;
        double high = 0;
        for (std::size_t pair = 0; pair < 600; ++pair) {
            double mean = 0;
            double checker = 0;
            for (std::size_t tap = 0; tap < 9; ++tap) {
                mean += static_cast<double>(tensor[9 * pair + tap]);
                checker += (tap % 2 == 0 ? 1 : -1) * static_cast<double>(tensor[9 * pair + tap]);
            }
            low += mean * mean;
            high += checker * checker;
        }
        CHECK(low > 10 * high);
    }

    TEST_CASE("the zero convolutions of the ControlNet are not zero") {
        for (auto const value : seeded_tensor(1, "controlnet", "controlnet_down_blocks.0.weight", {4, 4, 1, 1})) {
            CHECK(value != 0);
        }
    }

    TEST_CASE("detail bands of the output are deaf to what is constant") {
        auto const tensor = seeded_tensor(1, "unet", "conv_out.weight", {12, 8, 3, 3});
        for (std::size_t out = 3; out < 12; ++out) {
            for (std::size_t in = 0; in < 8; ++in) {
                float sum = 0;
                for (std::size_t tap = 0; tap < 9; ++tap) {
                    sum += tensor[(out * 8 + in) * 9 + tap];
                }
                CHECK(std::abs(sum) < 1e-6f);
            }
            CHECK(seeded_tensor(1, "unet", "conv_out.bias", {12})[out] == 0);
        }
    }
}
