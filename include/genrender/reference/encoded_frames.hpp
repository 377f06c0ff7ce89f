// SPDX-License-Identifier: MIT
// [GR alg. 1: Phi] What the decoder of a UNet starts from, kept for frames that are denoised again at the same z.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/index.hpp>
#include <genrender/core/stack.hpp>
#include <genrender/reference/unet_encoder.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace genrender::reference {

/// The encoder's outputs of the frames of one call, ControlNet included, by guidance branch.
template <class Real>
class encoded_frames {
public:
    /// Of one branch: the maps, and the embedding of time that the decoder takes beside them.
    struct of_branch {
        encoded_maps<Real> maps; ///< what the encoder gives
        std::vector<Real> time;  ///< embedding of time
    };

    encoded_frames() = default;

    /// For a call of `frames` at z [frames, channels, height, width] and sigma; nothing is kept yet.
    encoded_frames(std::span<frame_index const> frames, strided_view<Real const, 4> z, Real sigma, std::size_t branches)
        : frames_(frames.begin(), frames.end()), z_(z.extents()), sigma_(sigma), branches_(branches) {
        copy(z_.view(), z);
    }

    /// Keeps what a branch gave.
    void put(std::uint32_t branch, of_branch encoded) { branches_[branch] = std::move(encoded); }

    /// What a branch gives for `frames` at z and sigma; none unless it is kept of each of them and z is theirs to the
    /// bit.
    std::optional<of_branch> find(std::uint32_t branch, std::span<frame_index const> frames,
                                  strided_view<Real const, 4> z, Real sigma) const {
        if (branch >= branches_.size() || !branches_[branch] || sigma != sigma_) {
            return std::nullopt;
        }
        std::vector<std::size_t> positions;
        for (std::size_t i = 0; i < frames.size(); ++i) {
            auto const found = std::find(frames_.begin(), frames_.end(), frames[i]);
            auto const position = static_cast<std::size_t>(found - frames_.begin());
            if (found == frames_.end() || !is_same(z[i], z_.view()[position])) {
                return std::nullopt;
            }
            positions.push_back(position);
        }
        auto const& kept = *branches_[branch];
        of_branch result{{{}, entries_of(kept.maps.middle, positions)}, kept.time};
        for (auto const& skip : kept.maps.skips) {
            result.maps.skips.push_back(entries_of(skip, positions));
        }
        return result;
    }

private:
    static bool is_same(strided_view<Real const, 3> a, strided_view<Real const, 3> b) {
        for (std::size_t c = 0; c < a.extent(0); ++c) {
            for (std::size_t row = 0; row < a.extent(1); ++row) {
                for (std::size_t column = 0; column < a.extent(2); ++column) {
                    if (a(c, row, column) != b(c, row, column)) {
                        return false;
                    }
                }
            }
        }
        return true;
    }

    static feature_maps<Real> entries_of(feature_maps<Real> const& maps, std::vector<std::size_t> const& positions) {
        feature_maps<Real> entries(positions.size(), maps.grid(), maps.channels());
        for (std::size_t i = 0; i < positions.size(); ++i) {
            copy(entries[i], maps[positions[i]]);
        }
        return entries;
    }

    std::vector<frame_index> frames_;
    stack<Real, 4> z_;
    Real sigma_ = 0;
    std::vector<std::optional<of_branch>> branches_;
};

/// Bytes that the encoder's outputs of one frame and branch take, for latents of this grid.
template <class Real>
std::size_t encoded_bytes(unet_config const& config, grid_extents latent_grid) {
    auto const tokens = [&](std::size_t level) { return (latent_grid.height >> level) * (latent_grid.width >> level); };
    auto values = tokens(0) * config.block_out_channels.front();
    for (std::size_t level = 0; level < config.levels(); ++level) {
        auto const channels = config.block_out_channels[level];
        values += config.layers_per_block * tokens(level) * channels;
        values += tokens(std::min(level + 1, config.levels() - 1)) * channels; // the downsampler's, or the mid block's
    }
    return values * sizeof(Real);
}

} // namespace genrender::reference

#include <genrender/core/end_header.inl>
