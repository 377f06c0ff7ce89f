// SPDX-License-Identifier: MIT
// Tests of the architecture in diffusers' words.
#include <genrender/reference/diffusers_config.hpp>

#include "golden_case.hpp"
#include "golden_network.hpp"
#include "small_networks.hpp"

#include <genrender/core/random.hpp>

#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <string>

using namespace genrender;

using namespace genrender::reference;
using namespace genrender::testing;

namespace {

/// The three files of a network, which a test may change.
struct config_folder {
    temporary_file folder{"configs"};
    nlohmann::json unet;
    nlohmann::json controlnet;
    nlohmann::json scheduler;

    explicit config_folder(golden_case const& golden = golden_cases()[1])
        : unet(nlohmann::json::parse(golden.unet_json)), controlnet(nlohmann::json::parse(golden.controlnet_json)),
          scheduler(scheduler_json(golden_configs()[1])) {
        std::filesystem::create_directories(folder.path());
    }

    std::string path(std::string const& name) const { return (std::filesystem::path(folder.path()) / name).string(); }

    unet_config read_texts(std::string const& a, std::string const& b, std::string const& c) const {
        std::ofstream(path("unet.json")) << a;
        std::ofstream(path("controlnet.json")) << b;
        std::ofstream(path("scheduler.json")) << c;
        return read_diffusers_config(path("unet.json"), path("controlnet.json"), path("scheduler.json"));
    }

    unet_config read() const { return read_texts(unet.dump(), controlnet.dump(), scheduler.dump()); }
};

/// Every field, as text.
std::string description(unet_config const& config) {
    return unet_json(config).dump() + controlnet_json(config).dump() + scheduler_json(config).dump();
}

/// `unet/config.json` of Stable Diffusion 1.5 as it was published, before diffusers knew of most options.
constexpr auto published_unet = R"({
    "_class_name": "UNet2DConditionModel", "_diffusers_version": "0.6.0", "act_fn": "silu", "attention_head_dim": 8,
    "block_out_channels": [320, 640, 1280, 1280], "center_input_sample": false, "cross_attention_dim": 768,
    "down_block_types": ["CrossAttnDownBlock2D", "CrossAttnDownBlock2D", "CrossAttnDownBlock2D", "DownBlock2D"],
    "downsample_padding": 1, "flip_sin_to_cos": true, "freq_shift": 0, "in_channels": 4, "layers_per_block": 2,
    "mid_block_scale_factor": 1, "norm_eps": 1e-05, "norm_num_groups": 32, "out_channels": 4, "sample_size": 64,
    "up_block_types": ["UpBlock2D", "CrossAttnUpBlock2D", "CrossAttnUpBlock2D", "CrossAttnUpBlock2D"]})";

constexpr auto published_scheduler = R"({
    "_class_name": "PNDMScheduler", "_diffusers_version": "0.6.0", "beta_end": 0.012, "beta_schedule": "scaled_linear",
    "beta_start": 0.00085, "num_train_timesteps": 1000, "set_alpha_to_one": false, "skip_prk_steps": true,
    "steps_offset": 1, "trained_betas": null, "clip_sample": false})";

} // namespace

