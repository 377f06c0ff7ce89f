// SPDX-License-Identifier: MIT
// CLIP's text encoder (Radford et al. 2021), layer for layer transformers' CLIPTextModel: tokens of a prompt to rows
// that a UNet attends to.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/error.hpp>
#include <genrender/core/parallel.hpp>
#include <genrender/core/stack.hpp>
#include <genrender/reference/clip_text_config.hpp>
#include <genrender/reference/clip_text_layer.hpp>
#include <genrender/reference/layer_norm.hpp>
#include <genrender/reference/weights.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace genrender::reference {

/// Embeddings of tokens and positions, transformer layers, a last norm. Its pooled output is not made.
template <class Real>
class clip_text_encoder {
public:
    /// Takes every tensor of transformers' CLIPTextModel from `source`, whose names begin with `text_model` or, in files
    /// of transformers 5, do not; `embeddings.position_ids`, which old files hold, may be left over. Throws value_error
    /// if the config cannot be built, file_error if a tensor is missing, misshapen or left over.
    clip_text_encoder(clip_text_config const& config, weights<Real>& source)
        : clip_text_encoder(config, source, source.holds("embeddings.token_embedding.weight") ? "" : "text_model.") {}

    /// The architecture that it is of.
    clip_text_config const& config() const { return config_; }
    /// Most tokens of a text.
    std::size_t most_tokens() const { return config_.max_position_embeddings; }
    /// Channels of a row of the result.
    std::size_t channels() const { return config_.hidden_size; }

    /// The last hidden state [tokens, channels] of the tokens with these numbers, row t a function of tokens 0 to t; of
    /// the layers all but the last `skipped` run before the last norm (diffusers' clip_skip). Work is shared out over
    /// `loop`. Throws value_error for no token, more than most_tokens(), a number that is not below vocab_size, or if
    /// all layers are skipped.
    stack<Real, 2> operator()(std::span<std::uint32_t const> ids, any_loop const& loop = {},
                              std::size_t skipped = 0) const {
        auto const function = "clip_text_encoder";
        require_value(!ids.empty() && ids.size() <= most_tokens(), function, "tokens of ids", ids.size(),
                      ("from 1 to " + std::to_string(most_tokens())).c_str());
        require_value(skipped < layers_.size(), function, "skipped", skipped,
                      ("below the " + std::to_string(layers_.size()) + " layers").c_str());
        auto h = stack<Real, 2>::uninitialized({ids.size(), channels()});
        for (std::size_t t = 0; t < ids.size(); ++t) {
            require_value(ids[t] < config_.vocab_size, function, "ids", ids[t],
                          ("below " + std::to_string(config_.vocab_size)).c_str());
            auto const row = h.view()[t].row();
            for (std::size_t c = 0; c < row.size(); ++c) {
                row[c] = tokens_[ids[t] * channels() + c] + positions_[t * channels() + c];
            }
        }
        for (std::size_t i = 0; i + skipped < layers_.size(); ++i) {
            layers_[i](h.view(), loop);
        }
        final_layer_norm_(h.view(), h);
        return h;
    }

private:
    clip_text_encoder(clip_text_config const& config, weights<Real>& source, std::string const& name)
        : config_((require_config(config), config)),
          tokens_(source.take(name + "embeddings.token_embedding.weight", {config.vocab_size, config.hidden_size})),
          positions_(source.take(name + "embeddings.position_embedding.weight",
                                 {config.max_position_embeddings, config.hidden_size})),
          final_layer_norm_(source, name + "final_layer_norm", config.hidden_size,
                            static_cast<Real>(config.layer_norm_eps)) {
        for (std::size_t i = 0; i < config.num_hidden_layers; ++i) {
            layers_.emplace_back(config, source, name + "encoder.layers." + std::to_string(i));
        }
        source.leave(name + "embeddings.position_ids");
        source.require_all_taken();
    }

    clip_text_config config_;
    std::vector<Real> tokens_;
    std::vector<Real> positions_;
    std::vector<clip_text_layer<Real>> layers_;
    layer_norm<Real> final_layer_norm_;
};

} // namespace genrender::reference

#include <genrender/core/end_header.inl>
