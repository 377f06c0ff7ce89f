// SPDX-License-Identifier: MIT
// [GR sec. 3] The view of UV maps through which every room downstream reads them, whoever owns the memory.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/maps/canonical_maps.hpp>

namespace genrender {

/// UV maps of an animation in their owner's memory: texture coordinates [frames, height, width, 2] and the objects that
/// they belong to.
using uv_maps_view = canonical_maps_view<2>;

} // namespace genrender

#include <genrender/core/end_header.inl>
