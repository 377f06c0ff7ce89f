// SPDX-License-Identifier: MIT
// How a network learns of the noise level: sines and cosines of the time, and a small perceptron behind them.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/reference/activation.hpp>
#include <genrender/reference/linear.hpp>
#include <genrender/reference/unet_config.hpp>

#include <cmath>
#include <cstddef>
#include <vector>

namespace genrender::reference {

/// The features of a time t (Vaswani et al. 2017, sec. 3.5) [channels]: cos(t w_i) for i < channels / 2, then sin(t
/// w_i), with w_i = 10000^(-2 i / channels); diffusers' Timesteps with flip_sin_to_cos and downscale_freq_shift = 0.
/// Expects an even number of channels.
template <class Real>
std::vector<Real> sinusoids(Real t, std::size_t channels) {
    auto const half = channels / 2;
    std::vector<Real> features(channels);
    for (std::size_t i = 0; i < half; ++i) {
        auto const frequency = std::exp(-std::log(10000.0) * static_cast<double>(i) / static_cast<double>(half));
        features[i] = static_cast<Real>(std::cos(static_cast<double>(t) * frequency));
        features[half + i] = static_cast<Real>(std::sin(static_cast<double>(t) * frequency));
    }
    return features;
}

/// diffusers' `time_proj` and `time_embedding`.
template <class Real>
class time_embedding {
public:
    /// Takes `time_embedding.linear_1` and `time_embedding.linear_2`.
    time_embedding(unet_config const& config, weights<Real>& source)
        : linear_1_(source, "time_embedding.linear_1", config.block_out_channels.front(), config.time_channels()),
          linear_2_(source, "time_embedding.linear_2", config.time_channels(), config.time_channels()) {}

    /// SiLU of the embedding of t [time_channels]: what every resnet block projects, each would otherwise compute it.
    std::vector<Real> operator()(Real t) const {
        auto const features = sinusoids(t, linear_1_.in_channels());
        std::vector<Real> hidden(linear_1_.out_channels());
        std::vector<Real> embedding(linear_2_.out_channels());
        strided_view<Real, 2> const hidden_row(hidden.data(), {1, hidden.size()});
        linear_1_(hidden_row, strided_view<Real const, 2>(features.data(), {1, features.size()}));
        silu<Real>(hidden);
        linear_2_(strided_view<Real, 2>(embedding.data(), {1, embedding.size()}), hidden_row);
        silu<Real>(embedding);
        return embedding;
    }

private:
    linear<Real> linear_1_;
    linear<Real> linear_2_;
};

} // namespace genrender::reference

#include <genrender/core/end_header.inl>
