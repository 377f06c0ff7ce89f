// SPDX-License-Identifier: MIT
// Tests of the autoencoder's way down; autoencoder_kl.test.cpp compares it with diffusers.
#include <genrender/reference/vae_encoder.hpp>

#include "small_vae.hpp"

#include <doctest/doctest.h>

#include <utility>

using namespace genrender;

using namespace genrender::reference;
using namespace genrender::testing;

TEST_SUITE("reference/vae_encoder") {
    TEST_CASE_TEMPLATE("moments are those of the layers one after the other", Real, float, double) {
        for (auto const has_quant_conv : {true, false}) {
            auto config = small_vae_config();
            config.use_quant_conv = has_quant_conv;
            auto source = weights<Real>::seeded(1, "test");
            vae_encoder<Real> const encoder(config, source);
            grid_extents const grid{6, 8};
            grid_extents const half{3, 4};
            auto const picture = random_map<Real>(grid, 3, 3);
            auto const found = encoder(picture, {});
            CHECK(found.grid() == half);
            CHECK(found.channels() == 8);

            auto x = plain_conv2d<Real>(picture.view(), grid, source.take("encoder.conv_in.weight", {8, 3, 3, 3}),
                                        source.take("encoder.conv_in.bias", {8}), 3, 1);
            x = plain_vae_resnet<Real>(source, "encoder.down_blocks.0.resnets.0", x, grid, 8);
            vae_downsampler<Real> const down(source, "encoder.down_blocks.0.downsamplers.0", 8);
            spare_map<Real> fine(grid, 8);
            copy(fine.view(), in_view<Real, 2>(x.view()));
            auto const coarse = down(fine, {});
            x = plain_vae_resnet<Real>(source, "encoder.down_blocks.1.resnets.0", coarse.view(), half, 16);
            x = plain_vae_resnet<Real>(source, "encoder.mid_block.resnets.0", x, half, 16);
            x = plain_vae_attention<Real>(source, "encoder.mid_block.attentions.0", x);
            x = plain_vae_resnet<Real>(source, "encoder.mid_block.resnets.1", x, half, 16);
            x = plain_norm_and_convolve<Real>(source, "encoder.conv_norm_out", "encoder.conv_out", x, half, 8);
            if (has_quant_conv) {
                x = plain_linear<Real>(x, source.take("quant_conv.weight", {8, 8, 1, 1}),
                                       source.take("quant_conv.bias", {8}), 8);
            }
            check_close<Real const, 2>(found.view(), x);
        }
    }

    TEST_CASE("tensors that the config does not have are not taken") {
        auto config = small_vae_config();
        config.use_quant_conv = false;
        config.mid_block_add_attention = false;
        auto source = weights<float>::seeded(1, "test");
        vae_encoder<float> const encoder(config, source);
        for (auto const& [name, shape] : source.taken()) {
            CHECK(name.starts_with("encoder."));
            CHECK(name.find("attentions") == std::string::npos);
            CHECK(name.find("down_blocks.1.downsamplers") == std::string::npos);
        }
    }
}
