// SPDX-License-Identifier: MIT
// Parts of pixels that look at cells of noise, and how they are parted by the children of a cell.
#pragma once

#include <genrender/core/begin_header.inl>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>

namespace genrender {

/// A part of a pixel that looks at the noise of one cell of space.
template <std::size_t D>
struct noise_request {
    std::array<std::uint64_t, D> place{}; ///< fixed-point coordinates, see noise_tree::place_of
    std::uint32_t level = 0;              ///< the cell's sides are 2^-level of the whole space
    std::uint32_t pixel = 0;              ///< who looks
    double share = 0;                     ///< of the pixel, in (0, 1]
};

namespace detail {

/// The child of its cell that a request lies in, by the `bit` of its place that tells: bit d of the child is that of
/// coordinate d.
template <std::size_t D>
std::size_t child_of(noise_request<D> const& request, std::uint32_t bit) {
    std::size_t child = 0;
    for (std::size_t d = 0; d < D; ++d) {
        child |= static_cast<std::size_t>(request.place[d] >> bit & 1U) << d;
    }
    return child;
}

/// Writes the requests to `to`, those in one child of their cell side by side and in their order; returns where those
/// of child 0, 1, ... begin, and the end.
template <std::size_t D>
std::array<std::size_t, (std::size_t{1} << D) + 1>
sort_by_child(std::span<noise_request<D>> to, std::type_identity_t<std::span<noise_request<D> const>> requests,
              std::uint32_t bit) {
    // Neighbours lie in one child, and a count in memory could not go up again before it has been stored: the counts of
    // all children lie in one register, for as many requests as each has room for.
    constexpr auto children = std::size_t{1} << D;
    constexpr std::size_t width = 64 / children;
    constexpr std::size_t most = (std::size_t{1} << width) - 1;
    auto const count_of = [](std::uint64_t counts, std::size_t child) {
        return static_cast<std::size_t>(counts >> (width * child)) & most;
    };
    std::array<std::size_t, children + 1> begins{};
    for (std::size_t first = 0; first < requests.size(); first += most) {
        std::uint64_t counts = 0;
        for (auto const& request : requests.subspan(first, std::min(most, requests.size() - first))) {
            counts += std::uint64_t{1} << (width * child_of(request, bit));
        }
        for (std::size_t child = 0; child < children; ++child) {
            begins[child + 1] += count_of(counts, child);
        }
    }
    for (std::size_t child = 0; child < children; ++child) {
        begins[child + 1] += begins[child];
    }
    auto places = begins;
    for (std::size_t first = 0; first < requests.size(); first += most) {
        std::uint64_t counts = 0;
        for (auto const& request : requests.subspan(first, std::min(most, requests.size() - first))) {
            auto const child = child_of(request, bit);
            to[places[child] + count_of(counts, child)] = request;
            counts += std::uint64_t{1} << (width * child);
        }
        for (std::size_t child = 0; child < children; ++child) {
            places[child] += count_of(counts, child);
        }
    }
    return begins;
}

} // namespace detail

} // namespace genrender

#include <genrender/core/end_header.inl>
