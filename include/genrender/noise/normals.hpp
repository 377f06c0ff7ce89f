// SPDX-License-Identifier: MIT
// The transform of Box and Muller for many values at once: what core/random.hpp's four_normals_of gives, to a few units
// in the last place.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/random.hpp>
#include <genrender/core/vectors.hpp>

#include <array>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <numbers>
#include <span>

namespace genrender {

/// Counters that normals_of takes together.
inline constexpr std::size_t normals_at_once = 4;

} // namespace genrender

#define GENRENDER_KERNELS <genrender/noise/normals.inl>
#include <genrender/core/each_target.inl>

namespace genrender {

inline namespace GENRENDER_UNIT {

/// Four values of N(0, 1) for each of the counters, as many as a multiple of normals_at_once, under one key: values 4 n
/// ... 4 n + 3 are those of four_normals_of(philox(counters[n], key)).
inline void normals_of(std::span<std::array<std::uint32_t, 4> const> counters, std::array<std::uint32_t, 2> const& key,
                       double* values) {
    assert(counters.size() % normals_at_once == 0 && "normals_of: counters that are no multiple of normals_at_once");
    GENRENDER_KERNEL(detail, normals_of)(counters.data(), counters.size(), key, values);
}

} // namespace GENRENDER_UNIT

} // namespace genrender

#include <genrender/core/end_header.inl>
