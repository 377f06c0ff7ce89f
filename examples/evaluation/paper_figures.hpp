// SPDX-License-Identifier: MIT
// [GR tables 1 and 2] The paper's own figures, quoted, to stand beside those measured here.
#pragma once

#include <array>
#include <optional>
#include <string_view>

namespace genrender::examples {

/// A row of the paper's tables: CLIP embeddings, Stable Diffusion 1.5, scenes and prompts of its own.
struct paper_row {
    std::string_view method;             ///< a row of compared_rows; Gen1 is proprietary and quoted alone
    std::string_view name;               ///< as tables have it
    std::array<double, 5> consistency{}; ///< frame consistency at `intervals` (table 2; the first is table 1's)
    std::optional<double> fidelity{};    ///< prompt fidelity (table 1); none for what the paper does not have
};

/// Tables 1 and 2, and vivid beside them.
inline constexpr std::array<paper_row, 6> paper_rows{{
    {"Per-Frame, independent noise", "Per-Frame", {0.9547, 0.9173, 0.9109, 0.9145, 0.9062}, 0.3233},
    {"Pix2Video*, fixed noise", "Pix2Video*", {0.9630, 0.9503, 0.9494, 0.9415, 0.9471}, 0.2983},
    {"TokenFlow*, fixed noise", "TokenFlow*", {0.9822, 0.9754, 0.9728, 0.9706, 0.9712}, 0.2737},
    {"", "Gen1", {0.9907, 0.9715, 0.9582, 0.9624, 0.9601}, 0.3029},
    {"paper", "paper", {0.9845, 0.9815, 0.9738, 0.9749, 0.9727}, 0.3227},
    {"vivid", "vivid"},
}};

} // namespace genrender::examples
