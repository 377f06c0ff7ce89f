// SPDX-License-Identifier: MIT
// What a file costs that includes meshes, cameras and the rasteriser.
#include <genrender/scene.hpp>
