// SPDX-License-Identifier: MIT
// The gated feed-forward layer of a transformer block: GEGLU (Shazeer 2020).
#pragma once

#include <genrender/core/stack.hpp>
#include <genrender/models/activation.hpp>
#include <genrender/models/linear.hpp>

#include <cstddef>
#include <string>

namespace genrender {

/// W2 (a * gelu(b)) + b2, where [a, b] = W1 x + b1 has 8 times the channels of x (diffusers' FeedForward with `geglu`).
template <class Real>
class feed_forward {
public:
    /// Takes `name.net.0.proj` [8 channels, channels] and `name.net.2` [channels, 4 channels].
    feed_forward(weights<Real>& source, std::string const& name, std::size_t channels)
        : proj_(source, name + ".net.0.proj", channels, 8 * channels),
          out_(source, name + ".net.2", 4 * channels, channels) {}

    /// Adds the result for x [tokens, channels] to the residual `h` [tokens, channels].
    void add_to(strided_view<Real, 2> h, in_view<Real, 2> x) const {
        auto const width = out_.in_channels();
        stack<Real, 2> both({x.extent(0), 2 * width});
        proj_(both.view(), x);
        // Leave a * gelu(b) in the place of a.
        for (std::size_t token = 0; token < both.extent(0); ++token) {
            auto const row = both.view()[token].row();
            for (std::size_t c = 0; c < width; ++c) {
                row[c] *= gelu(row[width + c]);
            }
        }
        out_.add_to(h, strided_view<Real const, 2>(both.data(), {x.extent(0), width},
                                                   {static_cast<std::ptrdiff_t>(2 * width), 1}));
    }

private:
    linear<Real> proj_;
    linear<Real> out_;
};

} // namespace genrender
