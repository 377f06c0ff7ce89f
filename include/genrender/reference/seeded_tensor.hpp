// SPDX-License-Identifier: MIT
// Random parameters under which the untrained reference network paints: smooth kernels, a palette, every input felt.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/random.hpp>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

// Nobody trained the reference network, and yet its output is shown. White random kernels show white noise, so kernels
// lean to the low frequencies, as an untrained convolutional network does anyway (Ulyanov et al. 2018, 'Deep Image
// Prior'). The rest is there so that pictures answer to what they should:
// - to the noise: the last convolution is the first one turned round with its sign changed, and the skip between them
//   is passed on, so the clean estimate of a velocity (sampling/preconditioning.hpp) resembles what it is given.
//   Sampling turns that into feedback: chance decides, smoothing spreads and the norms bound it.
// - to the depth: the ControlNet's zero convolutions are not zero, as they are before training.
// - to the prompt: cross-attention speaks louder than the rest.
// The three detail bands of the output (haar.hpp) are slopes of the mean band, so that pictures have no blocks of 2 x 2
// pixels.

namespace genrender::reference {

namespace internal {

/// FNV-1a, 64 bits: the address of a tensor is its name, so that no order of asking matters.
constexpr std::uint64_t hash_of(std::string_view text, std::uint64_t hash = 0xCBF29CE484222325U) {
    for (auto const letter : text) {
        hash = (hash ^ static_cast<unsigned char>(letter)) * 0x100000001B3U;
    }
    return hash;
}

/// How loud a layer is, relative to outputs of unit variance for inputs of unit variance. Chosen by looking at
/// pictures.
inline float seeded_gain(std::string_view name) {
    struct rule {
        std::string_view part;
        float gain;
    };
    constexpr std::array rules{
        rule{"attn1.to_q", 2.0f},
        rule{"attn1.to_k", 2.0f}, // attention that picks some tokens, not the mean of all
        rule{"attn2.to_out", 3.0f},
        rule{"controlnet_cond_embedding", 1.5f},
        rule{"time_emb_proj", 0.3f},
        rule{"conv_shortcut", 0.7f},
        rule{"conv_out.weight", 0.95f},
        rule{"controlnet_down_blocks", 1.7f},
    };
    for (auto const& [part, gain] : rules) {
        if (name.find(part) != std::string_view::npos) {
            return gain;
        }
    }
    return 1;
}

/// The direction among the features that stands for a latent channel: a part that all share, so that colours are not
/// all shrill, and one of its own. Features come in opposite pairs, whose rectified sum has no mean, so that no picture
/// is bleached.
inline float seeded_palette(std::uint64_t seed, std::size_t latent, std::size_t feature) {
    auto const direction = [&](std::uint32_t row) {
        return static_cast<float>(
            normal_value(seed, random_stream::weights, {row, static_cast<std::uint32_t>(feature / 2), 0x0050414CU}));
    };
    return (feature % 2 == 0 ? 1.0f : -1.0f) *
           (0.6f * direction(0) + 0.8f * direction(static_cast<std::uint32_t>(latent) + 1));
}

/// One tap of a smooth 3x3 kernel: a binomial blur mixed with the identity.
constexpr float smooth_tap(std::size_t row, std::size_t column, float blur) {
    auto const binomial = (row == 1 ? 0.5f : 0.25f) * (column == 1 ? 0.5f : 0.25f);
    return blur * binomial + (row == 1 && column == 1 ? 1 - blur : 0.0f);
}

/// One tap of what makes detail band 1, 2 or 3 of haar.hpp out of its mean band, if the picture is smooth.
constexpr float slope_tap(std::size_t row, std::size_t column, std::size_t band) {
    auto const across = 1 - static_cast<float>(column);
    auto const down = 1 - static_cast<float>(row);
    return band == 1   ? 0.5f * across * (row == 1 ? 0.5f : 0.25f)
           : band == 2 ? 0.5f * down * (column == 1 ? 0.5f : 0.25f)
                       : 0.05f * across * down;
}

} // namespace internal

/// The elements of a random tensor [out, in, ...], row-major, that depend on its name and `network` alone beside the
/// seed. Matrices and 1x1 kernels are N(0, gain^2 / in); 3x3 kernels are blurs of random sign and strength with a
/// little white noise; scales of norms are 1, biases N(0, 0.01), embeddings of words N(0, 1).
inline std::vector<float> seeded_tensor(std::uint64_t seed, std::string_view network, std::string_view name,
                                        std::vector<std::size_t> const& shape) {
    std::size_t count = 1;
    for (auto const extent : shape) {
        count *= extent;
    }
    auto const hash = internal::hash_of(name, internal::hash_of(network));
    auto const normal = [&](std::size_t i) {
        return static_cast<float>(normal_value(
            seed, random_stream::weights,
            {static_cast<std::uint32_t>(hash), static_cast<std::uint32_t>(hash >> 32), static_cast<std::uint32_t>(i)}));
    };
    // Of an output with the four bands of haar.hpp, the first quarter are means; elsewhere nothing asks.
    auto const is_first = name == "conv_in.weight";
    auto const is_last = name.starts_with("conv_out.");
    auto const means = shape.empty() || shape[0] < 4 ? std::size_t{1} : shape[0] / 4;

    std::vector<float> values(count);
    if (shape.size() <= 1) {
        for (std::size_t i = 0; i < count; ++i) {
            values[i] = !name.ends_with("bias") ? 1.0f : is_last && i >= means ? 0.0f : 0.1f * normal(i);
        }
        return values;
    }
    auto const inputs = shape[1];
    auto const fan_in = name.ends_with("_embedding.weight") ? 1.0f : static_cast<float>(inputs);
    auto const scale = internal::seeded_gain(name) / std::sqrt(fan_in);
    for (std::size_t i = 0; i < count; ++i) {
        values[i] = scale * normal(i);
    }
    if (name.ends_with("conv_shortcut.weight") && inputs > shape[0]) {
        // Where a skip is joined, pass the skip on: its channels come last.
        for (std::size_t out = 0; out < shape[0]; ++out) {
            values[out * inputs + inputs - shape[0] + out] += 1;
        }
    }
    if (shape.size() == 4 && shape[2] == 3 && shape[3] == 3) {
        for (std::size_t pair = 0; pair < count / 9; ++pair) {
            auto const out = pair / inputs;
            auto const in = pair % inputs;
            auto const band = is_last ? out / means : 0;
            auto const strength =
                scale * (is_first  ? (in < inputs / 4 ? 3.5f : 0.35f) * internal::seeded_palette(seed, in, out)
                         : is_last ? -internal::seeded_palette(seed, out % means, in)
                                   : 1.3f * normal(count + pair));
            auto const blur = is_first || is_last ? 0.5f : 1.0f;
            for (std::size_t tap = 0; tap < 9; ++tap) {
                auto& value = values[pair * 9 + tap];
                value = band == 0 ? strength * internal::smooth_tap(tap / 3, tap % 3, blur) + 0.1f * value
                                  : strength * internal::slope_tap(tap / 3, tap % 3, band);
            }
        }
    }
    return values;
}

} // namespace genrender::reference

#include <genrender/core/end_header.inl>
