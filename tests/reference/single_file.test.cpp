// SPDX-License-Identifier: MIT
// Tests of single-file checkpoints.
#include <genrender/reference/single_file.hpp>

#include "checkpoint_file.hpp"

#include <genrender/reference/autoencoder_config.hpp>
#include <genrender/reference/clip_text_config.hpp>

#include <doctest/doctest.h>

#include <array>
#include <fstream>
#include <string>
#include <vector>

using namespace genrender;

using namespace genrender::reference;
using namespace genrender::testing;

TEST_SUITE("reference/single_file") {
    namespace {

    /// What opening a file of these tensors says.
    std::string refusal(tensor_list const& tensors) {
        temporary_file const file("checkpoint.safetensors");
        tensors.write(file.path());
        try {
            single_file const opened(file.path());
        } catch (file_error const& error) {
            std::string const text = error.what();
            return text.starts_with(file.path() + ": ") ? text.substr(file.path().size() + 2) : "another path: " + text;
        }
        return "none";
    }

    /// A UNet, with leftovers of training.
    tensor_list small_unet(std::size_t cross_attention_dim = 768) {
        auto tensors = stored_network<unet<float>>(small_checkpoint_config(cross_attention_dim), "unet");
        return tensors.add("betas", {10}).add("model_ema.decay", {1}).add("first_stage_model.loss.logvar", {1});
    }

    } // namespace

    TEST_CASE("the networks of a checkpoint have the values of the stored tensors and all are taken") {
        for (std::size_t const width : {768U, 1024U}) {
            temporary_file const path("checkpoint.safetensors");
            auto const tensors = small_unet(width);
            tensors.write(path.path());
            single_file const file(path.path(), width == 768 ? std::nullopt : std::optional(prediction::velocity));
            CHECK(file.has(model_part::unet));
            CHECK_FALSE(file.has(model_part::vae));
            auto source = file.tensors<float>(model_part::unet);
            auto const config = small_checkpoint_config(width);
            site_list sites({8, 8});
            REQUIRE_NOTHROW(unet<float>(config, source, sites));
            CHECK(source.taken().size() == 686);
            for (auto const& names : stored_names("unet")) {
                CAPTURE(names.first);
                auto const values = file.places(model_part::unet).at(names.first).read<float>();
                CHECK(values == golden_values(names.second, values.size()));
            }
        }
    }

    TEST_CASE("the architecture is inferred") {
        for (std::size_t const width : {768U, 1024U}) {
            temporary_file const path("checkpoint.safetensors");
            temporary_file const control_path("control.safetensors");
            small_unet(width).write(path.path());
            auto const expected = small_checkpoint_config(width);
            auto control = stored_network<controlnet<float>>(expected, "controlnet");
            SUBCASE("with a prefix") {}
            SUBCASE("without a prefix") {
                tensor_list bare;
                for (auto const& [name, shape] : control.shapes) {
                    bare.add(name.substr(std::string("control_model.").size()), shape);
                }
                control = bare;
            }
            control.write(control_path.path());
            single_file const file(path.path(), prediction::velocity);
            single_file const control_file(control_path.path());
            auto const config = read_diffusers_config(
                file.options(model_part::unet), control_file.options(model_part::controlnet), file.scheduler_options());
            CHECK(config.block_out_channels == expected.block_out_channels);
            CHECK(config.level_has_attention == expected.level_has_attention);
            CHECK(config.attention_head_dim == expected.attention_head_dim);
            CHECK(config.layers_per_block == 2);
            CHECK(config.transformer_layers_per_block == 1);
            CHECK(config.use_linear_projection == (width == 1024));
            CHECK(config.cross_attention_dim == width);
            CHECK(config.norm_num_groups == 32);
            CHECK(config.conditioning_embedding_out_channels == expected.conditioning_embedding_out_channels);
            CHECK(config.prediction_type == prediction::velocity);
            auto source = control_file.tensors<float>(model_part::controlnet);
            site_list sites({8, 8});
            CHECK_NOTHROW(controlnet<float>(config, source, sites));
        }
    }

    TEST_CASE("what a UNet of 2.x predicts must be told and of 1.x is noise") {
        temporary_file const path("checkpoint.safetensors");
        small_unet(1024).write(path.path());
        CHECK_THROWS_WITH_AS(single_file(path.path()).scheduler_options(),
                             (path.path() + ": what this UNet of Stable Diffusion 2.x predicts is not in the file, "
                                            "expected to be told: epsilon (512-base) or velocity (768-v)")
                                 .c_str(),
                             file_error);
        CHECK(single_file(path.path(), prediction::epsilon).scheduler_options()["prediction_type"] == "epsilon");
        small_unet(768).write(path.path());
        CHECK(single_file(path.path()).scheduler_options()["prediction_type"] == "epsilon");
    }

    TEST_CASE("the VAE's attention is matrices and its levels are counted from the pictures") {
        temporary_file const path("checkpoint.safetensors");
        stored_vae().write(path.path());
        single_file const file(path.path());
        auto const& places = file.places(model_part::vae);
        CHECK(places.size() == 248);
        CHECK(places.at("decoder.mid_block.attentions.0.to_q.weight").shape == std::vector<std::size_t>{32, 32});
        CHECK(places.at("decoder.up_blocks.0.resnets.0.conv1.weight").stored ==
              "first_stage_model.decoder.up.3.block.0.conv1.weight");
        auto const options = file.options(model_part::vae);
        CHECK(options["block_out_channels"] == std::vector<int>{32, 32, 32, 32});
        CHECK(options["layers_per_block"] == 2);
        CHECK(options["latent_channels"] == 4);
        CHECK(options["in_channels"] == 3);
        CHECK(options["scaling_factor"] == 0.18215);
        CHECK(read_autoencoder_config(file.options(model_part::vae)).block_out_channels ==
              std::vector<std::size_t>{32, 32, 32, 32});
    }

    TEST_CASE("OpenCLIP's fused matrices come apart and its last layer is left") {
        temporary_file const path("checkpoint.safetensors");
        auto const head = std::string("cond_stage_model.model.");
        tensor_list tensors;
        tensors.add(head + "token_embedding.weight", {10, 64}).add(head + "positional_embedding", {7, 64});
        tensors.add(head + "text_projection", {64, 64});
        for (auto const* layer : {"0", "1", "2"}) {
            auto const at = head + "transformer.resblocks." + layer + ".";
            tensors.add(at + "attn.in_proj_weight", {192, 64}).add(at + "attn.in_proj_bias", {192});
            tensors.add(at + "mlp.c_fc.weight", {256, 64});
        }
        tensors.write(path.path());
        single_file const file(path.path());
        auto const& places = file.places(model_part::text_encoder);
        auto const fused = golden_values(head + "transformer.resblocks.1.attn.in_proj_weight", 3 * 64 * 64);
        std::size_t third = 0;
        for (auto const* name : {"q", "k", "v"}) {
            auto const& place =
                places.at("text_model.encoder.layers.1.self_attn." + std::string(name) + "_proj.weight");
            CHECK(place.shape == std::vector<std::size_t>{64, 64});
            auto const begin = fused.begin() + static_cast<std::ptrdiff_t>(third++ * 64 * 64);
            CHECK(place.read<float>() == std::vector<float>(begin, begin + 64 * 64));
        }
        CHECK(places.at("text_model.encoder.layers.0.self_attn.v_proj.bias").first == 128);
        CHECK_FALSE(places.contains("text_model.encoder.layers.2.mlp.fc1.weight"));
        auto const options = file.options(model_part::text_encoder);
        CHECK(options["num_hidden_layers"] == 2);
        CHECK(options["hidden_act"] == "gelu");
        CHECK(options["hidden_size"] == 64);
        CHECK(options["intermediate_size"] == 256);
        CHECK(options["vocab_size"] == 10);
        CHECK(read_clip_text_config(file.options(model_part::text_encoder)).hidden_act == clip_activation::gelu);
        CHECK(refusal(tensors.add(head + "transformer.resblocks.0.attn.in_proj_bias", {191})) ==
              "tensor cond_stage_model.model.transformer.resblocks.0.attn.in_proj_bias is [191], expected rows of "
              "queries, keys and values");
    }

    TEST_CASE("CLIP's layers are all kept") {
        temporary_file const path("checkpoint.safetensors");
        auto const head = std::string("cond_stage_model.transformer.text_model.");
        tensor_list tensors;
        tensors.add(head + "embeddings.token_embedding.weight", {10, 128});
        tensors.add(head + "embeddings.position_embedding.weight", {77, 128});
        tensors.add(head + "embeddings.position_ids", {1, 77});
        for (auto const* layer : {"0", "1", "2"}) {
            tensors.add(head + "encoder.layers." + layer + ".mlp.fc1.weight", {256, 128});
        }
        tensors.write(path.path());
        single_file const file(path.path());
        CHECK(file.places(model_part::text_encoder).size() == 5);
        auto const options = file.options(model_part::text_encoder);
        CHECK(options["num_hidden_layers"] == 3);
        CHECK(options["num_attention_heads"] == 2);
        CHECK(options["hidden_act"] == "quick_gelu");
        CHECK(read_clip_text_config(file.options(model_part::text_encoder)).num_hidden_layers == 3);
        CHECK_THROWS_WITH_AS(file.options(model_part::vae), (path.path() + ": file holds no VAE, expected one").c_str(),
                             file_error);
    }

    TEST_CASE("checkpoints of other architectures are refused by name") {
        auto const unet = small_unet();
        auto const first = std::string("model.diffusion_model.input_blocks.0.0.weight");
        auto const says = [&](tensor_list tensors, std::string const& what) {
            auto const text = refusal(tensors);
            CAPTURE(text);
            CHECK(text.find(what) != std::string::npos);
        };
        auto const with = [&](char const* name) { return tensor_list(unet).add(name, {1}); };
        says(with("conditioner.embedders.0.transformer.text_model.x"), "checkpoint is of Stable Diffusion XL");
        says(with("model.diffusion_model.label_emb.0.0.weight"), "told a class or a size beside the prompt");
        says(with("model.diffusion_model.joint_blocks.0.x"), "checkpoint is of Stable Diffusion 3");
        says(with("double_blocks.0.img_attn.qkv.weight"), "checkpoint is of Flux");
        says(with("model.diffusion_model.time_embed.cond_proj.weight"), "latent consistency model (LCM)");
        says(with("lora_unet_mid_block_attentions_0_proj_in.alpha"), "checkpoint is a LoRA");
        says(with("down_blocks.0.resnets.0.conv1.weight"), "one network of a diffusers folder");
        says(
            tensor_list(unet).add(first, {32, 9, 3, 3}),
            "checkpoint is for inpainting (its UNet takes 9 channels), expected one that takes the 4 of latents alone");
        says(tensor_list(unet).add(first, {32, 8, 3, 3}), "InstructPix2Pix");
        says(tensor_list(unet).add(first, {32, 5, 3, 3}), "depth2img");
    }

    TEST_CASE("unknown tensors and empty files are refused") {
        auto tensors = small_unet();
        for (auto const* name : {"a", "b", "c", "d", "e", "f"}) {
            tensors.add(name, {1});
        }
        CHECK(refusal(tensors) ==
              "6 tensors are unknown: a, b, c, d, e, ..., expected those of Stable Diffusion 1.x or "
              "2.x or of a ControlNet");
        CHECK(refusal(tensor_list()).starts_with("file holds no network"));
        CHECK(refusal(tensor_list().add("betas", {3})).starts_with("file holds no network"));
        auto odd = small_unet();
        odd.add("model.diffusion_model.middle_block.1.transformer_blocks.0.attn2.to_k.weight", {64, 700});
        CHECK(refusal(odd) ==
              "checkpoint attends to tokens of 700 channels, expected the 768 of Stable Diffusion 1.x or "
              "the 1024 of 2.x");
        CHECK(refusal(tensor_list().add("model.diffusion_model.out.0.weight", {32})) ==
              "there is no tensor conv_in.weight, expected one to infer the architecture from");
    }

    TEST_CASE("a pickle is refused before it is read") {
        temporary_file const path("model.ckpt");
        std::ofstream(path.path()) << "PK\3\4";
        CHECK_THROWS_AS(single_file(path.path()), file_error);
    }
}
