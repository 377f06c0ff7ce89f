// SPDX-License-Identifier: MIT
// The self-attention of the autoencoder's mid block: one head over the tokens of the latents.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/attention/scaled_dot_product.hpp>
#include <genrender/core/stack.hpp>
#include <genrender/reference/autoencoder_config.hpp>
#include <genrender/reference/group_norm.hpp>
#include <genrender/reference/linear.hpp>
#include <genrender/reference/map_stripes.hpp>
#include <genrender/reference/spare_map.hpp>
#include <genrender/reference/weights.hpp>

#include <array>
#include <cstddef>
#include <string>

namespace genrender::reference {

/// x + to_out(attention(group_norm(x))), in one head of all channels (diffusers' Attention with a residual).
template <class Real>
class vae_attention {
public:
    /// Takes `name.group_norm`, `.to_q`, `.to_k`, `.to_v` and `.to_out.0`, or what files of old diffusers call the
    /// matrices: `.query`, `.key`, `.value` and `.proj_attn`.
    vae_attention(autoencoder_config const& config, weights<Real>& source, std::string const& name,
                  std::size_t channels)
        : group_norm_(source, name + ".group_norm", channels, config.norm_num_groups, Real(1e-6)),
          to_q_(matrix(source, name, ".to_q", ".query", channels)),
          to_k_(matrix(source, name, ".to_k", ".key", channels)),
          to_v_(matrix(source, name, ".to_v", ".value", channels)),
          to_out_(matrix(source, name, ".to_out.0", ".proj_attn", channels)) {}

    /// Runs in place of x. Throws shape_error if it has other channels.
    void operator()(spare_map<Real>& x, stripe_pass const& pass) const {
        auto memory = stack<Real, 3>::uninitialized({4, x.grid().size(), x.channels()});
        auto const normed = memory.view()[0];
        auto const Q = memory.view()[1];
        auto const K = memory.view()[2];
        auto const V = memory.view()[3];
        group_norm_(normed, x.view(), pass.loop);
        to_q_(Q, normed, pass.loop);
        to_k_(K, normed, pass.loop);
        to_v_(V, normed, pass.loop);
        scaled_dot_product(normed, Q, std::array{key_value_view<Real>{K, V}}, 1, pass.loop);
        to_out_.add_to(x.view(), normed, pass.loop);
    }

private:
    static linear<Real> matrix(weights<Real>& source, std::string const& name, char const* now, char const* before,
                               std::size_t channels) {
        auto const is_old = source.holds(name + before + ".weight");
        return {source, name + (is_old ? before : now), channels, channels};
    }

    group_norm<Real> group_norm_;
    linear<Real> to_q_;
    linear<Real> to_k_;
    linear<Real> to_v_;
    linear<Real> to_out_;
};

} // namespace genrender::reference

#include <genrender/core/end_header.inl>
