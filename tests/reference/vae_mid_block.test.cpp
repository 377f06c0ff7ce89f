// SPDX-License-Identifier: MIT
// Tests of the bottom of the autoencoder.
#include <genrender/reference/vae_mid_block.hpp>

#include "small_vae.hpp"

#include <doctest/doctest.h>

#include <utility>

using namespace genrender;

using namespace genrender::reference;
using namespace genrender::testing;

TEST_SUITE("reference/vae_mid_block") {
    TEST_CASE_TEMPLATE("a mid block is a resnet, attention if the config has it, and a resnet", Real, float, double) {
        for (auto const has_attention : {true, false}) {
            auto config = small_vae_config();
            config.mid_block_add_attention = has_attention;
            auto source = weights<Real>::seeded(1, "test");
            vae_mid_block<Real> const block(config, source, "m");
            CHECK(source.taken().contains("m.attentions.0.to_q.weight") == has_attention);
            grid_extents const grid{4, 3};
            auto x = random_map<Real>(grid, 16, 3);
            auto expected = plain_vae_resnet<Real>(source, "m.resnets.0", std::as_const(x).view(), grid, 16);
            if (has_attention) {
                expected = plain_vae_attention<Real>(source, "m.attentions.0", expected);
            }
            expected = plain_vae_resnet<Real>(source, "m.resnets.1", expected, grid, 16);
            auto const y = block(std::move(x), {});
            CHECK(y.grid() == grid);
            check_close<Real const, 2>(y.view(), expected);
        }
    }
}
