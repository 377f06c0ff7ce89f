// SPDX-License-Identifier: MIT
// Tests of folders in diffusers' layout.
#include <genrender/reference/diffusers_folder.hpp>

#include "golden_case.hpp"
#include "golden_network.hpp"
#include "small_networks.hpp"
#include "written_networks.hpp"

#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

using namespace genrender;

using namespace genrender::reference;
using namespace genrender::testing;

namespace {

/// A folder to write into.
struct test_folder {
    temporary_file file{"folder"};
    std::filesystem::path path = file.path();

    test_folder() { std::filesystem::create_directories(path / "text_encoder"); }

    void write(std::string const& name, std::string const& text) const { std::ofstream(path / name) << text; }
};

} // namespace

TEST_SUITE("reference/diffusers_folder") {
    TEST_CASE("shards are loaded as one network") {
        test_folder const folder;
        auto const& golden = golden_cases()[2];
        auto const config = golden_configs()[2];
        write_golden_folder(folder.path, golden, config);
        // Divide the UNet in two.
        auto const unet_folder = folder.path / "unet";
        auto const whole = unet_folder / "diffusion_pytorch_model.safetensors";
        safetensors_file const file(whole.string());
        std::array<std::map<std::string, std::vector<float>>, 2> values;
        std::array<std::map<std::string, safetensors_source>, 2> shards;
        std::string map;
        std::size_t i = 0;
        for (auto const& [name, entry] : file.entries()) {
            auto const shard = i++ % 2;
            auto const& kept = values[shard][name] = file.read<float>(name);
            shards[shard][name] = {entry.shape, kept};
            map += (map.empty() ? "\"" : ", \"") + name + "\": \"shard-" + std::to_string(shard) + "\"";
        }
        write_safetensors((unet_folder / "shard-0").string(), shards[0]);
        write_safetensors((unet_folder / "shard-1").string(), shards[1]);
        std::filesystem::remove(whole);
        std::ofstream(unet_folder / "diffusion_pytorch_model.safetensors.index.json")
            << R"({"weight_map": {)" << map << "}}";
        diffusers_folder const files(folder.path);
        auto source = files.unet<float>();
        site_list sites({8, 8});
        CHECK_NOTHROW(unet<float>(files.config(), source, sites));
    }

    TEST_CASE("folders of other architectures are refused by name") {
        test_folder const folder;
        auto const& golden = golden_cases()[1];
        write_golden_folder(folder.path, golden, golden_configs()[1]);
        diffusers_folder const files(folder.path);
        CHECK_NOTHROW(files.config());
        auto const says = [&](std::string const& what) {
            std::string text = "none";
            try {
                files.config();
            } catch (file_error const& error) {
                text = error.what();
            }
            CAPTURE(text);
            CHECK(text.find(what) != std::string::npos);
        };
        auto const with = [&](char const* option, nlohmann::json const& value) {
            auto json = nlohmann::json::parse(golden.unet_json);
            json[option] = value;
            folder.write("unet/config.json", json.dump());
        };
        with("in_channels", 9);
        says("option in_channels is 9, expected 4 (this is for inpainting)");
        with("time_cond_proj_dim", 256);
        says("option time_cond_proj_dim is 256, expected null (this is a latent consistency model, LCM)");
        with("addition_embed_type", "text_time");
        says("expected null (Stable Diffusion 1.x or 2.x; this is Stable Diffusion XL)");
        folder.write("unet/config.json", golden.unet_json);
        folder.write("model_index.json", R"({"_class_name": "StableDiffusionPipeline"})");
        CHECK_NOTHROW(files.config());
        folder.write("model_index.json", R"({"_class_name": "StableDiffusionXLPipeline"})");
        says("option _class_name is \"StableDiffusionXLPipeline\", expected a pipeline of Stable Diffusion 1.x or 2.x "
             "(this is Stable Diffusion XL)");
        folder.write("model_index.json", R"({"_class_name": "StableDiffusionInpaintPipeline"})");
        says("(this is a model for inpainting)");
    }

    TEST_CASE("a config that asks for more layers than can be is refused before they are made") {
        test_folder const folder;
        auto const& golden = golden_cases()[2];
        write_golden_folder(folder.path, golden, golden_configs()[2]);
        for (auto const* network : {"unet", "controlnet"}) {
            auto json =
                nlohmann::json::parse(std::string(network) == "unet" ? golden.unet_json : golden.controlnet_json);
            json["transformer_layers_per_block"] = 1000000;
            folder.write(std::string(network) + "/config.json", json.dump());
        }
        diffusers_folder const files(folder.path);
        auto source = files.unet<float>();
        auto const most = std::to_string(2 * source.stored_count() + 1000);
        site_list sites({8, 8});
        CHECK_THROWS_WITH_AS(unet<float>(files.config(), source, sites),
                             ((folder.path / "unet").string() + ": the config asks for more than " + most +
                              " tensors, expected about as many as there are")
                                 .c_str(),
                             file_error);
    }

    TEST_CASE("a VAE's attention is found under older names and a text encoder's tensors without their beginning") {
        test_folder const folder;
        std::filesystem::create_directories(folder.path / "vae");
        std::vector<float> const four{1, 2, 3, 4};
        auto const at = std::string("encoder.mid_block.attentions.0.");
        write_safetensors((folder.path / "vae" / "diffusion_pytorch_model.safetensors").string(),
                          {{at + "query.weight", {{2, 2, 1, 1}, four}},
                           {at + "proj_attn.weight", {{2, 2}, four}},
                           {at + "to_v.weight", {{2, 2}, four}},
                           {"quant_conv.weight", {{2, 2, 1, 1}, four}}});
        diffusers_folder const files(folder.path);
        auto const vae = files.places(model_part::vae);
        CHECK(vae.size() == 4);
        CHECK(vae.at(at + "to_q.weight").shape == std::vector<std::size_t>{2, 2});
        CHECK(vae.at(at + "to_q.weight").read<float>() == four);
        CHECK(vae.contains(at + "to_out.0.weight"));
        CHECK(vae.contains(at + "to_v.weight"));
        CHECK(vae.at("quant_conv.weight").shape.size() == 4);
        for (std::string const head : {"", "text_model."}) {
            write_safetensors((folder.path / "text_encoder" / "model.safetensors").string(),
                              {{head + "embeddings.token_embedding.weight", {{2, 2}, four}},
                               {head + "embeddings.position_ids", {{1, 4}, four}},
                               {head + "final_layer_norm.bias", {{4}, four}}});
            auto const text = files.places(model_part::text_encoder);
            CHECK(text.size() == 2);
            CHECK(text.contains("text_model.embeddings.token_embedding.weight"));
            CHECK(text.contains("text_model.final_layer_norm.bias"));
        }
    }

    TEST_CASE_TEMPLATE("networks that were written are read to the bit", Real, float, double) {
        written_networks const written;
        diffusers_folder const files(written.path());
        auto const config = files.config();
        CHECK(unet_json(config) == unet_json(small_config()));
        CHECK(controlnet_json(config) == controlnet_json(small_config()));
        CHECK(config.prediction_type == prediction::clean);
        auto denoising = files.template unet<Real>();
        auto control = files.template controlnet<Real>();
        build_networks(config, denoising, control);
        CHECK(denoising.values() == written.unet_weights.values());
        CHECK(denoising.parameter_count() == written.unet_weights.parameter_count());
        CHECK(control.values() == written.control_weights.values());
    }

    TEST_CASE("half the precision is near") {
        written_networks const written(safetensors_storage::f16);
        auto loaded = diffusers_folder(written.path()).unet<float>();
        auto const name = std::string("mid_block.resnets.0.conv1.weight");
        auto const found = loaded.take(name, {12, 12, 3, 3});
        auto const expected = written.unet_weights.values().at(name);
        for (std::size_t i = 0; i < found.size(); ++i) {
            CHECK(found[i] == doctest::Approx(expected[i]).epsilon(1e-3));
        }
    }

    TEST_CASE("the ControlNet may lie in a folder of its own") {
        written_networks const written;
        temporary_file const elsewhere("controlnet");
        std::filesystem::rename(written.path() / "controlnet", elsewhere.path());
        CHECK_THROWS_WITH_AS(diffusers_folder(written.path()).config(),
                             ((written.path() / "controlnet" / "config.json").string() +
                              ": file cannot be opened, expected a readable JSON file")
                                 .c_str(),
                             file_error);
        diffusers_folder const files(written.path(), elsewhere.path());
        auto denoising = files.unet<float>();
        auto control = files.controlnet<float>();
        CHECK_NOTHROW(build_networks(files.config(), denoising, control));
    }

    TEST_CASE("an architecture that the weights do not have is told by a tensor's name") {
        test_folder const folder;
        auto const& golden = golden_cases()[2];
        write_golden_folder(folder.path, golden, golden_configs()[2]);
        // As wide as can be written: no memory is asked for before the shapes agree.
        auto json = nlohmann::json::parse(golden.unet_json);
        json["block_out_channels"] = {1000000, 1000000, 1000000};
        json["attention_head_dim"] = 1;
        json["norm_num_groups"] = 1;
        folder.write("unet/config.json", json.dump());
        auto control = nlohmann::json::parse(golden.controlnet_json);
        control.update(nlohmann::json{
            {"block_out_channels", json["block_out_channels"]}, {"attention_head_dim", 1}, {"norm_num_groups", 1}});
        folder.write("controlnet/config.json", control.dump());
        diffusers_folder const files(folder.path);
        auto source = files.unet<float>();
        site_list sites({8, 8});
        try {
            unet<float> const network(files.config(), source, sites);
            FAIL("it was built");
        } catch (file_error const& error) {
            std::string const text = error.what();
            CHECK(text.starts_with((folder.path / "unet").string() + ": "));
            CHECK(text.find("tensors have another shape: conv_in.bias is [8] where [1000000] is asked for, ") !=
                  std::string::npos);
        }
    }
}
