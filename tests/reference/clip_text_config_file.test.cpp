// SPDX-License-Identifier: MIT
// Tests of the text encoder's architecture in transformers' words.
#include <genrender/reference/clip_text_config_file.hpp>

#include "../support/golden_file.hpp"
#include "small_networks.hpp"

#include <doctest/doctest.h>

#include <fstream>
#include <limits>
#include <string>

using namespace genrender;

using namespace genrender::reference;
using namespace genrender::testing;

TEST_SUITE("reference/clip_text_config_file") {
    /// `text_encoder/config.json` of Stable Diffusion 1.5 as it was published.
    constexpr auto published_text_encoder = R"({
        "_name_or_path": "openai/clip-vit-large-patch14", "architectures": ["CLIPTextModel"], "attention_dropout": 0.0,
        "bos_token_id": 0, "dropout": 0.0, "eos_token_id": 2, "hidden_act": "quick_gelu", "hidden_size": 768,
        "initializer_factor": 1.0, "initializer_range": 0.02, "intermediate_size": 3072, "layer_norm_eps": 1e-05,
        "max_position_embeddings": 77, "model_type": "clip_text_model", "num_attention_heads": 12,
        "num_hidden_layers": 12, "pad_token_id": 1, "projection_dim": 768, "torch_dtype": "float32",
        "transformers_version": "4.22.0.dev0", "vocab_size": 49408})";

    clip_text_config read_text(std::string const& text, std::string const& path) {
        std::ofstream(path) << text;
        return read_clip_text_config(config_file(path));
    }

    TEST_CASE("the file of Stable Diffusion 1.5 is the default") {
        temporary_file const file("config.json");
        CHECK(clip_text_json(read_text(published_text_encoder, file.path())) == clip_text_json({}));
    }

    TEST_CASE("absent options have transformers' defaults") {
        temporary_file const file("config.json");
        auto const config = read_text("{}", file.path());
        CHECK(config.hidden_size == 512);
        CHECK(config.intermediate_size == 2048);
        CHECK(config.num_attention_heads == 8);
        CHECK(config.num_hidden_layers == 12);
        CHECK(config.vocab_size == 49408);
        CHECK(config.max_position_embeddings == 77);
        CHECK(config.hidden_act == clip_activation::quick_gelu);
        CHECK(config.layer_norm_eps == 1e-5);
    }

    TEST_CASE("what transformers writes is read, and what is written here is read back") {
        temporary_file const file("config.json");
        auto const cases = golden_file("clip_text.json").at("cases");
        auto const config = read_text(cases.at(1).at("config").dump(), file.path());
        CHECK(config.hidden_act == clip_activation::gelu);
        CHECK(config.layer_norm_eps == 1e-3);
        CHECK(config.num_hidden_layers == 2);
        CHECK(config.intermediate_size == 36);
        CHECK(clip_text_json(read_text(clip_text_json(config).dump(), file.path())) == clip_text_json(config));
    }

    TEST_CASE("what the encoder cannot follow is refused by name") {
        temporary_file const file("config.json");
        auto const check = [&](std::string const& option, nlohmann::json const& value, std::string const& sentence) {
            auto json = nlohmann::json::parse(published_text_encoder);
            json[option] = value;
            auto const text = file.path() + ": option " + option + " is " + value.dump() + ", expected " + sentence;
            CHECK_THROWS_WITH_AS(read_text(json.dump(), file.path()), text.c_str(), file_error);
        };
        check("model_type", "clip", "\"clip_text_model\"");
        check("architectures", {"CLIPTextModelWithProjection"}, "null or [\"CLIPTextModel\"]");
        check("hidden_act", "gelu_new", "\"quick_gelu\" or \"gelu\"");
        check("num_attention_heads", 7, "a divisor of the 768 of hidden_size");
        check("layer_norm_eps", 0, "a number in (0, 1)");
        check("hidden_size", -1, "a whole number from 1 to 1000000");
        auto json = nlohmann::json::parse(published_text_encoder);
        json["use_attention_mask"] = true;
        CHECK_THROWS_WITH_AS(read_text(json.dump(), file.path()),
                             (file.path() + ": 1 options are unknown: use_attention_mask, expected none").c_str(),
                             file_error);
    }
}
