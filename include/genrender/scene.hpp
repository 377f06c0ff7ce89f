// SPDX-License-Identifier: MIT
// Meshes, cameras, animations and primitives, and the rasteriser that draws them into UV and depth maps: the component
// genrender::scene.
#pragma once

#include <genrender/scene/animation.hpp>
#include <genrender/scene/bounds.hpp>
#include <genrender/scene/camera.hpp>
#include <genrender/scene/frame_rasterizer.hpp>
#include <genrender/scene/mesh.hpp>
#include <genrender/scene/primitives.hpp>
#include <genrender/scene/rasterizer.hpp>
#include <genrender/scene/skinning.hpp>
#include <genrender/scene/triangle_coverage.hpp>
#include <genrender/scene/uv_overlap.hpp>
