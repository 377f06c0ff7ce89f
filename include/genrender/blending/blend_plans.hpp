// SPDX-License-Identifier: MIT
// [GR alg. 1: F_bar^i = pi_i(T_bar_KF)] The plans of the frames of a call at all feature resolutions of a network.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/attention/attention_site.hpp>
#include <genrender/blending/blend_plan.hpp>
#include <genrender/core/error.hpp>
#include <genrender/core/index.hpp>
#include <genrender/core/sparse_rows.hpp>

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace genrender {

/// Plans by feature grid and frame, found by the sites that have the grid. What makes them, blending or propagation, is
/// not its affair.
template <class Real>
class blend_plans {
public:
    /// No plans, of no sites.
    blend_plans() = default;

    /// No plans yet; `grid_of_site` holds the feature grid of each site, in the order of the denoiser's sites. Rows carry
    /// keys of `evaluation`, a number of next_evaluation; none carry none.
    explicit blend_plans(std::vector<grid_extents> grid_of_site, std::optional<std::uint64_t> evaluation = {})
        : grid_of_site_(std::move(grid_of_site)), evaluation_(evaluation) {}

    /// Keeps the plan of a frame at the sites of a grid, unless there is one.
    void add(grid_extents grid, frame_index frame, blend_plan<Real> plan) {
        plans_.emplace(std::pair(grid, frame), std::move(plan));
    }

    /// The plan's rows of a frame at a site: F_bar^i = rows * F_KF, with the key of grid, frame and evaluation. They
    /// view the plan, which moves with its owner without changing its place in memory. Throws value_error if there is no
    /// such site or plan.
    sparse_rows<Real> rows(site_index site, frame_index frame) const {
        require_value(site.value < grid_of_site_.size(), "blend_plans", "site", site.value,
                      "one of the denoiser's sites");
        auto const grid = grid_of_site_[site.value];
        auto const found = plans_.find(std::pair(grid, frame));
        if (found == plans_.end()) {
            throw value_error("blend_plans: frame is " + std::to_string(frame.value) +
                              ", expected one with a plan for " + extents_text({grid.height, grid.width}) + " tokens");
        }
        auto rows = found->second.rows();
        if (evaluation_) {
            rows.key = plan_key{grid, frame, *evaluation_};
        }
        return rows;
    }

    /// The rows of several frames at a site, in their order. Throws as above.
    std::vector<sparse_rows<Real>> rows(site_index site, std::span<frame_index const> frames) const {
        std::vector<sparse_rows<Real>> all;
        all.reserve(frames.size());
        for (auto const frame : frames) {
            all.push_back(rows(site, frame));
        }
        return all;
    }

private:
    std::vector<grid_extents> grid_of_site_;
    std::optional<std::uint64_t> evaluation_;
    std::map<std::pair<grid_extents, frame_index>, blend_plan<Real>> plans_;
};

} // namespace genrender

#include <genrender/core/end_header.inl>
