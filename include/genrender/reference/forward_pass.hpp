// SPDX-License-Identifier: MIT
// What one run of a network hands down to its layers beside the features.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/attention/any_processor.hpp>
#include <genrender/attention/attention_site.hpp>
#include <genrender/attention/host_features.hpp>
#include <genrender/core/index.hpp>
#include <genrender/core/parallel.hpp>
#include <genrender/core/strided_view.hpp>
#include <genrender/injection/host_attention_call.hpp>
#include <genrender/reference/attention_matrices.hpp>
#include <genrender/reference/feature_maps.hpp>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace genrender::reference {

/// Any attention_processor of the network's modules, so that the layers are compiled once for all of them.
template <class Real>
using any_processor = genrender::any_processor<host_attention_call<Real, attention_matrices<Real>>>;

/// One run of one network for one guidance branch. All frames pass a layer before any enters the next, because a
/// processor may let frames attend to each other [GR eq. 3].
template <class Real>
struct forward_pass {
    std::span<frame_index const> frames; ///< which frame of the animation each entry of a stack is
    std::uint32_t branch = 0;            ///< guidance branch
    strided_view<Real const, 2> prompt;  ///< tokens of the prompt [tokens, cross_attention_dim]
    any_processor<Real> processor;       ///< runs at the self-attention sites
    any_loop loop{};                     ///< over frames
    std::vector<Real> time{};            ///< of the network's time_embedding, after SiLU [time_channels]
    /// The last site that is wanted; none runs the whole network.
    std::optional<site_index> last_site{};
    /// Whether the last wanted site has run: layers then return at once, with results that nobody reads.
    mutable bool is_over = false;

    /// Calls `body(i)` for every entry of the stack.
    void each_frame(loop_body body) const {
        if (frames.size() == 1) {
            body(0); // The threads are those of tokens() then.
        } else {
            loop(frames.size(), body);
        }
    }

    /// The loop inside `body`: shares out a layer's tokens and channels where there are no frames to share out.
    any_loop tokens() const { return frames.size() == 1 ? loop : any_loop{}; }

    /// Memory for a result of all frames, not yet set.
    feature_maps<Real> maps(grid_extents grid, std::size_t channels) const { return {frames.size(), grid, channels}; }
};

} // namespace genrender::reference

#include <genrender/core/end_header.inl>
