// SPDX-License-Identifier: MIT
// What Python calls Consensus: the stage between the denoiser and latent normalisation, on estimates in host memory.
#pragma once

#include "animation_maps.hpp"

#include <genrender/core/parallel.hpp>
#include <genrender/maps/background_mask.hpp>
#include <genrender/maps/cell_shares.hpp>
#include <genrender/pipeline/estimate_consensus.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

namespace genrender::python {

/// A consensus of the clean estimates of an animation, whose latents have the grid of a correspondence.
class animation_consensus {
public:
    /// Of `settings`, the fields steps, noise.background and consensus are read. Throws value_error for what no run could
    /// honour.
    animation_consensus(std::shared_ptr<token_correspondence const> correspondence, render_settings<float> settings)
        : correspondence_(std::move(correspondence)), settings_(std::move(settings)) {
        require_value(settings_.steps > 0, "Consensus", "steps", settings_.steps, "at least one step");
        require_consensus_settings("Consensus", settings_.consensus, settings_.steps);
        auto const UV = to_uv_view(correspondence_->maps->uv);
        grid_ = correspondence_->with_map([](auto const& map) { return grid_extents(map.grid()); });
        shares_ = cell_shares(UV, grid_);
        open_background_ =
            open_background(to_view(background_mask(UV, grid_)), settings_.consensus.background_distance);
    }

    /// Moves x0 [frames, channels, height, width] towards it in place; returns the cells of each frame that its sources
    /// cover, none in a step without. Throws shape_error for other extents than those of the animation and the grid,
    /// value_error for a step beyond the run.
    std::vector<std::size_t> reach(strided_view<float, 4> x0, std::size_t step, any_loop const& loop) const {
        require_shape("Consensus.reach", "x0", x0,
                      {correspondence_->maps->uv.frame_count(), x0.extent(1), grid_.height, grid_.width});
        require_value(step < settings_.steps, "Consensus.reach", "step", step, "a step of the run");
        return correspondence_->with_map([&](auto const& map) {
            return reach_consensus(&map, settings_, x0, {to_view(shares_), to_view(open_background_)}, step, loop);
        });
    }

private:
    std::shared_ptr<token_correspondence const> correspondence_;
    render_settings<float> settings_;
    grid_extents grid_{};
    tensor<std::uint8_t, 3> shares_;
    tensor<std::uint8_t, 3> open_background_;
};

} // namespace genrender::python
