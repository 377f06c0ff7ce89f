// SPDX-License-Identifier: MIT
// Tests of inferring an architecture from shapes.
#include <genrender/reference/compvis_architecture.hpp>

#include <doctest/doctest.h>

#include <string>
#include <vector>

using namespace genrender;

using namespace genrender::reference;

TEST_SUITE("reference/compvis_architecture") {
    namespace {

    /// Shapes alone: nothing is read.
    tensor_places places_of_shapes(std::vector<std::pair<std::string, std::vector<std::size_t>>> const& shapes) {
        tensor_places places;
        for (auto const& [name, shape] : shapes) {
            places[name] = {nullptr, name, shape, 0};
        }
        return places;
    }

    /// The shapes by which Stable Diffusion is known.
    tensor_places great_unet(std::size_t context, bool is_linear) {
        auto const square =
            is_linear ? std::vector<std::size_t>{1280, 1280} : std::vector<std::size_t>{1280, 1280, 1, 1};
        std::vector<std::pair<std::string, std::vector<std::size_t>>> shapes{
            {"conv_in.weight", {320, 4, 3, 3}},
            {"conv_out.weight", {4, 320, 3, 3}},
            {"mid_block.attentions.0.proj_in.weight", square},
            {"mid_block.attentions.0.transformer_blocks.0.attn2.to_k.weight", {1280, context}}};
        std::size_t level = 0;
        for (std::size_t const channels : {320U, 640U, 1280U, 1280U}) {
            auto const block = "down_blocks." + std::to_string(level++);
            for (auto const* layer : {"0", "1"}) {
                shapes.push_back({block + ".resnets." + layer + ".conv1.weight", {channels, channels, 3, 3}});
                if (level < 4) {
                    shapes.push_back({block + ".attentions." + layer + ".proj_in.weight", {channels, channels}});
                }
            }
        }
        return places_of_shapes(shapes);
    }

    } // namespace

    TEST_CASE("Stable Diffusion 1.x has 8 heads a level and 2.x heads of 64 channels") {
        auto const first = infer_unet_config(great_unet(768, false), "file");
        CHECK(first.attention_head_dim == std::vector<std::size_t>{8, 8, 8, 8});
        CHECK_FALSE(first.use_linear_projection);
        auto const second = infer_unet_config(great_unet(1024, true), "file");
        CHECK(second.attention_head_dim == std::vector<std::size_t>{5, 10, 20, 20});
        CHECK(second.use_linear_projection);
        for (auto const& config : {first, second}) {
            CHECK(config.block_out_channels == std::vector<std::size_t>{320, 640, 1280, 1280});
            CHECK(config.level_has_attention == std::vector<bool>{true, true, true, false});
            CHECK(config.layers_per_block == 2);
            CHECK(config.transformer_layers_per_block == 1);
            CHECK(config.prediction_type == prediction::epsilon);
            CHECK_NOTHROW(require_config(config));
        }
    }

    TEST_CASE("a tensor without which nothing can be inferred is named") {
        auto const missing = [](char const* name, std::vector<std::size_t> const& shape) {
            auto places = great_unet(768, false);
            places.at(name).shape = shape;
            return places;
        };
        CHECK_THROWS_WITH_AS(infer_unet_config({}, "file"),
                             "file: there is no tensor conv_in.weight, expected one to infer the architecture from",
                             file_error);
        CHECK_THROWS_WITH_AS(infer_unet_config(missing("conv_in.weight", {320}), "file"),
                             "file: tensor conv_in.weight is [320], expected an axis 1 of 1 to 1000000", file_error);
        CHECK_THROWS_AS(infer_unet_config(missing("conv_in.weight", {320, 0, 3, 3}), "file"), file_error);
        CHECK_THROWS_AS(infer_unet_config(missing("conv_in.weight", {320, 1000001, 3, 3}), "file"), file_error);
        CHECK_THROWS_AS(infer_vae_options({}, "file"), file_error);
        CHECK_THROWS_AS(infer_text_options({}, "file", true), file_error);
    }
}
