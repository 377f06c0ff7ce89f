// SPDX-License-Identifier: MIT
// Tests of pipelines in folders and in single files.
#include <genrender/reference/pipeline_files.hpp>

#include "checkpoint_file.hpp"

#include <doctest/doctest.h>

#include <filesystem>
#include <string>
#include <vector>

using namespace genrender;

using namespace genrender::reference;
using namespace genrender::testing;

TEST_SUITE("reference/pipeline_files") {
    namespace {

    /// One architecture as a folder, as two single files, and a folder of its ControlNet alone.
    struct forms_of_pipeline {
        temporary_file folder{"folder"};
        temporary_file checkpoint{"checkpoint.safetensors"};
        temporary_file control{"control.safetensors"};
        std::filesystem::path path = folder.path();

        forms_of_pipeline() {
            auto const config = small_checkpoint_config(768);
            write_golden_model<unet<float>>(path / "unet", config, unet_json(config).dump(), "u.");
            write_golden_model<controlnet<float>>(path / "controlnet", config, controlnet_json(config).dump(), "c.");
            std::filesystem::create_directories(path / "scheduler");
            std::ofstream(path / "scheduler" / "scheduler_config.json") << scheduler_json(config);
            stored_network<unet<float>>(config, "unet").write(checkpoint.path());
            stored_network<controlnet<float>>(config, "controlnet").write(control.path());
        }
    };

    forms_of_pipeline const& forms() {
        static forms_of_pipeline const result;
        return result;
    }

    /// Builds both networks.
    void build(pipeline_files const& files) {
        auto const config = files.config();
        site_list sites({8, 8});
        auto control = files.tensors<float>(model_part::controlnet);
        controlnet<float> const built_control(config, control, sites);
        auto source = files.tensors<float>(model_part::unet);
        unet<float> const built(config, source, sites);
    }

    } // namespace

    TEST_CASE("a pipeline and its ControlNet may each be a folder or a file") {
        auto const folder = forms().path;
        std::filesystem::path const checkpoint = forms().checkpoint.path();
        std::filesystem::path const control = forms().control.path();
        CHECK_NOTHROW(build(pipeline_files(folder)));
        CHECK_NOTHROW(build(pipeline_files(folder, folder / "controlnet")));
        CHECK_NOTHROW(build(pipeline_files(folder, control)));
        CHECK_NOTHROW(build(pipeline_files(checkpoint, control)));
        CHECK_NOTHROW(build(pipeline_files(checkpoint, folder / "controlnet")));
        auto const unet_name = std::string("conv_in.bias");
        auto const value = [&](pipeline_files const& files, model_part part) {
            return files.tensors<float>(part).take(unet_name, {32}).front();
        };
        CHECK(value(pipeline_files(folder, control), model_part::unet) ==
              value(pipeline_files(folder), model_part::unet));
        CHECK(value(pipeline_files(folder, control), model_part::controlnet) ==
              golden_values("control_model.input_blocks.0.0.bias", 32).front());
        CHECK(pipeline_files(folder).folder() != nullptr);
        CHECK(pipeline_files(checkpoint).folder() == nullptr);
    }

    TEST_CASE("what a pipeline does not hold is said") {
        std::filesystem::path const checkpoint = forms().checkpoint.path();
        pipeline_files const files(checkpoint);
        CHECK(files.has(model_part::unet));
        CHECK_FALSE(files.has(model_part::controlnet));
        CHECK_FALSE(pipeline_files(forms().path).has(model_part::vae));
        CHECK_THROWS_WITH_AS(files.config(), (checkpoint.string() + ": file holds no ControlNet, expected one").c_str(),
                             file_error);
        CHECK_THROWS_WITH_AS(pipeline_files("/nowhere"),
                             "/nowhere: there is nothing, expected a diffusers folder or a safetensors file",
                             file_error);
        CHECK_THROWS_AS(pipeline_files(checkpoint, "/nowhere"), file_error);
    }

    TEST_CASE("a LoRA is merged into the UNet") {
        temporary_file const path("lora.safetensors");
        std::vector<float> const down(768, 1.0f);
        std::vector<float> const up(96, 0.25f);
        auto const stem = std::string("lora_unet_mid_block_attentions_0_transformer_blocks_0_attn2_to_k");
        write_safetensors(path.path(),
                          {{stem + ".lora_down.weight", {{1, 768}, down}}, {stem + ".lora_up.weight", {{96, 1}, up}}});
        auto const name = std::string("mid_block.attentions.0.transformer_blocks.0.attn2.to_k.weight");
        for (std::filesystem::path const& pipeline : {forms().path, std::filesystem::path(forms().checkpoint.path())}) {
            pipeline_files files(pipeline, forms().control.path());
            auto const before = files.tensors<float>(model_part::unet).take(name, {96, 768});
            files.add_lora(path.path(), 2);
            auto const after = files.tensors<float>(model_part::unet).take(name, {96, 768});
            CHECK(after[5] == before[5] + 0.5f);
            CHECK_NOTHROW(build(files));
        }
    }
}
