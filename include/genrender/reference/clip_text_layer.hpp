// SPDX-License-Identifier: MIT
// A transformer layer of CLIP's text encoder: each token attends to itself and to those before it, then an MLP.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/attention/scaled_dot_product.hpp>
#include <genrender/core/parallel.hpp>
#include <genrender/core/stack.hpp>
#include <genrender/core/strided_view.hpp>
#include <genrender/reference/activation.hpp>
#include <genrender/reference/clip_text_config.hpp>
#include <genrender/reference/layer_norm.hpp>
#include <genrender/reference/linear.hpp>
#include <genrender/reference/weights.hpp>

#include <array>
#include <cstddef>
#include <string>

namespace genrender::reference {

/// transformers' CLIPEncoderLayer: h += attention(layer_norm1(h)), h += fc2(act(fc1(layer_norm2(h)))).
template <class Real>
class clip_text_layer {
public:
    /// Takes `name.layer_norm1`, `.self_attn.{q,k,v,out}_proj`, `.layer_norm2`, `.mlp.fc1` and `.mlp.fc2`.
    clip_text_layer(clip_text_config const& config, weights<Real>& source, std::string const& name)
        : heads_(config.num_attention_heads), activation_(config.hidden_act),
          layer_norm1_(source, name + ".layer_norm1", config.hidden_size, static_cast<Real>(config.layer_norm_eps)),
          q_proj_(source, name + ".self_attn.q_proj", config.hidden_size, config.hidden_size),
          k_proj_(source, name + ".self_attn.k_proj", config.hidden_size, config.hidden_size),
          v_proj_(source, name + ".self_attn.v_proj", config.hidden_size, config.hidden_size),
          out_proj_(source, name + ".self_attn.out_proj", config.hidden_size, config.hidden_size),
          layer_norm2_(source, name + ".layer_norm2", config.hidden_size, static_cast<Real>(config.layer_norm_eps)),
          fc1_(source, name + ".mlp.fc1", config.hidden_size, config.intermediate_size),
          fc2_(source, name + ".mlp.fc2", config.intermediate_size, config.hidden_size) {}

    /// Runs in place of h [tokens, hidden_size], whose rows are contiguous. Channels and tokens are shared out over
    /// `loop`. Throws shape_error if h has other channels.
    void operator()(strided_view<Real, 2> h, any_loop const& loop = {}) const {
        auto const tokens = h.extent(0);
        require_shape("clip_text_layer", "h", h, {tokens, q_proj_.in_channels()});
        auto memory = stack<Real, 3>::uninitialized({4, tokens, h.extent(1)});
        auto const normed = memory.view()[0];
        auto const Q = memory.view()[1];
        auto const K = memory.view()[2];
        auto const V = memory.view()[3];
        layer_norm1_(normed, h);
        q_proj_(Q, normed, loop);
        k_proj_(K, normed, loop);
        v_proj_(V, normed, loop);
        // The mask is which keys a query is shown. Long rows first, so that threads end together.
        loop(tokens, [&](std::size_t i) {
            auto const token = tokens - 1 - i;
            std::array const before{key_value_view<Real>{K.slice(0, token + 1), V.slice(0, token + 1)}};
            scaled_dot_product(normed.slice(token, 1), Q.slice(token, 1), before, heads_);
        });
        out_proj_.add_to(h, normed, loop);

        layer_norm2_(normed, h);
        auto between = stack<Real, 2>::uninitialized({tokens, fc1_.out_channels()});
        fc1_(between.view(), normed, loop);
        loop(tokens, [&](std::size_t token) {
            auto const row = between.view()[token].row();
            activation_ == clip_activation::gelu ? gelu(row) : quick_gelu(row);
        });
        fc2_.add_to(h, between, loop);
    }

private:
    std::size_t heads_;
    clip_activation activation_;
    layer_norm<Real> layer_norm1_;
    linear<Real> q_proj_;
    linear<Real> k_proj_;
    linear<Real> v_proj_;
    linear<Real> out_proj_;
    layer_norm<Real> layer_norm2_;
    linear<Real> fc1_;
    linear<Real> fc2_;
};

} // namespace genrender::reference

#include <genrender/core/end_header.inl>
