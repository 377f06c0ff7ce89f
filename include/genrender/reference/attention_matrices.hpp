// SPDX-License-Identifier: MIT
// The matrices of an attention module: queries of the features, keys and values of what they attend to, the way out.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/parallel.hpp>
#include <genrender/core/strided_view.hpp>
#include <genrender/reference/linear.hpp>

#include <cstddef>
#include <string>

namespace genrender::reference {

/// diffusers' Attention: W^Q, W^K and W^V without biases, W^O with one. A model of the concept attention_projections
/// where features attend to features.
template <class Real>
class attention_matrices {
public:
    /// Takes `name.to_q`, `.to_k`, `.to_v` and `.to_out.0`. `source_channels` are those of what is attended to.
    attention_matrices(weights<Real>& source, std::string const& name, std::size_t channels,
                       std::size_t source_channels, std::size_t heads)
        : heads_(heads), to_q_(source, name + ".to_q", channels, channels, false),
          to_k_(source, name + ".to_k", source_channels, channels, false),
          to_v_(source, name + ".to_v", source_channels, channels, false),
          to_out_(source, name + ".to_out.0", channels, channels) {}

    /// Number of attention heads.
    std::size_t heads() const { return heads_; }
    /// Channels of the queries, all heads together.
    std::size_t channels() const { return to_q_.out_channels(); }

    /// Q = W^Q f [tokens, channels] for f [tokens, channels].
    void query(strided_view<Real, 2> Q, in_view<Real, 2> f) const { to_q_(Q, f); }
    /// K = W^K f [tokens, channels] for f [tokens, source_channels].
    void key(strided_view<Real, 2> K, in_view<Real, 2> f) const { to_k_(K, f); }
    /// V = W^V f [tokens, channels] for f [tokens, source_channels].
    void value(strided_view<Real, 2> V, in_view<Real, 2> f) const { to_v_(V, f); }
    /// Adds W^O F + b to the residual `h` [tokens, channels]. Tokens are shared out over `loop`.
    void add_output(strided_view<Real, 2> h, in_view<Real, 2> F, any_loop const& loop = {}) const {
        to_out_.add_to(h, F, loop);
    }

private:
    std::size_t heads_;
    linear<Real> to_q_;
    linear<Real> to_k_;
    linear<Real> to_v_;
    linear<Real> to_out_;
};

} // namespace genrender::reference

#include <genrender/core/end_header.inl>