TEST_SUITE("reference/diffusers_config") {
    TEST_CASE("what diffusers writes for a network is what was written in C++") {
        auto const configs = golden_configs();
        for (std::size_t c = 0; c < configs.size(); ++c) {
            config_folder files(golden_cases()[c]);
            files.scheduler = scheduler_json(configs[c]);
            CHECK(description(files.read()) == description(configs[c]));
        }
    }

    TEST_CASE("what is written here is read back") {
        auto const configs = golden_configs();
        for (auto const& config : configs) {
            config_folder files;
            files.unet = unet_json(config);
            files.controlnet = controlnet_json(config);
            files.scheduler = scheduler_json(config);
            CHECK(description(files.read()) == description(config));
        }
        unet_config config;
        config.prediction_type = prediction::flow;
        CHECK_THROWS_WITH_AS(scheduler_json(config),
                             "scheduler_json: prediction_type is flow, expected epsilon, velocity or clean",
                             value_error);
    }

    TEST_CASE("the files of Stable Diffusion are read whose absent options are defaults") {
        config_folder const files;
        auto const config = files.read_texts(
            published_unet, R"({"_class_name": "ControlNetModel", "cross_attention_dim": 768})", published_scheduler);
        CHECK(config.block_out_channels == std::vector<std::size_t>{320, 640, 1280, 1280});
        CHECK(config.level_has_attention == std::vector<bool>{true, true, true, false});
        CHECK(config.attention_head_dim == std::vector<std::size_t>{8, 8, 8, 8});
        CHECK(config.conditioning_embedding_out_channels == std::vector<std::size_t>{16, 32, 96, 256});
        CHECK(config.hint_scale() == 8);
        CHECK(config.layers_per_block == 2);
        CHECK(config.norm_num_groups == 32);
        CHECK(config.cross_attention_dim == 768);
        CHECK(config.prediction_type == prediction::epsilon);
        CHECK(config.beta_end == 0.012);
    }

    TEST_CASE("options that say the same in another way are understood") {
        config_folder files;
        files.unet["only_cross_attention"] = {false, false, false, false};
        files.unet["mid_block_only_cross_attention"] = false;
        files.unet["cross_attention_dim"] = {20, 20, 20, 20};
        files.unet["layers_per_block"] = {2, 2, 2, 2};
        files.unet["transformer_layers_per_block"] = {1, 1, 1, 1};
        files.unet["time_embedding_dim"] = 64;
        files.unet["upcast_attention"] = true;
        files.controlnet["attention_head_dim"] = 4;
        files.controlnet["num_attention_heads"] = {8, 8, 8, 8};
        files.scheduler["prediction_type"] = "v_prediction";
        files.scheduler["num_train_timesteps"] = 500;
        auto expected = golden_configs()[1];
        expected.prediction_type = prediction::velocity;
        expected.num_train_timesteps = 500;
        CHECK(description(files.read()) == description(expected));
        files.scheduler["prediction_type"] = "sample";
        CHECK(files.read().prediction_type == prediction::clean);
    }

    TEST_CASE("what the networks here cannot follow is refused by name") {
        auto const check = [](std::string const& file, std::string const& option, nlohmann::json const& value,
                              std::string const& sentence) {
            config_folder files;
            (file == "unet" ? files.unet : file == "controlnet" ? files.controlnet : files.scheduler)[option] = value;
            auto const text =
                files.path(file + ".json") + ": option " + option + " is " + value.dump() + ", expected " + sentence;
            CHECK_THROWS_WITH_AS(files.read(), text.c_str(), file_error);
        };
        check("unet", "_class_name", "UNet3DConditionModel", "\"UNet2DConditionModel\"");
        check("unet", "in_channels", 9, "4 (this is for inpainting)");
        check("unet", "in_channels", 8, "the 4 of out_channels (the network sees latents alone)");
        check("unet", "time_cond_proj_dim", 256, "null (this is a latent consistency model, LCM)");
        check("unet", "down_block_types", {"DownBlock2D"}, "4 names");
        check("unet", "down_block_types", {"DownBlock2D", "AttnDownBlock2D", "DownBlock2D", "DownBlock2D"},
              "CrossAttnDownBlock2D or DownBlock2D for each level");
        check("unet", "up_block_types", {"UpBlock2D"}, "4 names");
        check("unet", "up_block_types", {"UpBlock2D", "AttnUpBlock2D", "UpBlock2D", "UpBlock2D"},
              "CrossAttnUpBlock2D or UpBlock2D for each level");
        check("unet", "mid_block_type", nullptr, "\"UNetMidBlock2DCrossAttn\"");
        check("unet", "layers_per_block", {1, 2, 2, 2}, "the same number for each level");
        check("unet", "attention_head_dim", {1, 2}, "one number or 4");
        check("unet", "num_attention_heads", 4, "null");
        check("unet", "norm_num_groups", nullptr, "a whole number from 1 to 1000000");
        check("unet", "norm_eps", 1e-6, "1e-05");
        check("unet", "act_fn", "gelu", "\"silu\" or \"swish\"");
        check("unet", "only_cross_attention", true, "false or [false,false,false,false]");
        check("unet", "time_embedding_dim", 100, "null or 64");
        check("unet", "addition_embed_type", "text_time",
              "null (Stable Diffusion 1.x or 2.x; this is Stable Diffusion XL)");
        check("unet", "addition_embed_type", "text", "null");
        check("unet", "reverse_transformer_layers_per_block", {1, 1, 1, 1}, "null");
        check("unet", "conv_in_kernel", 1, "3");
        auto const unet = [](config_folder const& files) { return ", as in " + files.path("unet.json"); };
        config_folder differing;
        differing.controlnet["cross_attention_dim"] = 768;
        CHECK_THROWS_WITH_AS(
            differing.read(),
            (differing.path("controlnet.json") + ": option cross_attention_dim is 768, expected 20" + unet(differing))
                .c_str(),
            file_error);
        config_folder absent;
        absent.controlnet["use_linear_projection"] = true;
        absent.unet.erase("use_linear_projection");
        CHECK_THROWS_WITH_AS(absent.read(),
                             (absent.path("controlnet.json") +
                              ": option use_linear_projection is true, expected the default" + unet(absent))
                                 .c_str(),
                             file_error);
        check("controlnet", "controlnet_conditioning_channel_order", "bgr", "\"rgb\"");
        check("controlnet", "global_pool_conditions", true, "false");
        check("controlnet", "conditioning_embedding_out_channels", nullptr,
              "a list of whole numbers from 1 to 1000000");
        check("scheduler", "beta_schedule", "linear", "\"scaled_linear\"");
        check("scheduler", "prediction_type", "flow_prediction", "epsilon, v_prediction or sample");
        check("scheduler", "beta_start", 0.0, "a number in (0, 1)");
        check("scheduler", "beta_end", 1.5, "a number in [beta_start, 1)");
        check("scheduler", "num_train_timesteps", 1, "at least 2");
        check("scheduler", "trained_betas", {0.1, 0.2}, "null");
        check("scheduler", "rescale_betas_zero_snr", true, "false");
    }

    TEST_CASE("unknown options and missing files are named") {
        config_folder files;
        files.unet["sparse_attention"] = true;
        CHECK_THROWS_WITH_AS(
            files.read(),
            (files.path("unet.json") + ": 1 options are unknown: sparse_attention, expected none").c_str(), file_error);
        config_folder no_schedule;
        no_schedule.scheduler.erase("beta_schedule");
        CHECK_THROWS_WITH_AS(
            no_schedule.read(),
            (no_schedule.path("scheduler.json") + ": option beta_schedule is absent, expected \"scaled_linear\"")
                .c_str(),
            file_error);
        CHECK_THROWS_WITH_AS(
            read_diffusers_config(files.path("none.json"), "", ""),
            (files.path("none.json") + ": file cannot be opened, expected a readable JSON file").c_str(), file_error);
        config_folder impossible;
        impossible.unet["norm_num_groups"] = impossible.controlnet["norm_num_groups"] = 5;
        CHECK_THROWS_AS(impossible.read(), value_error);
    }

    TEST_CASE("any option may have any value and the worst that happens is a sentence") {
        config_folder const files;
        auto const values = nlohmann::json::parse(
            R"([null, true, 0, -1, 3, 1e300, "", "silu", [], [1], [2, 2, 2, 2], [[1]], {}, {"a": 1}, 1000000])");
        std::uint32_t tries = 0;
        std::uint32_t refusals = 0;
        for (auto const* file : {&files.unet, &files.controlnet, &files.scheduler}) {
            for (auto const& [option, old] : file->items()) {
                for (auto const& value : values) {
                    auto changed = *file;
                    changed[option] = value;
                    ++tries;
                    try {
                        files.read_texts((file == &files.unet ? changed : files.unet).dump(),
                                         (file == &files.controlnet ? changed : files.controlnet).dump(),
                                         (file == &files.scheduler ? changed : files.scheduler).dump());
                    } catch (file_error const&) {
                        ++refusals;
                    } catch (value_error const&) {
                        ++refusals;
                    }
                }
            }
        }
        CHECK(refusals > tries / 2);
    }

    TEST_CASE("a text with a byte changed or cut is refused or read") {
        config_folder const files;
        auto const text = files.unet.dump();
        auto const control = files.controlnet.dump();
        auto const scheduler = files.scheduler.dump();
        std::uint32_t refusals = 0;
        for (std::uint32_t i = 0; i < 400; ++i) {
            auto const bits = random_bits(7, random_stream::test, {i, 0, 0});
            auto changed = text;
            if (i % 4 == 0) {
                changed.resize(bits[0] % text.size());
            } else {
                changed[bits[0] % text.size()] = static_cast<char>(bits[1] & 0xFFU);
            }
            try {
                files.read_texts(changed, control, scheduler);
            } catch (file_error const&) {
                ++refusals;
            } catch (value_error const&) {
                ++refusals;
            }
        }
        CHECK(refusals > 300);
    }
}
