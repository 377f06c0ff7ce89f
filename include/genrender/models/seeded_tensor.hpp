// SPDX-License-Identifier: MIT
// Random parameters under which an untrained network paints: smooth kernels, damped details, every input felt.
#pragma once

#include <genrender/core/random.hpp>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>
#include <vector>

// Why not He's initialisation and be done: the reference network is a function that nobody trained, and its output is shown.
// White random kernels show white noise. Kernels that lean to the low frequencies give what an untrained convolutional network
// gives anyway (Ulyanov et al. 2018, 'Deep Image Prior'), only sooner. The ControlNet's zero convolutions get values too: they are
// zero before training alone, and zeros would hide the depth map.

namespace genrender {

namespace detail {

/// FNV-1a, 64 bits: the address of a tensor is its name, so that no order of asking matters.
constexpr std::uint64_t hash_of(std::string_view text, std::uint64_t hash = 0xCBF29CE484222325U) {
    for (auto const letter : text) {
        hash = (hash ^ static_cast<unsigned char>(letter)) * 0x100000001B3U;
    }
    return hash;
}

/// How much a layer speaks, relative to unit variance: chosen by looking at the pictures.
struct gain_rule {
    std::string_view name;
    float gain;
};

inline constexpr gain_rule seeded_gains[] = {
    {"attn1.to_q.weight", 2.0f},      {"attn1.to_k.weight", 2.0f}, {"attn1.to_out.0.weight", 1.0f},
    {"attn2.to_out.0.weight", 1.5f},  {"attn2.to_q.weight", 1.0f}, {"attn2.to_k.weight", 1.0f},
    {"controlnet_down_blocks", 0.6f}, {"controlnet_mid_block", 0.6f},
    {"controlnet_cond_embedding", 1.5f}, {"time_emb_proj.weight", 0.3f},
};

inline float seeded_gain(std::string_view name) {
    for (auto const& rule : seeded_gains) {
        if (name.find(rule.name) != std::string_view::npos) {
            return rule.gain;
        }
    }
    return 1;
}

} // namespace detail

/// The elements of a random tensor [out, in, ...], row-major: N(0, gain / in) for matrices and 1x1 kernels; for 3x3 kernels nine
/// parts of a binomial blur with a random sign and strength, and one part of white noise; 1 for the scales of norms, small
/// numbers for biases; unit variance for embeddings of words.
inline std::vector<float> seeded_tensor(std::uint64_t seed, std::string_view network, std::string_view name,
                                        std::vector<std::size_t> const& shape) {
    std::size_t count = 1;
    for (auto const extent : shape) {
        count *= extent;
    }
    std::vector<float> values(count);
    auto const hash = detail::hash_of(name, detail::hash_of(network));
    auto const normal = [&](std::size_t i) {
        return static_cast<float>(normal_value(seed, random_stream::weights,
                                               {static_cast<std::uint32_t>(hash), static_cast<std::uint32_t>(hash >> 32),
                                                static_cast<std::uint32_t>(i)}));
    };
    static auto const P = [](int k, float d) { char n[3] = {'P', char('0' + k), 0}; auto const* v = std::getenv(n); return v ? std::strtof(v, nullptr) : d; };
    // The first and the last convolution share these random directions, latent channel by feature channel.
    auto const code = [&](std::size_t latent, std::size_t feature) {
        return static_cast<float>(normal_value(seed, random_stream::weights, {static_cast<std::uint32_t>(latent), static_cast<std::uint32_t>(feature), 0xC0DEU}));
    };
    auto const is_last = name.starts_with("conv_out.");
    auto const is_first = name == "conv_in.weight";
    auto const means = shape[0] / 4;
    if (shape.size() == 1) {
        for (std::size_t i = 0; i < count; ++i) {
            values[i] = !name.ends_with("bias") ? 1.0f : is_last && i >= means ? 0.0f : 0.1f * normal(i);
        }
        return values;
    }
    auto const fan_in = name.find("embedding.weight") != std::string_view::npos ? 1 : shape[1];
    auto const scale = detail::seeded_gain(name) / std::sqrt(static_cast<float>(fan_in));
    for (std::size_t i = 0; i < count; ++i) {
        values[i] = scale * normal(i);
    }
    if (name.ends_with("conv_shortcut.weight") && shape[1] > shape[0]) {
        auto const skip = shape[1] - shape[0];
        for (std::size_t i = 0; i < count; ++i) values[i] *= P(0, 0.7f);
        for (std::size_t o = 0; o < shape[0]; ++o) {
            values[o * shape[1] + skip + o] += P(1, 1.0f);
        }
    }
    if (shape.size() == 4 && shape[2] == 3) {
        for (std::size_t pair = 0; pair < count / 9; ++pair) {
            auto const out = pair / shape[1];
            auto const in = pair % shape[1];
            auto const detail_row = is_last && out >= means;
            auto strength = scale * (is_first ? code(in, out) : is_last && !detail_row ? code(out, in) : normal(count + pair));
            float gain = is_first ? (in < shape[1] / 4 ? P(2, 2.0f) : P(3, 0.3f)) : is_last ? detail_row ? P(4, 0.3f) : P(5, 1.5f) : 1.3f;
            float blur = is_first || is_last ? P(6, 0.7f) : P(7, 1.0f);
            for (std::size_t row = 0; row < 3; ++row) {
                for (std::size_t column = 0; column < 3; ++column) {
                    auto const binomial = (row == 1 ? 0.5f : 0.25f) * (column == 1 ? 0.5f : 0.25f);
                    auto const centre = row == 1 && column == 1 ? 1.0f : 0.0f;
                    auto& value = values[pair * 9 + row * 3 + column];
                    value = gain * (strength * (blur * binomial + (1 - blur) * centre) + P(8, 0.08f) * value);
                }
            }
        }
    }
    return values;
}

} // namespace genrender
