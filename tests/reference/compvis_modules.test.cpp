// SPDX-License-Identifier: MIT
// Tests of kohya's names of CompVis' modules.
#include <genrender/reference/compvis_modules.hpp>

#include "../support/golden_file.hpp"

#include <doctest/doctest.h>

#include <cstddef>
#include <string>

using namespace genrender;

using namespace genrender::reference;

TEST_SUITE("reference/compvis_modules") {
    TEST_CASE("every module of the UNet has the name that diffusers gives it") {
        auto const golden = testing::golden_file("compvis_names.json");
        auto const module_of = [](std::string name) { return name.substr(0, name.rfind('.')); };
        std::size_t modules = 0;
        for (auto const& pair : golden.at("unet").at("pairs")) {
            auto const stored =
                module_of(pair.at(0).get<std::string>().substr(std::string("model.diffusion_model.").size()));
            CAPTURE(stored);
            CHECK(diffusers_module(underscored(stored)) == underscored(module_of(pair.at(1).get<std::string>())));
            ++modules;
        }
        CHECK(modules > 350);
    }

    TEST_CASE("layers are counted as the network has them and other names are left") {
        CHECK(diffusers_module("output_blocks_3_1_conv", 1) == "up_blocks_1_upsamplers_0_conv");
        CHECK_FALSE(diffusers_module("output_blocks_3_1_conv", 2));
        CHECK(diffusers_module("input_blocks_4_1_transformer_blocks_0_ff_net_0_proj") ==
              "down_blocks_1_attentions_0_transformer_blocks_0_ff_net_0_proj");
        for (auto const* name : {"down_blocks_0_attentions_0_proj_in", "input_blocks_1_1", "input_blocks_x_1_proj_in",
                                 "input_blocks_1_1_proj_inn", "middle_block_", "input_blocks_1234_1_proj_in", ""}) {
            CAPTURE(name);
            CHECK_FALSE(diffusers_module(name));
        }
    }
}
