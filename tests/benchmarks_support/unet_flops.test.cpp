// SPDX-License-Identifier: MIT
// FLOPs counted from an architecture beside those that PyTorch counts when it runs the same.
#include <benchmarks/support/unet_flops.hpp>

#include <doctest/doctest.h>

using namespace genrender;
using namespace genrender::benchmarks;

TEST_SUITE("benchmarks_support/unet_flops") {
    TEST_CASE("the count is that of torch.utils.flop_counter for diffusers' UNet of the same config") {
        CHECK(unet_flops({}, {64, 64}, 77) == 803273441280.0);
        unet_config mid;
        mid.block_out_channels = {64, 128, 256, 256};
        mid.cross_attention_dim = 256;
        CHECK(unet_flops(mid, {32, 32}, 77) == 8657780736.0);
        unet_config small;
        small.in_channels = small.out_channels = 12;
        small.block_out_channels = {32, 64, 96};
        small.level_has_attention = {false, true, false};
        small.layers_per_block = 1;
        small.attention_head_dim = {1, 2, 2};
        small.cross_attention_dim = 48;
        small.norm_num_groups = 8;
        CHECK(unet_flops(small, {32, 32}, 4) == 801013760.0);
    }

    TEST_CASE("a network of one level is counted by hand") {
        unet_config config;
        config.in_channels = 3;
        config.out_channels = 5;
        config.block_out_channels = {2};
        config.level_has_attention = {false};
        config.layers_per_block = 1;
        config.attention_head_dim = {1};
        config.cross_attention_dim = 7;
        config.norm_num_groups = 1;
        // Time 2 -> 8 -> 8; resnets 2 -> 2 down and twice at the bottom, 4 -> 2 twice on the way up.
        auto const time = 2 * 8 + 8 * 8;
        auto const resnet = 2 * (6 * 9 * 2 * 2) + 8 * 2;
        auto const wide = 6 * 9 * 4 * 2 + 6 * 9 * 2 * 2 + 8 * 2 + 6 * 4 * 2;
        auto const own = 6 * 4 * 2 * 2 + 2 * 6 * 6 * 2;
        auto const prompt = 6 * 2 * 2 * 2 + 10 * 2 * 7 * 2 + 2 * 6 * 10 * 2;
        auto const transformer = 6 * 2 * 2 * 2 + own + prompt + 6 * 12 * 2 * 2;
        auto const in_and_out = 6 * 9 * (3 * 2 + 2 * 5);
        CHECK(unet_flops(config, {2, 3}, 10) == 2.0 * (time + 3 * resnet + 2 * wide + transformer + in_and_out));
    }
}
