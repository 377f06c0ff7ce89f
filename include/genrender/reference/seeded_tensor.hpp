// SPDX-License-Identifier: MIT
// Random parameters under which a network that nobody trained keeps its features in range and hears every input.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/random.hpp>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

namespace genrender::reference {

namespace internal {

/// FNV-1a, 64 bits: the address of a tensor is its name, so that no order of asking matters.
constexpr std::uint64_t hash_of(std::string_view text, std::uint64_t hash = 0xCBF29CE484222325U) {
    for (auto const letter : text) {
        hash = (hash ^ static_cast<unsigned char>(letter)) * 0x100000001B3U;
    }
    return hash;
}

} // namespace internal

/// The elements of a random tensor [out, in, ...], row-major, that depend on its name and `network` alone beside the
/// seed. Matrices and kernels are N(0, 1 / inputs of an output), so that they keep the variance of what they multiply,
/// those too that are zero before a training; embeddings of words N(0, 1), scales of norms 1, biases N(0, 0.01).
inline std::vector<float> seeded_tensor(std::uint64_t seed, std::string_view network, std::string_view name,
                                        std::vector<std::size_t> const& shape) {
    std::size_t count = 1;
    for (auto const extent : shape) {
        count *= extent;
    }
    auto const has_inputs = shape.size() > 1;
    if (!has_inputs && !name.ends_with("bias")) {
        return std::vector<float>(count, 1.0f);
    }
    auto const is_embedding = shape.size() == 2 && name.ends_with("_embedding.weight");
    auto const inputs = has_inputs && !is_embedding && count > 0 ? count / shape[0] : std::size_t{1};
    auto const scale = has_inputs ? 1 / std::sqrt(static_cast<float>(inputs)) : 0.1f;
    auto const hash = internal::hash_of(name, internal::hash_of(network));
    std::vector<float> values(count);
    for (std::size_t i = 0; i < count; ++i) {
        values[i] = scale * static_cast<float>(
                                normal_value(seed, random_stream::weights,
                                             {static_cast<std::uint32_t>(hash), static_cast<std::uint32_t>(hash >> 32),
                                              static_cast<std::uint32_t>(i)}));
    }
    return values;
}

} // namespace genrender::reference

#include <genrender/core/end_header.inl>
