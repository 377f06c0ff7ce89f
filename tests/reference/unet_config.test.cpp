// SPDX-License-Identifier: MIT
// Tests of the description of a network.
#include <genrender/reference/unet_config.hpp>

#include <doctest/doctest.h>

using namespace genrender;

using namespace genrender::reference;

TEST_SUITE("reference/unet_config") {
    TEST_CASE("the defaults are Stable Diffusion 1.5 with latents of 64 x 64 for pictures of 512 x 512") {
        unet_config const config;
        CHECK_NOTHROW(require_config(config));
        CHECK_NOTHROW(require_latent_grid(config, {64, 64}));
        CHECK(config.time_channels() == 1280);
        CHECK(config.hint_scale() == 8);
        CHECK(config.grid_divisor() == 8);
    }

    TEST_CASE("what cannot be built is named") {
        auto const check = [](auto change, char const* text) {
            unet_config config;
            change(config);
            CHECK_THROWS_WITH_AS(require_config(config), text, value_error);
        };
        check([](auto& c) { c.block_out_channels = {}; },
              "unet_config: block_out_channels.size() is 0, expected 1 to 16");
        check([](auto& c) { c.level_has_attention = {true}; },
              "unet_config: level_has_attention.size() is 1, expected one entry for each of block_out_channels");
        check(
            [](auto& c) {
                c.attention_head_dim = {1, 2};
            },
            "unet_config: attention_head_dim.size() is 2, expected one entry for each of block_out_channels");
        check(
            [](auto& c) {
                c.attention_head_dim = {8, 7, 8, 8};
            },
            "unet_config: attention_head_dim is 7, expected divisors of block_out_channels of their level");
        check([](auto& c) { c.norm_num_groups = 7; },
              "unet_config: block_out_channels is 320, expected multiples of norm_num_groups");
        check([](auto& c) { c.norm_num_groups = 0; }, "unet_config: a count is 0, expected above 0");
        check([](auto& c) { c.conditioning_embedding_out_channels = {}; },
              "unet_config: conditioning_embedding_out_channels.size() is 0, expected 1 to 16");
        check([](auto& c) { c.conditioning_embedding_out_channels.assign(17, 4); },
              "unet_config: conditioning_embedding_out_channels.size() is 17, expected 1 to 16");
        check([](auto& c) { c.transformer_layers_per_block = 0; }, "unet_config: a count is 0, expected above 0");
        check([](auto& c) { c.block_out_channels[0] = 3, c.attention_head_dim[0] = 1, c.norm_num_groups = 1; },
              "unet_config: block_out_channels is 3, expected an even number for the sines and cosines of time");
    }

    TEST_CASE("latents that cannot be halved often enough are refused") {
        unet_config const config;
        CHECK_THROWS_WITH_AS(require_latent_grid(config, {60, 64}),
                             "unet_config: height of the latents is 60, expected a multiple of 8 above 0", value_error);
        CHECK_THROWS_WITH_AS(require_latent_grid(config, {64, 0}),
                             "unet_config: width of the latents is 0, expected a multiple of 8 above 0", value_error);
    }
}
