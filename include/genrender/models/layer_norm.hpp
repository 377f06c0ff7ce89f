// SPDX-License-Identifier: MIT
// LayerNorm (Ba et al. 2016) of feature maps whose channels lie side by side.
#pragma once

#include <genrender/core/strided_view.hpp>
#include <genrender/models/weights.hpp>

#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

namespace genrender {

/// The channels of each token to mean 0 and variance 1; then scale and shift a channel.
template <class Real>
class layer_norm {
public:
    /// Takes `name.weight` and `name.bias` [channels].
    layer_norm(weights<Real>& source, std::string const& name, std::size_t channels, Real epsilon = Real(1e-5))
        : epsilon_(epsilon), weight_(source.take(name + ".weight", {channels})),
          bias_(source.take(name + ".bias", {channels})) {}

    /// Writes the result [tokens, channels]; `out` may be `in`. Throws shape_error if they do not fit.
    void operator()(strided_view<Real, 2> out, in_view<Real, 2> in) const {
        auto const channels = weight_.size();
        require_shape("layer_norm", "in", in, {in.extent(0), channels});
        require_shape("layer_norm", "out", out, in.extents());
        for (std::size_t token = 0; token < in.extent(0); ++token) {
            auto const x = in[token].row();
            auto const y = out[token].row();
            Real mean = 0;
            for (auto const value : x) {
                mean += value;
            }
            mean /= static_cast<Real>(channels);
            Real variance = 0;
            for (auto const value : x) {
                variance += (value - mean) * (value - mean);
            }
            auto const factor = 1 / std::sqrt(variance / static_cast<Real>(channels) + epsilon_);
            for (std::size_t c = 0; c < channels; ++c) {
                y[c] = (x[c] - mean) * factor * weight_[c] + bias_[c];
            }
        }
    }

private:
    Real epsilon_;
    std::vector<Real> weight_;
    std::vector<Real> bias_;
};

} // namespace genrender
