// SPDX-License-Identifier: MIT
// A toy diffusion engine as a stranger would have it: tensors, operations and a network, and not a word of genrender.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace my_engine {

/// A handle of numbers [frames, tokens, channels]; copies share the memory. Rows begin at multiples of 16 numbers, as
/// the engine's vector unit likes them, so a tensor is not contiguous.
struct tensor {
    std::array<std::size_t, 3> sizes{};
    std::array<std::ptrdiff_t, 3> strides{};
    std::shared_ptr<float[]> memory;

    tensor() = default;
    tensor(std::size_t frames, std::size_t tokens, std::size_t channels) : sizes{frames, tokens, channels} {
        auto const pitch = (channels + 15) / 16 * 16;
        strides = {static_cast<std::ptrdiff_t>(tokens * pitch), static_cast<std::ptrdiff_t>(pitch), 1};
        memory = std::shared_ptr<float[]>(new float[frames * tokens * pitch]());
    }
    /// The channels of one token of one frame.
    std::span<float> row(std::size_t frame, std::size_t token) const {
        auto const pitch = static_cast<std::size_t>(strides[1]);
        return {memory.get() + (frame * sizes[1] + token) * pitch, sizes[2]};
    }
};

/// A weight matrix [outputs, inputs], filled with waves in place of training.
struct linear {
    std::size_t outputs;
    std::size_t inputs;
    double phase;
    float weight(std::size_t output, std::size_t input) const {
        auto const wave = std::sin(phase + 1.7 * static_cast<double>(output + 1) * static_cast<double>(input + 2));
        return static_cast<float>(wave * std::sqrt(1.0 / static_cast<double>(inputs)));
    }
    /// W x for every token.
    tensor operator()(tensor const& x) const {
        tensor y(x.sizes[0], x.sizes[1], outputs);
        for (std::size_t output = 0; output < outputs; ++output) {
            for (std::size_t input = 0; input < inputs; ++input) {
                auto const w = weight(output, input);
                for (std::size_t row = 0; row < x.sizes[0] * x.sizes[1]; ++row) {
                    auto const frame = row / x.sizes[1];
                    auto const token = row % x.sizes[1];
                    y.row(frame, token)[output] += w * x.row(frame, token)[input];
                }
            }
        }
        return y;
    }
};

/// x with mean 0 and variance 1 over the channels of every token.
inline tensor layer_norm(tensor const& x) {
    tensor y(x.sizes[0], x.sizes[1], x.sizes[2]);
    auto const channels = static_cast<float>(x.sizes[2]);
    for (std::size_t frame = 0; frame < x.sizes[0]; ++frame) {
        for (std::size_t token = 0; token < x.sizes[1]; ++token) {
            auto const in = x.row(frame, token);
            float mean = 0;
            float square = 0;
            for (auto const value : in) {
                mean += value / channels;
                square += value * value / channels;
            }
            auto const scale = 1 / std::sqrt(square - mean * mean + 1e-5f);
            auto const out = y.row(frame, token);
            std::transform(in.begin(), in.end(), out.begin(), [&](float v) { return scale * (v - mean); });
        }
    }
    return y;
}

/// x += factor * y.
inline void add_scaled(tensor& x, tensor const& y, float factor) {
    for (std::size_t frame = 0; frame < x.sizes[0]; ++frame) {
        for (std::size_t token = 0; token < x.sizes[1]; ++token) {
            for (std::size_t channel = 0; channel < x.sizes[2]; ++channel) {
                x.row(frame, token)[channel] += factor * y.row(frame, token)[channel];
            }
        }
    }
}

/// Keys and values of the frames of a stack.
struct key_values {
    tensor K;
    tensor V;
};

/// For each frame of queries, the frames that it attends to.
struct attended_frame {
    key_values stack;
    std::size_t frame;
};
using attention_lists = std::vector<std::vector<attended_frame>>;

/// The engine's attention operation: softmax(Q K^T / sqrt(channels)) V, frame i of Q over the tokens of all `lists[i]`.
inline tensor attend(tensor const& Q, attention_lists const& lists) {
    tensor F(Q.sizes[0], Q.sizes[1], Q.sizes[2]);
    std::vector<float> logits;
    for (std::size_t i = 0; i < Q.sizes[0]; ++i) {
        for (std::size_t t = 0; t < Q.sizes[1]; ++t) {
            auto const q = Q.row(i, t);
            logits.clear();
            for (auto const& part : lists[i]) {
                for (std::size_t s = 0; s < part.stack.K.sizes[1]; ++s) {
                    auto const k = part.stack.K.row(part.frame, s);
                    float dot = 0;
                    for (std::size_t c = 0; c < q.size(); ++c) {
                        dot += q[c] * k[c];
                    }
                    logits.push_back(dot / std::sqrt(static_cast<float>(q.size())));
                }
            }
            auto const greatest = *std::max_element(logits.begin(), logits.end());
            float sum = 0;
            for (auto& logit : logits) {
                logit = std::exp(logit - greatest);
                sum += logit;
            }
            auto logit = logits.begin();
            for (auto const& part : lists[i]) {
                for (std::size_t s = 0; s < part.stack.V.sizes[1]; ++s, ++logit) {
                    for (std::size_t c = 0; c < q.size(); ++c) {
                        F.row(i, t)[c] += *logit / sum * part.stack.V.row(part.frame, s)[c];
                    }
                }
            }
        }
    }
    return F;
}

