// SPDX-License-Identifier: MIT
// How far a frame's kept pixels lie from a surface point, in canonical space and on the screen, a register at a time.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/vectors.hpp>
#include <genrender/correspondence/sample_bins.hpp>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>

namespace genrender::detail {

/// Pixels that a block may have to be measured.
inline constexpr std::size_t most_measured = 1024;

} // namespace genrender::detail

#define GENRENDER_KERNELS <genrender/correspondence/sample_distances.inl>
#include <genrender/core/each_target.inl>

#include <genrender/core/end_header.inl>
