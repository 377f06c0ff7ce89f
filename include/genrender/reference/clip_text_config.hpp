// SPDX-License-Identifier: MIT
// The architecture of CLIP's text encoder.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/error.hpp>

#include <cstddef>

namespace genrender::reference {

/// The function between the two matrices of a layer's MLP.
enum class clip_activation {
    quick_gelu, ///< x / (1 + exp(-1.702 x)): OpenAI's CLIP, Stable Diffusion 1.x
    gelu,       ///< x Phi(x), exact: OpenCLIP, Stable Diffusion 2.x
};

/// What transformers' `CLIPTextModel` is built from, in its field names. The defaults are the text encoder of Stable
/// Diffusion 1.x; with hidden_size 1024, intermediate_size 4096, 16 heads, 23 layers and gelu it is that of 2.x.
struct clip_text_config {
    std::size_t vocab_size = 49408;                           ///< rows of the table of tokens
    std::size_t hidden_size = 768;                            ///< channels of a token
    std::size_t intermediate_size = 3072;                     ///< channels between the matrices of an MLP
    std::size_t num_hidden_layers = 12;                       ///< transformer layers
    std::size_t num_attention_heads = 12;                     ///< heads of each, a divisor of hidden_size
    std::size_t max_position_embeddings = 77;                 ///< most tokens of a text
    clip_activation hidden_act = clip_activation::quick_gelu; ///< of each MLP
    double layer_norm_eps = 1e-5;                             ///< of every LayerNorm
};

/// Throws value_error unless a text encoder can be built: no zero, heads that divide hidden_size, an epsilon above 0.
inline void require_config(clip_text_config const& config) {
    auto const function = "clip_text_config";
    for (auto const count : {config.vocab_size, config.hidden_size, config.intermediate_size, config.num_hidden_layers,
                             config.num_attention_heads, config.max_position_embeddings}) {
        require_value(count > 0, function, "a count", count, "above 0");
    }
    require_value(config.hidden_size % config.num_attention_heads == 0, function, "num_attention_heads",
                  config.num_attention_heads, "a divisor of hidden_size");
    require_value(config.layer_norm_eps > 0 && config.layer_norm_eps < 1, function, "layer_norm_eps",
                  config.layer_norm_eps, "a number in (0, 1)");
}

} // namespace genrender::reference

#include <genrender/core/end_header.inl>
