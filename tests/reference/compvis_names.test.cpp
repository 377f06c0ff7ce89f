// SPDX-License-Identifier: MIT
// Tests of names in single-file checkpoints, among them all that diffusers' own converters know.
#include <genrender/reference/compvis_names.hpp>

#include "../support/golden_file.hpp"

#include <doctest/doctest.h>

#include <cstddef>
#include <set>
#include <string>

using namespace genrender;

using namespace genrender::reference;

TEST_SUITE("reference/compvis_names") {
    namespace {

    /// The one tensor that a stored one is, or "none", "some".
    std::string name_of(std::string const& stored, compvis_layout const& layout = {}) {
        auto const named = diffusers_names(stored, layout);
        return !named ? "none" : named->tensors.size() != 1 ? "some" : named->tensors.front().name;
    }

    } // namespace

    TEST_CASE("every tensor of Stable Diffusion and its ControlNet has the name that diffusers gives it") {
        auto const golden = testing::golden_file("compvis_names.json");
        std::size_t tensors = 0;
        for (auto const& [network, part] : golden.items()) {
            auto const expected_part = network == "unet"         ? model_part::unet
                                       : network == "controlnet" ? model_part::controlnet
                                       : network == "vae"        ? model_part::vae
                                                                 : model_part::text_encoder;
            std::set<std::string> given;
            for (auto const& pair : part.at("pairs")) {
                auto const letters = pair.at(2).get<std::string>();
                auto const change = pair.at(3).get<std::string>();
                for (auto const letter : letters == "whole" ? std::string(" ") : letters) {
                    auto const* const suffix = letter == ' ' ? "" : letter == 'b' ? "bias" : "weight";
                    auto const stored = pair.at(0).get<std::string>() + suffix;
                    auto const expected = pair.at(1).get<std::string>() + suffix;
                    CAPTURE(stored);
                    auto const named = diffusers_names(stored);
                    REQUIRE(named);
                    CHECK(named->part == expected_part);
                    auto const is_fused = change.starts_with("third ");
                    auto const index = is_fused ? static_cast<std::size_t>(std::stoi(change.substr(6))) : 0;
                    REQUIRE(named->tensors.size() == (is_fused ? 3 : 1));
                    auto const& tensor = named->tensors[index];
                    CHECK(tensor.name == expected);
                    CHECK(tensor.parts == (is_fused ? 3 : 1));
                    CHECK(tensor.part == index);
                    CHECK(tensor.is_matrix == (letter == 'm'));
                    CHECK(given.insert(tensor.name).second);
                    CHECK_FALSE(is_training_leftover(stored));
                    ++tensors;
                }
            }
        }
        CHECK(tensors == 686 + 340 + 248 + 196 + 372);
    }

    TEST_CASE("what diffusers leaves is the projection and the last layer of OpenCLIP") {
        auto const golden = testing::golden_file("compvis_names.json");
        for (auto const& name : golden.at("open_clip").at("left")) {
            auto const stored = name.get<std::string>();
            CAPTURE(stored);
            CHECK((is_training_leftover(stored) ||
                   stored.starts_with("cond_stage_model.model.transformer.resblocks.23.")));
        }
    }

    TEST_CASE("layers are counted as the network has them") {
        auto const stored = std::string("model.diffusion_model.output_blocks.3.1.conv.weight");
        CHECK(name_of(stored, {1, 4}) == "up_blocks.1.upsamplers.0.conv.weight");
        CHECK(name_of(stored, {3, 4}) == "up_blocks.0.upsamplers.0.conv.weight");
        CHECK(name_of(stored) == "none"); // the first of three layers has no upsampler
        CHECK(name_of("first_stage_model.decoder.up.0.block.1.norm1.bias", {2, 3}) ==
              "decoder.up_blocks.2.resnets.1.norm1.bias");
    }

    TEST_CASE("names of no place are known to nobody") {
        for (auto const* name :
             {"", ".", "model.diffusion_model.", "model.diffusion_model.input_blocks.0.1.norm.weight",
              "model.diffusion_model.input_blocks.x.0.in_layers.0.weight", "model.diffusion_model.input_blocks.1",
              "model.diffusion_model.input_blocks.99999999999999999999.0.in_layers.0.weight",
              "model.diffusion_model.input_blocks.-1.0.in_layers.0.weight",
              "model.diffusion_model.input_blocks.1.0.in_layers.1.weight",
              "model.diffusion_model.zero_convs.0.0.weight", "model.diffusion_model.label_emb.0.0.weight",
              "control_model.out.2.weight", "control_model.output_blocks.0.0.in_layers.0.weight",
              "first_stage_model.encoder.up.0.block.0.norm1.bias", "first_stage_model.decoder.up.7.block.0.norm1.bias",
              "first_stage_model.mid.attn_1.q.weight",
              "cond_stage_model.model.transformer.resblocks.0.attn.in_proj_.weight", "cond_stage_model.transformer.x",
              "conv_in.weight"}) {
            CAPTURE(name);
            CHECK(name_of(name) == "none");
            CHECK_FALSE(is_training_leftover(name));
        }
    }

    TEST_CASE("what training leaves is known by name") {
        for (auto const* name : {"betas", "alphas_cumprod", "posterior_mean_coef1", "model_ema.decay",
                                 "model_ema.diffusion_modeloutblocks0", "first_stage_model.loss.logvar", "global_step",
                                 "cond_stage_model.transformer.text_model.embeddings.position_ids",
                                 "cond_stage_model.model.logit_scale"}) {
            CAPTURE(name);
            CHECK(is_training_leftover(name));
        }
        CHECK_FALSE(is_training_leftover("betas2"));
    }
}
