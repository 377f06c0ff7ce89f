// SPDX-License-Identifier: MIT
// Tests of the way down.
#include <genrender/reference/unet_encoder.hpp>

#include "small_networks.hpp"

#include <doctest/doctest.h>

using namespace genrender;

using namespace genrender::reference;
using namespace genrender::testing;

TEST_SUITE("reference/unet_encoder") {
    TEST_CASE("the skips of Stable Diffusion 1.5 are twelve") {
        unet_config config;
        config.block_out_channels = {320, 640, 1280, 1280};
        config.layers_per_block = 2;
        CHECK(skip_channels(config) ==
              std::vector<std::size_t>{320, 320, 320, 320, 640, 640, 640, 1280, 1280, 1280, 1280, 1280});
    }

    TEST_CASE_TEMPLATE("skips have the channels and grids of their levels", Real, float, double) {
        auto config = small_config();
        config.layers_per_block = 2;
        auto source = weights<Real>::seeded(1, "test");
        site_list sites({4, 6});
        unet_encoder<Real> const encoder(config, source, sites);
        small_pass<Real> small;
        auto const encoded = encoder(small.pass, random_maps<Real>(2, {4, 6}, 4, 2), Real(7));
        auto const channels = skip_channels(config);
        REQUIRE(encoded.skips.size() == channels.size());
        for (std::size_t s = 0; s < channels.size(); ++s) {
            CHECK(encoded.skips[s].channels() == channels[s]);
            CHECK(encoded.skips[s].grid() == (s < 3 ? grid_extents{4, 6} : grid_extents{2, 3}));
        }
        CHECK(encoded.middle.view().extents() == std::array<std::size_t, 3>{2, 6, 12});
        CHECK(sites.sites().size() == 3);
        CHECK(sites.sites()[1].name == "down_blocks.0.attentions.1.transformer_blocks.0.attn1");
        CHECK(sites.sites()[2].name == "mid_block.attentions.0.transformer_blocks.0.attn1");
        CHECK(sites.sites()[2].grid == grid_extents{2, 3});
    }

    TEST_CASE("the hint is added after the first convolution") {
        auto source = weights<double>::seeded(1, "test");
        site_list sites({4, 4});
        unet_encoder<double> const encoder(small_config(), source, sites);
        small_pass<double> small;
        auto const z = random_maps<double>(2, {4, 4}, 4, 2);
        auto const hint = random_maps<double>(1, {4, 4}, 8, 3);
        auto const with = encoder(small.pass, z, 7.0, {&hint, &hint});
        auto without = encoder(small.pass, z, 7.0);
        add_scaled(without.skips[0][1], hint[0]);
        check_close<double, 2>(without.skips[0][1], with.skips[0][1]);
    }
}
