// SPDX-License-Identifier: MIT
// Plans for processors: whatever rows a test wants for a site and a frame.
#pragma once

#include <genrender/blending/blend_plans.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace genrender::testing {

/// The plans of some sites and frames, `rows_of(site, frame)` each, which are copied. Sites have grids of their own, so
/// that each may have other plans.
template <class Real, class RowsOf>
blend_plans<Real> plans_of(std::size_t sites, std::span<frame_index const> frames, RowsOf const& rows_of) {
    std::vector<grid_extents> grids;
    for (std::size_t s = 0; s < sites; ++s) {
        grids.push_back({1, s + 1});
    }
    blend_plans<Real> plans(grids);
    for (std::uint32_t s = 0; s < sites; ++s) {
        for (auto const frame : frames) {
            sparse_rows<Real> const rows = rows_of(site_index{s}, frame);
            blend_plan<Real> plan;
            plan.offsets.assign(rows.offsets.begin(), rows.offsets.end());
            plan.sources.assign(rows.sources.begin(), rows.sources.end());
            plan.weights.assign(rows.weights.begin(), rows.weights.end());
            plans.add(grids[s], frame, std::move(plan));
        }
    }
    return plans;
}

} // namespace genrender::testing
