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

    TEST_CASE("matrices and kernels keep the variance of what they multiply") {
        for (std::vector<std::size_t> const& shape : {std::vector<std::size_t>{200, 50}, {40, 30, 3, 3}}) {
            auto const tensor = seeded_tensor(3, "unet", "mid_block.proj.weight", shape);
            auto const count = static_cast<double>(tensor.size());
            auto const inputs = count / static_cast<double>(shape[0]);
            double sum = 0;
            double squares = 0;
            for (auto const value : tensor) {
                sum += static_cast<double>(value);
                squares += static_cast<double>(value) * static_cast<double>(value);
            }
            CHECK(std::abs(sum / count) < 4 / std::sqrt(inputs * count));        // 4 standard errors
            CHECK(squares / count * inputs == doctest::Approx(1).epsilon(0.06)); // 4 standard errors
        }
    }

    TEST_CASE("embeddings of words have unit variance whatever their number") {
        double squares = 0;
        for (auto const value : seeded_tensor(1, "text_encoder", "token_embedding.weight", {400, 25})) {
            squares += static_cast<double>(value) * static_cast<double>(value);
        }
        CHECK(squares / 10000 == doctest::Approx(1).epsilon(0.06)); // 4 standard errors
    }

    TEST_CASE("norms begin as the identity and their biases small") {
        CHECK(seeded_tensor(1, "unet", "norm1.weight", {5}) == std::vector<float>(5, 1.0f));
        for (auto const value : seeded_tensor(1, "unet", "norm1.bias", {50})) {
            CHECK(std::abs(value) < 0.6f);
            CHECK(value != 0);
        }
    }

    TEST_CASE("the zero convolutions of the ControlNet are not zero") {
        for (auto const value : seeded_tensor(1, "controlnet", "controlnet_down_blocks.0.weight", {4, 4, 1, 1})) {
            CHECK(value != 0);
        }
    }
}
