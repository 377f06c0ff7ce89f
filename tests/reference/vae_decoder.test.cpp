// SPDX-License-Identifier: MIT
// Tests of the autoencoder's way up; autoencoder_kl.test.cpp compares it with diffusers.
#include <genrender/reference/vae_decoder.hpp>

#include "small_vae.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <cstddef>
#include <utility>

using namespace genrender;

using namespace genrender::reference;
using namespace genrender::testing;

TEST_SUITE("reference/vae_decoder") {
    TEST_CASE_TEMPLATE("a picture is that of the layers one after the other", Real, float, double) {
        for (auto const has_quant_conv : {true, false}) {
            auto config = small_vae_config();
            config.use_post_quant_conv = has_quant_conv;
            auto source = weights<Real>::seeded(1, "test");
            vae_decoder<Real> const decoder(config, source);
            grid_extents const half{3, 4};
            grid_extents const grid{6, 8};
            auto const z = random_map<Real>(half, 4, 3);
            stack<Real, 3> found({3, 6, 8});
            auto copy_of_z = random_map<Real>(half, 4, 3);
            decoder(found.view(), std::move(copy_of_z), {{}, 900});

            stack<Real, 2> x({half.size(), 4});
            copy(x.view(), z.view());
            if (has_quant_conv) {
                x = plain_linear<Real>(x, source.take("post_quant_conv.weight", {4, 4, 1, 1}),
                                       source.take("post_quant_conv.bias", {4}), 4);
            }
            x = plain_conv2d<Real>(x, half, source.take("decoder.conv_in.weight", {16, 4, 3, 3}),
                                   source.take("decoder.conv_in.bias", {16}), 3, 1);
            x = plain_vae_resnet<Real>(source, "decoder.mid_block.resnets.0", x, half, 16);
            x = plain_vae_attention<Real>(source, "decoder.mid_block.attentions.0", x);
            x = plain_vae_resnet<Real>(source, "decoder.mid_block.resnets.1", x, half, 16);
            x = plain_vae_resnet<Real>(source, "decoder.up_blocks.0.resnets.0", x, half, 16);
            x = plain_vae_resnet<Real>(source, "decoder.up_blocks.0.resnets.1", x, half, 16);
            stack<Real, 2> repeated({grid.size(), 16});
            for (std::size_t t = 0; t < grid.size(); ++t) {
                copy(repeated.view()[t], in_view<Real, 1>(x.view()[t / 16 * 4 + t % 8 / 2]));
            }
            x = plain_conv2d<Real>(repeated, grid,
                                   source.take("decoder.up_blocks.0.upsamplers.0.conv.weight", {16, 16, 3, 3}),
                                   source.take("decoder.up_blocks.0.upsamplers.0.conv.bias", {16}), 3, 1);
            x = plain_vae_resnet<Real>(source, "decoder.up_blocks.1.resnets.0", x, grid, 8);
            x = plain_vae_resnet<Real>(source, "decoder.up_blocks.1.resnets.1", x, grid, 8);
            x = plain_norm_and_convolve<Real>(source, "decoder.conv_norm_out", "decoder.conv_out", x, grid, 3);
            for (std::size_t t = 0; t < grid.size(); ++t) {
                for (std::size_t c = 0; c < 3; ++c) {
                    REQUIRE(std::abs(static_cast<double>(found(c, t / 8, t % 8) - x(t, c))) <= tolerance<Real>());
                }
            }
        }
    }

    TEST_CASE("a picture of another size is told") {
        auto source = weights<float>::seeded(1, "test");
        vae_decoder<float> const decoder(small_vae_config(), source);
        stack<float, 3> picture({3, 6, 6});
        CHECK_THROWS_WITH_AS(decoder(picture.view(), random_map<float>({3, 4}, 4, 1), {}),
                             "vae_decoder: picture is [3, 6, 6], expected [3, 6, 8]", shape_error);
    }
}
