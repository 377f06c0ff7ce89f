// SPDX-License-Identifier: MIT
// What one run of a network hands down to its layers beside the features.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/index.hpp>
#include <genrender/core/parallel.hpp>
#include <genrender/core/strided_view.hpp>
#include <genrender/reference/feature_maps.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace genrender::reference {

/// The loop inside a frame: shares out a layer's tokens and channels where there are no frames to share out.
template <parallel_loop Loop>
struct token_loop {
    Loop const* loop = nullptr; ///< none: on the caller's thread

    template <class Body>
    void operator()(std::size_t count, Body&& body) const {
        if (loop != nullptr && count > 1) {
            (*loop)(count, body);
        } else {
            sequential_loop{}(count, body);
        }
    }
};

/// One run of one network for one guidance branch. All frames pass a layer before any enters the next, because a
/// processor may let frames attend to each other [GR eq. 3].
template <class Real, class Processor, parallel_loop Loop>
struct forward_pass {
    using real_type = Real;
    using processor_type = Processor;
    using loop_type = Loop;

    std::span<frame_index const> frames; ///< which frame of the animation each entry of a stack is
    std::uint32_t branch = 0;            ///< guidance branch
    strided_view<Real const, 2> prompt;  ///< tokens of the prompt [tokens, cross_attention_dim]
    Processor* processor = nullptr;      ///< runs at the self-attention sites
    Loop const* loop = nullptr;          ///< over frames
    std::vector<Real> time{};            ///< of the network's time_embedding, after SiLU [time_channels]

    /// Calls `body(i)` for every entry of the stack.
    template <class Body>
    void each_frame(Body&& body) const {
        if (frames.size() == 1) {
            body(std::size_t{0}); // The threads are those of tokens() then.
        } else {
            (*loop)(frames.size(), body);
        }
    }

    /// The loop for the layers inside `body`.
    token_loop<Loop> tokens() const { return {frames.size() == 1 ? loop : nullptr}; }

    /// Memory for a result of all frames, not yet set.
    feature_maps<Real> maps(grid_extents grid, std::size_t channels) const { return {frames.size(), grid, channels}; }
};

} // namespace genrender::reference

#include <genrender/core/end_header.inl>
