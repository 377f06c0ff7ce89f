// SPDX-License-Identifier: MIT
// The gated feed-forward layer of a transformer block: GEGLU (Shazeer 2020).
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/parallel.hpp>
#include <genrender/core/stack.hpp>
#include <genrender/core/strided_view.hpp>
#include <genrender/reference/activation.hpp>
#include <genrender/reference/linear.hpp>

#include <algorithm>
#include <cstddef>
#include <string>

namespace genrender::reference {

/// W2 (a * gelu(b)) + b2, where [a, b] = W1 x + b1 has 8 times the channels of x (diffusers' FeedForward with `geglu`).
template <class Real>
class feed_forward {
public:
    /// Takes `name.net.0.proj` [8 channels, channels] and `name.net.2` [channels, 4 channels].
    feed_forward(weights<Real>& source, std::string const& name, std::size_t channels)
        : proj_(source, name + ".net.0.proj", channels, 8 * channels),
          out_(source, name + ".net.2", 4 * channels, channels) {}

    /// Adds the result for x [tokens, channels] to the residual `h` [tokens, channels]. Tokens are shared out over
    /// `loop`.
    void add_to(strided_view<Real, 2> h, in_view<Real, 2> x, any_loop const& loop = {}) const {
        auto const tokens = x.extent(0);
        auto const width = out_.in_channels();
        // What lies between both matrices is 8 times as wide as x: a few tokens at a time stay in the second cache.
        auto const block = std::clamp<std::size_t>((std::size_t{1} << 17) / (2 * width), 48, 512) / 12 * 12;
        loop((tokens + block - 1) / block, [&](std::size_t i) {
            auto const begin = i * block;
            auto const count = std::min(block, tokens - begin);
            auto memory = stack<Real, 2>::uninitialized({count, 2 * width});
            auto const both = memory.view();
            proj_(both, x.slice(begin, count));
            // Leave a * gelu(b) in the place of a.
            for (std::size_t token = 0; token < count; ++token) {
                auto const row = both[token].row();
                gate_by_gelu(row.first(width), row.last(width));
            }
            out_.add_to(h.slice(begin, count),
                        strided_view<Real const, 2>(memory.data(), {count, width}, both.strides()));
        });
    }

private:
    linear<Real> proj_;
    linear<Real> out_;
};

} // namespace genrender::reference

#include <genrender/core/end_header.inl>
