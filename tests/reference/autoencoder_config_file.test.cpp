// SPDX-License-Identifier: MIT
// Tests of the autoencoder's architecture in diffusers' words.
#include <genrender/reference/autoencoder_config_file.hpp>

#include "../support/golden_file.hpp"
#include "small_networks.hpp"

#include <doctest/doctest.h>

#include <fstream>
#include <limits>
#include <string>
#include <vector>

using namespace genrender;

using namespace genrender::reference;
using namespace genrender::testing;

TEST_SUITE("reference/autoencoder_config_file") {
    /// `vae/config.json` of Stable Diffusion 1.5 as it was published.
    constexpr auto published_vae = R"({
        "_class_name": "AutoencoderKL", "_diffusers_version": "0.6.0", "act_fn": "silu",
        "block_out_channels": [128, 256, 512, 512], "down_block_types": ["DownEncoderBlock2D", "DownEncoderBlock2D",
        "DownEncoderBlock2D", "DownEncoderBlock2D"], "in_channels": 3, "latent_channels": 4, "layers_per_block": 2,
        "norm_num_groups": 32, "out_channels": 3, "sample_size": 512, "up_block_types": ["UpDecoderBlock2D",
        "UpDecoderBlock2D", "UpDecoderBlock2D", "UpDecoderBlock2D"]})";

    autoencoder_config read_vae(std::string const& text, std::string const& path) {
        std::ofstream(path) << text;
        return read_autoencoder_config(config_file(path));
    }

    TEST_CASE("the file of Stable Diffusion 1.5 is the default") {
        temporary_file const file("config.json");
        auto const config = read_vae(published_vae, file.path());
        CHECK(autoencoder_json(config) == autoencoder_json({}));
        CHECK(config.scale() == 8);
        CHECK(config.scaling_factor == 0.18215);
    }

    TEST_CASE("absent options have diffusers' defaults") {
        temporary_file const file("config.json");
        auto const config = read_vae("{}", file.path());
        CHECK(config.block_out_channels == std::vector<std::size_t>{64});
        CHECK(config.layers_per_block == 1);
        CHECK(config.latent_channels == 4);
        CHECK(config.norm_num_groups == 32);
        CHECK(config.shift_factor == 0);
        CHECK(config.mid_block_add_attention);
        CHECK(config.use_quant_conv);
        CHECK(config.use_post_quant_conv);
    }

    TEST_CASE("what diffusers writes is read, and what is written here is read back") {
        temporary_file const file("config.json");
        auto const golden = golden_file("autoencoder.json").at("cases").at(1).at("config");
        auto const config = read_vae(golden.dump(), file.path());
        CHECK(config.block_out_channels == std::vector<std::size_t>{12, 16, 20});
        CHECK(config.latent_channels == 8);
        CHECK(config.scaling_factor == 0.625);
        CHECK(config.shift_factor == 0.125);
        CHECK(!config.mid_block_add_attention);
        CHECK(!config.use_quant_conv);
        CHECK(!config.use_post_quant_conv);
        CHECK(config.scale() == 4);
        CHECK(autoencoder_json(read_vae(autoencoder_json(config).dump(), file.path())) == autoencoder_json(config));
    }

    TEST_CASE("what the networks here cannot follow is refused by name") {
        temporary_file const file("config.json");
        auto const check = [&](std::string const& option, nlohmann::json const& value, std::string const& sentence) {
            auto json = nlohmann::json::parse(published_vae);
            json[option] = value;
            auto const text = file.path() + ": option " + option + " is " + value.dump() + ", expected " + sentence;
            CHECK_THROWS_WITH_AS(read_vae(json.dump(), file.path()), text.c_str(), file_error);
        };
        check("_class_name", "VQModel", "\"AutoencoderKL\"");
        check("in_channels", 4, "3");
        check("out_channels", 1, "3");
        check("down_block_types", {"DownEncoderBlock2D"},
              "4 times \"DownEncoderBlock2D\", one for each of block_out_channels");
        check("up_block_types", {"AttnUpDecoderBlock2D"},
              "4 times \"UpDecoderBlock2D\", one for each of block_out_channels");
        check("act_fn", "mish", "\"silu\" or \"swish\"");
        check("latents_mean", {0.5, 0.5, 0.5, 0.5}, "null");
        check("latents_std", {0.5, 0.5, 0.5, 0.5}, "null");
        check("scaling_factor", 0, "a number above 0");
        check("shift_factor", "none", "a number");
        check("use_quant_conv", 1, "true or false");
        auto json = nlohmann::json::parse(published_vae);
        json["encoder_block_out_channels"] = 3;
        CHECK_THROWS_WITH_AS(
            read_vae(json.dump(), file.path()),
            (file.path() + ": 1 options are unknown: encoder_block_out_channels, expected none").c_str(), file_error);
    }
}