/// The engine's gather operation: row t of frame i of `x` becomes (1 - share) x + share * sum of weights[e]
/// source[rows[e]], e from offsets[t] to offsets[t + 1], where there is such an e; the rows of `source` are counted
/// through all of its frames.
inline void mix_gathered(tensor& x, std::size_t i, tensor const& source, std::span<std::uint32_t const> offsets,
                         std::span<std::uint32_t const> rows, std::span<float const> weights, float share) {
    for (std::size_t t = 0; t < x.sizes[1]; ++t) {
        for (std::size_t c = 0; c < x.sizes[2] && offsets[t] < offsets[t + 1]; ++c) {
            float gathered = 0;
            for (auto e = offsets[t]; e < offsets[t + 1]; ++e) {
                gathered += weights[e] * source.row(rows[e] / source.sizes[1], rows[e] % source.sizes[1])[c];
            }
            x.row(i, t)[c] += share * (gathered - x.row(i, t)[c]);
        }
    }
}

/// The weights of one self-attention module.
struct self_attention {
    static constexpr std::size_t channels = 24;
    linear query;
    linear key;
    linear value;
    linear out;

    static self_attention with_phase(double phase) {
        return {{channels, channels, phase},
                {channels, channels, phase + 0.1},
                {channels, channels, phase + 0.2},
                {channels, channels, phase + 0.3}};
    }
};

/// A self-attention module as it is built into a static graph, of the engine's operations alone. `in` are the graph's
/// extra inputs at the module, named as genrender::feature_inputs names them.
// docs:begin self_attention_of_graph
template <class Inputs>
tensor self_attention_of_graph(self_attention const& module, tensor const& f, Inputs const& in) {
    key_values const own{module.key(f), module.value(f)};
    key_values joined;
    if (in.f_KF != nullptr) {
        joined = {module.key(*in.f_KF), module.value(*in.f_KF)};
    }
    attention_lists lists(f.sizes[0]);
    for (std::size_t i = 0; i < lists.size(); ++i) {
        for (std::size_t j = 0; j < lists.size(); ++j) { // eq. 1, or eq. 3 over the whole stack
            if (j == i || in.attends_to_stack) {
                lists[i].push_back({own, j});
            }
        }
        for (std::size_t k = 0; k < joined.K.sizes[0]; ++k) { // eq. 5
            if (k != in.left_out[i]) {
                lists[i].push_back({joined, k});
            }
        }
    }
    auto F = attend(module.query(f), lists);
    for (std::size_t i = 0; i < in.rows.size(); ++i) { // eq. 6
        mix_gathered(F, i, *in.F_KF, in.rows[i].offsets, in.rows[i].sources, in.rows[i].weights, in.alpha);
    }
    return F;
}
// docs:end

/// A network with two self-attention modules that predicts v, guided by two prompts: 0 the empty one, 1 the user's.
struct network {
    static constexpr std::size_t latent_channels = 4;
    static constexpr std::size_t channels = self_attention::channels;
    static constexpr std::uint32_t prompts = 2;
    linear in{channels, latent_channels, 0.1};
    std::array<self_attention, 2> modules{self_attention::with_phase(0.2), self_attention::with_phase(0.6)};
    linear end{latent_channels, channels, 1.0};

    /// v for `latents` [frames, tokens, latent_channels] of noise level sigma. A module is run by `run(prompt, m, f)`,
    /// which gives the output of module m, before its matrix `out`, for the input f.
    template <class Run>
    tensor operator()(tensor const& latents, float sigma, Run&& run) const {
        tensor guided(latents.sizes[0], latents.sizes[1], latent_channels);
        for (std::uint32_t prompt = 0; prompt < prompts; ++prompt) {
            auto h = in(latents);
            add_scaled(h, h, 1 / std::hypot(1.0f, sigma) - 1);
            for (std::size_t row = 0; row < h.sizes[0] * h.sizes[1]; ++row) {
                h.row(row / h.sizes[1], row % h.sizes[1])[prompt] += 1;
            }
            for (std::uint32_t m = 0; m < modules.size(); ++m) {
                add_scaled(h, modules[m].out(run(prompt, m, layer_norm(h))), 1);
            }
            add_scaled(guided, end(layer_norm(h)), prompt == 0 ? -0.5f : 1.5f);
        }
        return guided;
    }
};

} // namespace my_engine
