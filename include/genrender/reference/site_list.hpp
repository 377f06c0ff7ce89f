// SPDX-License-Identifier: MIT
// The self-attention modules of the reference network, numbered while its layers are built.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/attention/attention_site.hpp>
#include <genrender/core/index.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace genrender::reference {

/// Collects attention_sites in the order in which they run.
class site_list {
public:
    /// For latents of this grid.
    explicit site_list(grid_extents latent_grid) : latent_grid_(latent_grid) {}

    /// Says to which network the sites added from now on belong.
    void begin(network_kind network) { network_ = network; }

    /// Enters a site whose grid is the latents' halved `level` times, and returns its position.
    site_index add(std::string name, network_part part, std::size_t level, std::size_t channels) {
        grid_extents const grid{latent_grid_.height >> level, latent_grid_.width >> level};
        sites_.push_back({std::move(name), network_, part, grid, channels});
        return {static_cast<std::uint32_t>(sites_.size() - 1)};
    }

    /// The sites added so far, in order.
    std::span<attention_site const> sites() const { return sites_; }

private:
    grid_extents latent_grid_;
    network_kind network_ = network_kind::denoising;
    std::vector<attention_site> sites_;
};

} // namespace genrender::reference

#include <genrender/core/end_header.inl>
