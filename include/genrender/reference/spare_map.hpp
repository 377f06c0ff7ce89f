// SPDX-License-Identifier: MIT
// One large feature map at the front of its memory, and what is left behind it for the next layer.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/index.hpp>
#include <genrender/core/stack.hpp>
#include <genrender/core/strided_view.hpp>

#include <algorithm>
#include <cstddef>
#include <utility>

namespace genrender::reference {

/// Features [tokens, channels] of one picture, token = row * width + column. A map of a picture is hundreds of
/// megabytes, so layers write over what they have read, and the memory of a map that shrank serves the next layer.
template <class Real>
class spare_map {
public:
    spare_map() = default;

    /// Numbers that nobody has set, and no spare memory.
    spare_map(grid_extents grid, std::size_t channels)
        : grid_(grid), channels_(channels), memory_(stack<Real, 1>::uninitialized({grid.size() * channels})) {}

    /// Height and width of the map.
    grid_extents grid() const { return grid_; }
    /// Channels of a token.
    std::size_t channels() const { return channels_; }
    /// Numbers of the map.
    std::size_t size() const { return grid_.size() * channels_; }
    /// Numbers behind the map that are free.
    std::size_t spare_size() const { return memory_.size() - size(); }

    /// The features [tokens, channels].
    strided_view<Real, 2> view() { return {memory_.data(), {grid_.size(), channels_}}; }
    /// The features [tokens, channels].
    strided_view<Real const, 2> view() const { return {memory_.data(), {grid_.size(), channels_}}; }

    /// Free memory for another map [tokens, channels]: behind this one if it fits there, else in `storage`.
    strided_view<Real, 2> scratch(stack<Real, 1>& storage) {
        if (spare_size() >= size()) {
            return {memory_.data() + size(), {grid_.size(), channels_}};
        }
        storage = stack<Real, 1>::uninitialized({size()});
        return {storage.data(), {grid_.size(), channels_}};
    }

    /// Makes the map that of `channels` channels which stand at `begin` of each token; the rest becomes spare.
    void keep_channels(std::size_t begin, std::size_t channels) {
        auto* to = memory_.data();
        for (std::size_t token = 0; token < grid_.size(); ++token) {
            auto const* const from = memory_.data() + token * channels_ + begin;
            to = std::copy(from, from + channels, to); // Never ahead of what it reads.
        }
        channels_ = channels;
    }

    /// Gives spare memory back.
    void trim() {
        if (spare_size() > 0) {
            auto fitting = stack<Real, 1>::uninitialized({size()});
            std::copy_n(memory_.data(), size(), fitting.data());
            memory_ = std::move(fitting);
        }
    }

private:
    grid_extents grid_{};
    std::size_t channels_ = 0;
    stack<Real, 1> memory_;
};

} // namespace genrender::reference

#include <genrender/core/end_header.inl>
