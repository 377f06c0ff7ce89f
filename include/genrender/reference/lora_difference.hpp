// SPDX-License-Identifier: MIT
// What a LoRA (Hu et al. 2021) adds to a weight: a product of two narrow matrices.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/reference/tensor_place.hpp>

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <map>
#include <span>
#include <string>
#include <vector>

namespace genrender::reference {

/// What a LoRA adds to one weight W [out, in, ...]: factor * up down, of rank r.
struct lora_difference {
    tensor_place down; ///< [r, in, ...], the kernel's axes if W has them
    tensor_place up;   ///< [out, r], maybe with axes of 1 behind
    double factor = 1; ///< alpha / r
};

/// Differences by the weight that they are added to.
using lora_differences = std::multimap<std::string, lora_difference>;

/// Adds factor * up down to a weight [out, in, ...], row-major. Throws file_error if the factors cannot be read.
template <std::floating_point Real>
void add_difference(std::span<Real> weight, lora_difference const& difference) {
    auto const down = difference.down.template read<Real>();
    auto const up = difference.up.template read<Real>();
    auto const rank = difference.down.shape[0];
    auto const rows = difference.up.shape[0];
    auto const columns = down.size() / rank;
    auto const factor = static_cast<Real>(difference.factor);
    std::vector<Real> row(columns);
    for (std::size_t o = 0; o < rows; ++o) {
        std::fill(row.begin(), row.end(), Real(0));
        for (std::size_t r = 0; r < rank; ++r) {
            auto const weight_of_row = up[o * rank + r];
            for (std::size_t i = 0; i < columns; ++i) {
                row[i] += weight_of_row * down[r * columns + i];
            }
        }
        for (std::size_t i = 0; i < columns; ++i) {
            weight[o * columns + i] += factor * row[i];
        }
    }
}
} // namespace genrender::reference

#include <genrender/core/end_header.inl>
