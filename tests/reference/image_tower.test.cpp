// SPDX-License-Identifier: MIT
// What an image tower is built from and what it refuses; its numbers are compared in reference_clip.test.cpp.
#include <genrender/reference/image_tower.hpp>

#include "golden_network.hpp"

#include <genrender/core/parallel.hpp>

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <numeric>
#include <string>
#include <vector>

using namespace genrender;

using namespace genrender::reference;
using namespace genrender::testing;

TEST_SUITE("reference/image_tower") {
    TEST_CASE("the defaults take the tensors of the miniature's embedder") {
        auto source = weights<float>::seeded(1, "tower");
        image_tower<float> const tower({}, source);
        CHECK(source.taken().size() == 30);
        CHECK(source.taken().at("image.blocks.3.conv.weight") == std::vector<std::size_t>{96, 48, 3, 3});
        CHECK(source.taken().at("image.gate.weight") == std::vector<std::size_t>{1, 96});
        CHECK(source.taken().at("image.hidden.weight") == std::vector<std::size_t>{128, 192});
        CHECK(tower(golden_stack<float, 3>("image", {3, 20, 33}).view()).size() == 64);
    }

    TEST_CASE("threads change nothing") {
        auto source = weights<double>::seeded(1, "tower");
        image_tower<double> const tower({}, source);
        auto const image = golden_stack<double, 3>("image", {3, 40, 33});
        CHECK(tower(image.view(), threaded_loop(3)) == tower(image.view()));
    }

    TEST_CASE("the vector is made of the map of features, gate and matrices by hand") {
        auto source = weights<double>::seeded(1, "tower");
        image_tower<double> const tower({}, source);
        auto const image = golden_stack<double, 3>("image", {3, 20, 33});
        auto const map = tower.feature_map(image.view());
        REQUIRE(map.extents() == std::array<std::size_t, 3>{96, 3, 5});
        auto tensors = weights<double>::seeded(1, "tower");
        auto const layer = [&](std::string const& name, std::vector<double> const& x, std::size_t outputs) {
            auto const weight = tensors.take(name + ".weight", {outputs, x.size()});
            auto y = tensors.take(name + ".bias", {outputs});
            for (std::size_t o = 0; o < outputs; ++o) {
                y[o] += std::inner_product(x.begin(), x.end(), weight.begin() + std::ptrdiff_t(o * x.size()), 0.0);
            }
            return y;
        };
        std::vector<double> means(2 * 96);
        double shares = 0;
        for (std::size_t place = 0; place < 15; ++place) {
            std::vector<double> here(96);
            for (std::size_t c = 0; c < 96; ++c) {
                here[c] = map(c, place / 5, place % 5);
                means[96 + c] += here[c] / 15;
            }
            auto const share = 1 / (1 + std::exp(-layer("image.gate", here, 1)[0]));
            shares += share;
            for (std::size_t c = 0; c < 96; ++c) {
                means[c] += share * here[c];
            }
        }
        for (std::size_t c = 0; c < 96; ++c) {
            means[c] /= shares;
        }
        auto hidden = layer("image.hidden", means, 128);
        for (auto& x : hidden) {
            x /= 1 + std::exp(-x);
        }
        auto const expected = layer("image.projection", hidden, 64);
        auto const vector = tower(image.view());
        for (std::size_t d = 0; d < 64; ++d) {
            CHECK(vector[d] == doctest::Approx(expected[d]).epsilon(1e-9));
        }
    }

    TEST_CASE("images without three channels or without pixels are refused") {
        auto source = weights<float>::seeded(3, "tower");
        image_tower<float> const tower({}, source);
        CHECK_THROWS_WITH_AS(tower(stack<float, 3>({1, 8, 8}).view()),
                             "image_tower: image is [1, 8, 8], expected [3, 8, 8]", shape_error);
        CHECK_THROWS_WITH_AS(tower(stack<float, 3>({3, 0, 8}).view()),
                             "image_tower: image is [3, 0, 8], expected [3, 1, 8]", shape_error);
    }

    TEST_CASE("a tower that cannot be is refused with a sentence") {
        auto const refusal = [](std::function<void(image_tower_config&)> const& change) {
            image_tower_config config;
            change(config);
            try {
                require_config(config);
                return std::string("accepted");
            } catch (value_error const& error) {
                return std::string(error.what());
            }
        };
        CHECK(refusal([](auto&) {}) == "accepted");
        CHECK(refusal([](auto& config) { config.block_out_channels.clear(); }) ==
              "image_tower_config: block_out_channels is empty, expected a number for each convolution");
        CHECK(refusal([](auto& config) { config.strides.pop_back(); }) ==
              "image_tower_config: numbers of strides is 5, expected 6, as many as block_out_channels has");
        CHECK(refusal([](auto& config) { config.strides[2] = 0; }) ==
              "image_tower_config: strides is 0, expected above 0");
        CHECK(refusal([](auto& config) { config.block_out_channels[1] = 20; }) ==
              "image_tower_config: block_out_channels is 20, expected a multiple of the 8 of norm_num_groups");
        CHECK(refusal([](auto& config) { config.norm_num_groups = 0; }) ==
              "image_tower_config: norm_num_groups is 0, expected above 0");
        CHECK(refusal([](auto& config) { config.hidden_size = 0; }) ==
              "image_tower_config: hidden_size is 0, expected above 0");
        CHECK(refusal([](auto& config) { config.projection_dim = 0; }) ==
              "image_tower_config: projection_dim is 0, expected above 0");
        CHECK(refusal([](auto& config) { config.norm_eps = 0; }) ==
              "image_tower_config: norm_eps is 0.000000, expected a number in (0, 1)");
    }
}
