// SPDX-License-Identifier: MIT
// Tests of merging a LoRA into weights, among them against diffusers and peft (make_lora_golden.py).
#include <genrender/reference/lora_merge.hpp>

#include "../support/golden_file.hpp"
#include "golden_network.hpp"

#include <genrender/reference/safetensors_weights.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <map>
#include <string>
#include <vector>

using namespace genrender;

using namespace genrender::reference;
using namespace genrender::testing;

TEST_SUITE("reference/lora_merge") {
    namespace {

    /// Tensors with golden_values of one name under another.
    struct tensor_writer {
        std::map<std::string, std::vector<float>> values;
        std::map<std::string, safetensors_source> sources;

        void add(std::string const& name, std::vector<std::size_t> const& shape, std::string const& golden) {
            std::size_t count = 1;
            for (auto const extent : shape) {
                count *= extent;
            }
            values[name] = golden_values(golden, count);
            sources[name] = {shape, values[name]};
        }
        void add_number(std::string const& name, float value) {
            values[name] = {value};
            sources[name] = {{}, values[name]};
        }
    };

    /// A base file of the named weights and a LoRA file, of which differences_of is asked.
    std::string refusal(tensor_writer const& base, tensor_writer const& lora, model_part part = model_part::unet) {
        temporary_file const base_path("base.safetensors");
        temporary_file const lora_path("lora.safetensors");
        write_safetensors(base_path.path(), base.sources);
        write_safetensors(lora_path.path(), lora.sources);
        auto source = read_weights<float>(base_path.path());
        try {
            add_lora(source, lora_file(lora_path.path()), part);
        } catch (file_error const& error) {
            return std::string(error.what()).substr(lora_path.path().size() + 2);
        }
        return "none";
    }

    } // namespace

    TEST_CASE_TEMPLATE("merged weights are those into which diffusers and peft fuse the LoRA", Real, float, double) {
        auto const golden = golden_file("lora.json");
        for (std::string const form : {"kohya", "peft", "older"}) {
            CAPTURE(form);
            tensor_writer base;
            tensor_writer lora;
            for (auto const& module : golden.at("modules")) {
                auto const name = module.at("name").get<std::string>();
                auto const shape = module.at("shape").get<std::vector<std::size_t>>();
                auto const rank = module.at("rank").get<std::size_t>();
                base.add(name + ".weight", shape, "lora.base." + name + ".weight");
                auto down = shape;
                down[0] = rank;
                std::vector<std::size_t> up(shape.size(), 1);
                up[0] = shape[0];
                up[1] = rank;
                auto key = name;
                std::replace(key.begin(), key.end(), '.', '_');
                auto const stem = form == "kohya" ? "lora_unet_" + key : "unet." + name;
                auto const is_kohya = form == "kohya";
                lora.add(stem +
                             (is_kohya         ? ".lora_down"
                              : form == "peft" ? ".lora_A"
                                               : ".lora.down") +
                             ".weight",
                         down, "lora.down." + name);
                lora.add(stem +
                             (is_kohya         ? ".lora_up"
                              : form == "peft" ? ".lora_B"
                                               : ".lora.up") +
                             ".weight",
                         up, "lora.up." + name);
                if (is_kohya) {
                    lora.add_number(stem + ".alpha", golden.at("alpha").get<float>());
                }
            }
            temporary_file const base_path("base.safetensors");
            temporary_file const lora_path("lora.safetensors");
            write_safetensors(base_path.path(), base.sources);
            write_safetensors(lora_path.path(), lora.sources);
            auto source = read_weights<Real>(base_path.path());
            add_lora(source, lora_file(lora_path.path()), model_part::unet, golden.at("scale").get<double>());
            auto const& fused = golden.at("fused").at(form == "kohya" ? "kohya" : "peft");
            for (auto const& module : golden.at("modules")) {
                auto const name = module.at("name").get<std::string>();
                CAPTURE(name);
                auto const values = source.take(name + ".weight", module.at("shape").get<std::vector<std::size_t>>());
                auto const expected = fused.at(name).get<std::vector<double>>();
                auto const step = std::max<std::size_t>(1, values.size() / 8);
                for (std::size_t i = 0; i < expected.size(); ++i) {
                    CHECK(static_cast<double>(values[i * step]) == doctest::Approx(expected[i]).epsilon(1e-6));
                }
            }
        }
    }

    TEST_CASE("two LoRAs add up and what they do not name stays") {
        temporary_file const base_path("base.safetensors");
        temporary_file const lora_path("lora.safetensors");
        std::vector<float> const ones{1, 1, 1, 1};
        write_safetensors(base_path.path(), {{"a.weight", {{2, 2}, ones}}, {"b.weight", {{2, 2}, ones}}});
        std::vector<float> const down{1, 2};
        std::vector<float> const up{3, 4};
        write_safetensors(lora_path.path(),
                          {{"unet.a.lora_A.weight", {{1, 2}, down}}, {"unet.a.lora_B.weight", {{2, 1}, up}}});
        lora_file const lora(lora_path.path());
        auto source = read_weights<float>(base_path.path());
        add_lora(source, lora, model_part::unet, 1);
        add_lora(source, lora, model_part::unet, -0.5);
        add_lora(source, lora, model_part::text_encoder, 1);
        CHECK(source.take("a.weight", {2, 2}) == std::vector<float>{2.5f, 4, 3, 5});
        CHECK(source.take("b.weight", {2, 2}) == ones);
        CHECK(source.values().at("a.weight") == std::vector<float>{2.5f, 4, 3, 5});
    }

    TEST_CASE("names of a text encoder are found with and without what all of them begin with") {
        for (auto const* stem : {"text_encoder.text_model.a", "text_encoder.a", "lora_te_text_model_a"}) {
            tensor_writer base;
            tensor_writer lora;
            base.add("text_model.a.weight", {2, 3}, "x");
            lora.add(stem + std::string(".lora_A.weight"), {1, 3}, "y");
            lora.add(stem + std::string(".lora_B.weight"), {2, 1}, "z");
            CHECK(refusal(base, lora, model_part::text_encoder) == "none");
        }
    }

    TEST_CASE("underscores that may be two names are refused") {
        tensor_writer base;
        tensor_writer lora;
        base.add("a.b_c.weight", {2, 3}, "x");
        base.add("a_b.c.weight", {2, 3}, "x");
        lora.add("lora_unet_a_b_c.lora_down.weight", {1, 3}, "y");
        lora.add("lora_unet_a_b_c.lora_up.weight", {2, 1}, "z");
        CHECK(refusal(base, lora) == "module a_b_c may be a.b_c.weight or a_b.c.weight, expected one");
    }

    TEST_CASE("names of CompVis' UNet are found whose layers are counted otherwise") {
        tensor_writer base;
        tensor_writer lora;
        base.add("down_blocks.0.resnets.0.conv1.weight", {2, 3, 3, 3}, "x");
        base.add("down_blocks.1.attentions.0.proj_in.weight", {2, 3}, "x");
        lora.add("lora_unet_input_blocks_3_1_proj_in.lora_down.weight", {1, 3}, "y");
        lora.add("lora_unet_input_blocks_3_1_proj_in.lora_up.weight", {2, 1}, "z");
        CHECK(refusal(base, lora) == "none");
        base.add("down_blocks.0.resnets.1.conv1.weight", {2, 3, 3, 3}, "x");
        CHECK(refusal(base, lora) ==
              "1 of 1 modules have no place in the UNet: input_blocks_3_1_proj_in, expected none");
    }

    TEST_CASE("modules without a weight and factors of another shape are named") {
        tensor_writer base;
        tensor_writer lora;
        base.add("a.weight", {2, 3, 3, 3}, "x");
        lora.add("unet.a.lora_A.weight", {1, 3}, "y");
        lora.add("unet.a.lora_B.weight", {2, 1}, "z");
        CHECK(refusal(base, lora) ==
              "factors of unet.a.lora_A.weight are [1, 3] and [2, 1], expected those of a.weight "
              "[2, 3, 3, 3]");
        lora.add("unet.a.lora_A.weight", {1, 3, 9, 1}, "y");
        CHECK(refusal(base, lora) != "none");
        lora.add("unet.a.lora_A.weight", {1, 3, 3, 3}, "y");
        CHECK(refusal(base, lora) == "none");
        lora.add("unet.c.lora_A.weight", {1, 3}, "y");
        lora.add("unet.c.lora_B.weight", {2, 1}, "z");
        CHECK(refusal(base, lora) == "1 of 2 modules have no place in the UNet: c, expected none");
    }

    TEST_CASE("a LoRA needs weights of files and a finite scale") {
        temporary_file const base_path("base.safetensors");
        temporary_file const lora_path("lora.safetensors");
        tensor_writer lora;
        lora.add("unet.a.lora_A.weight", {1, 3}, "y");
        lora.add("unet.a.lora_B.weight", {2, 1}, "z");
        write_safetensors(lora_path.path(), lora.sources);
        auto seeded = weights<float>::seeded(1, "unet");
        CHECK_THROWS_WITH_AS(add_lora(seeded, lora_file(lora_path.path()), model_part::unet),
                             "add_lora: tensors is random, expected of files, where a LoRA is to be merged",
                             value_error);
        tensor_writer base;
        base.add("a.weight", {2, 3}, "x");
        write_safetensors(base_path.path(), base.sources);
        auto source = read_weights<float>(base_path.path());
        CHECK_THROWS_WITH_AS(add_lora(source, lora_file(lora_path.path()), model_part::unet, std::nan("")),
                             "weights: scale is nan, expected a finite number", value_error);
    }
}
