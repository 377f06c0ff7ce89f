// SPDX-License-Identifier: MIT
// What a look at the maps tells before a run: the component genrender::inspection.
#pragma once

#include <genrender/inspection/coordinate_levels.hpp>
#include <genrender/inspection/finite_maps.hpp>
#include <genrender/inspection/frame_inspection.hpp>
#include <genrender/inspection/grid_check.hpp>
#include <genrender/inspection/map_check.hpp>
#include <genrender/inspection/map_recommendations.hpp>
#include <genrender/inspection/object_check.hpp>
#include <genrender/inspection/pixel_check.hpp>
#include <genrender/inspection/pixel_lattice.hpp>
#include <genrender/inspection/preflight.hpp>
#include <genrender/inspection/recommendation.hpp>
#include <genrender/inspection/screen_search.hpp>
#include <genrender/inspection/texture_tiles.hpp>
