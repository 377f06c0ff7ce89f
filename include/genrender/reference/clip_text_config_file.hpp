// SPDX-License-Identifier: MIT
// The config.json of CLIP's text encoder, as transformers writes it.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/reference/clip_text_config.hpp>
#include <genrender/reference/config_file.hpp>

#include <nlohmann/json.hpp>

#include <string>
#include <vector>

namespace genrender::reference {

/// The architecture in the config.json of a CLIPTextModel. Absent options have transformers' defaults. Throws file_error
/// naming the option that is unknown or has a value that the encoder here cannot follow.
inline clip_text_config read_clip_text_config(config_file file) {
    file.expect("model_type", {"clip_text_model"});
    file.expect("architectures", {nullptr, nlohmann::json::array({"CLIPTextModel"})});
    clip_text_config config;
    config.vocab_size = file.count("vocab_size", 49408);
    config.hidden_size = file.count("hidden_size", 512);
    config.intermediate_size = file.count("intermediate_size", 2048);
    config.num_hidden_layers = file.count("num_hidden_layers", 12);
    config.num_attention_heads = file.count("num_attention_heads", 8);
    config.max_position_embeddings = file.count("max_position_embeddings", 77);
    auto const activation = file.text("hidden_act", "quick_gelu");
    file.require(activation == "quick_gelu" || activation == "gelu", "hidden_act", "\"quick_gelu\" or \"gelu\"");
    config.hidden_act = activation == "gelu" ? clip_activation::gelu : clip_activation::quick_gelu;
    config.layer_norm_eps = file.number("layer_norm_eps", 1e-5);
    file.require(config.layer_norm_eps > 0 && config.layer_norm_eps < 1, "layer_norm_eps", "a number in (0, 1)");
    file.require(config.hidden_size % config.num_attention_heads == 0, "num_attention_heads",
                 "a divisor of the " + std::to_string(config.hidden_size) + " of hidden_size");
    // Names and versions; how weights began and what training dropped; the pooled output, which nobody asks for here,
    // and the tokens that it looks for; what a caller of transformers gets back.
    file.ignore({"_name_or_path", "_class_name", "transformers_version", "torch_dtype", "dtype", "attention_dropout",
                 "dropout", "initializer_factor", "initializer_range", "projection_dim", "bos_token_id", "eos_token_id",
                 "pad_token_id", "output_attentions", "output_hidden_states", "return_dict", "use_return_dict"});
    file.require_all_taken();
    return config;
}

/// The config.json of a CLIPTextModel.
inline nlohmann::json clip_text_json(clip_text_config const& config) {
    return {{"architectures", {"CLIPTextModel"}},
            {"model_type", "clip_text_model"},
            {"vocab_size", config.vocab_size},
            {"hidden_size", config.hidden_size},
            {"intermediate_size", config.intermediate_size},
            {"num_hidden_layers", config.num_hidden_layers},
            {"num_attention_heads", config.num_attention_heads},
            {"max_position_embeddings", config.max_position_embeddings},
            {"hidden_act", config.hidden_act == clip_activation::gelu ? "gelu" : "quick_gelu"},
            {"layer_norm_eps", config.layer_norm_eps}};
}
} // namespace genrender::reference

#include <genrender/core/end_header.inl>
