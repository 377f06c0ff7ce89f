// SPDX-License-Identifier: MIT
// Gaussian white noise over a space of canonical coordinates, at every resolution at once and never stored.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/error.hpp>
#include <genrender/core/index.hpp>
#include <genrender/core/random.hpp>
#include <genrender/noise/brownian_bridge.hpp>
#include <genrender/noise/noise_request.hpp>
#include <genrender/noise/normals.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace genrender {

/// White noise over the cube [-2^16, 2^16)^D as a tree of cells, each with a value of N(0, 1) a channel that its 2^D
/// children divide among themselves by a Brownian bridge. Values follow from the seed and the way from the root, so
/// there is nothing to store, frames can be made in any order, and what is seen from afar is the sum of what is seen
/// close by: there is no resolution to choose.
template <std::size_t D>
class noise_tree {
public:
    static constexpr std::uint32_t deepest = 48; ///< levels below the root, at most
    static constexpr double half_width = 65536;  ///< coordinates lie in [-half_width, half_width) on each axis

    /// The noise of one object's space in one diffusion step; other streams, steps and objects have noise of their own.
    noise_tree(std::uint64_t seed, random_stream stream, object_index object, std::uint32_t step = 0)
        : root_(key_of(random_bits(seed, stream, {object.value, step, 0}))) {}

    /// The place of a point. Throws value_error unless every coordinate is finite and in [-2^16, 2^16).
    static std::array<std::uint64_t, D> place_of(std::array<double, D> const& point) {
        std::array<std::uint64_t, D> place{};
        for (std::size_t d = 0; d < D; ++d) {
            require_value(point[d] >= -half_width && point[d] < half_width, "noise_tree", "canonical coordinate",
                          point[d], "a number in [-65536, 65536)");
            place[d] = static_cast<std::uint64_t>((point[d] + half_width) * 0x1p31);
        }
        return place;
    }

    /// The level whose cells are at least `side` > 0 wide, and less than twice that, as far as there are levels.
    static std::uint32_t level_of(double side) {
        // The exponent of a number that is never below 0, as std::ilogb has it.
        auto const level = static_cast<int>(std::bit_cast<std::uint64_t>(2 * half_width / side) >> 52) - 1023;
        return static_cast<std::uint32_t>(std::clamp(level, 0, static_cast<int>(deepest)));
    }

    /// Adds to `sums` [pixels, channels] what the requests see: sum over cells of sqrt(share) Y with independent Y of
    /// N(0, 1). A pixel whose shares sum to 1 over all trees thereby gets a value of N(0, 1), and no two pixels of a
    /// call share any noise: a cell that several look at is divided among them by their shares, one that contains
    /// smaller requested cells is divided down to them. `requests` are reordered.
    void add(std::span<double> sums, std::size_t channels, std::span<noise_request<D>> requests) const {
        if (!requests.empty()) {
            walk(sums, channels, requests).run(root_);
        }
    }

private:
    using key = std::array<std::uint32_t, 2>;
    static constexpr std::size_t children = std::size_t{1} << D;

    static key key_of(std::array<std::uint32_t, 4> const& bits) { return {bits[0], bits[1]}; }

    /// What looks at a whole cell, on its way down to where the cell is not divided further.
    struct look {
        std::uint32_t pixel;
        double share;
    };

    /// One call of add: the way down the tree with all that is kept on it.
    class walk {
    public:
        walk(std::span<double> sums, std::size_t channels, std::span<noise_request<D>> requests)
            : sums_(sums), channels_(channels), requests_(requests),
              scratch_(std::make_unique_for_overwrite<noise_request<D>[]>(requests.size())),
              values_((deepest + 2) * children * channels) {
            root_shares_.fill(1 / std::sqrt(static_cast<double>(children)));
        }

        void run(key const& root) {
            draw(root, 0, 1);
            for (std::size_t c = 0; c < channels_; ++c) {
                values_[c] = drawn_[4 * c];
            }
            descend(requests_, {scratch_.get(), requests_.size()}, 0, root, values_.data());
        }

    private:
        /// Draws values 4 * block ... of N(0, 1) of a node, `blocks` times four a channel: drawn_ [channels, 4 *
        /// blocks].
        void draw(key const& node, std::size_t block, std::size_t blocks) {
            auto const count = channels_ * blocks;
            counters_.assign((count + normals_at_once - 1) / normals_at_once * normals_at_once, {});
            for (std::size_t n = 0; n < count; ++n) {
                counters_[n] = {static_cast<std::uint32_t>(block + n % blocks), static_cast<std::uint32_t>(n / blocks),
                                2, 0};
            }
            drawn_.resize(4 * counters_.size());
            normals_of(counters_, node, drawn_.data());
        }

        /// Divides the node's values W [channels] among its children: the result is [children, channels].
        double* divide_among_children(key const& node, std::uint32_t level, double const* W) {
            draw(node, 0, children / 4);
            auto* const values = &values_[(level + 1) * children * channels_];
            for (std::size_t c = 0; c < channels_; ++c) {
                auto const g = std::span(drawn_).subspan(c * children, children);
                bridge(W[c], root_shares_, g);
                for (std::size_t child = 0; child < children; ++child) {
                    values[child * channels_ + c] = g[child];
                }
            }
            return values;
        }

        static key child_key(key const& node, std::size_t child) {
            return key_of(philox({static_cast<std::uint32_t>(child), 0, 1, 0}, node));
        }

        /// Where requests part from each other.
        struct parting {
            std::uint32_t level; ///< the first on which they do not all look at one cell, or one of them stops
            bool stops;          ///< whether one does
        };

        static parting parting_of(std::span<noise_request<D> const> requests) {
            std::uint64_t different = 0;
            auto lowest = deepest;
            for (auto const& request : requests) {
                for (std::size_t d = 0; d < D; ++d) {
                    different |= request.place[d] ^ requests[0].place[d];
                }
                lowest = std::min(lowest, request.level);
            }
            auto const level = static_cast<std::uint32_t>(std::countl_zero(different)) - (64 - deepest);
            return {std::min(level, lowest), lowest <= level};
        }

        /// All `requests` lie in the node, whose values are W [channels]; `free` is as many requests of room.
        void descend(std::span<noise_request<D>> requests, std::span<noise_request<D>> free, std::uint32_t level,
                     key node, double const* W) {
            auto const carried = looks_.size();
            auto stops = true;
            if (carried == 0) {
                // Nobody looks at what lies beside the way to where the requests part.
                auto const last = parting_of(requests);
                stops = last.stops;
                for (; level < last.level; ++level) {
                    auto const child = detail::child_of(requests[0], deepest - 1 - level);
                    W = divide_among_children(node, level, W) + child * channels_;
                    node = child_key(node, child);
                }
                if (requests.size() == 1) {
                    add_share(requests[0].pixel, requests[0].share, W);
                    return;
                }
            }
            // Those who look at the whole cell look at each of its children alike, if it has to be divided.
            if (stops) {
                auto const is_deeper = [level](auto const& request) { return request.level > level; };
                auto const here = std::partition(requests.begin(), requests.end(), is_deeper);
                for (auto request = here; request != requests.end(); ++request) {
                    looks_.push_back({request->pixel, request->share});
                }
                requests = requests.first(static_cast<std::size_t>(here - requests.begin()));
            }
            if (requests.empty()) {
                divide(node, W);
                looks_.resize(carried);
                return;
            }
            auto const begins = detail::sort_by_child(free, requests, deepest - 1 - level);

            auto const* const values = divide_among_children(node, level, W);
            for (auto& look : looks_) {
                look.share /= static_cast<double>(children);
            }
            auto const looking = looks_.size();
            for (std::size_t child = 0; child < children; ++child) {
                auto const count = begins[child + 1] - begins[child];
                if (looking == 0 && count == 1 && free[begins[child]].level == level + 1) {
                    // Many cells are seen by one pixel alone, which needs nothing more of them.
                    auto const& only = free[begins[child]];
                    add_share(only.pixel, only.share, values + child * channels_);
                } else if (count > 0 || looking > 0) {
                    descend(free.subspan(begins[child], count), requests.subspan(begins[child], count), level + 1,
                            child_key(node, child), values + child * channels_);
                }
            }
            for (auto& look : looks_) {
                look.share *= static_cast<double>(children);
            }
            looks_.resize(carried);
        }

        void add_share(std::uint32_t pixel, double share, double const* W) {
            auto const weight = std::sqrt(share);
            for (std::size_t c = 0; c < channels_; ++c) {
                sums_[pixel * channels_ + c] += weight * W[c];
            }
        }

        /// Divides a cell among the pixels that look at it.
        void divide(key const& node, double const* W) {
            parts_.assign(looks_.begin(), looks_.end());
            auto const by_pixel = [](auto const& a, auto const& b) { return a.pixel < b.pixel; };
            if (!std::is_sorted(parts_.begin(), parts_.end(), by_pixel)) {
                std::sort(parts_.begin(), parts_.end(), by_pixel);
            }
            std::size_t count = 0;
            double total = 0;
            for (auto const& look : parts_) {
                total += look.share;
                if (count > 0 && parts_[count - 1].pixel == look.pixel) {
                    parts_[count - 1].share += look.share;
                } else {
                    parts_[count++] = look;
                }
            }
            if (count == 1) {
                add_share(parts_[0].pixel, total, W);
                return;
            }
            part_shares_.resize(count);
            for (std::size_t j = 0; j < count; ++j) {
                part_shares_[j] = std::sqrt(parts_[j].share / total);
            }
            // Numbers after those of the children, since another frame may divide the same cell.
            auto const blocks = (count + 3) / 4;
            draw(node, children / 4, blocks);
            for (std::size_t c = 0; c < channels_; ++c) {
                auto const values = std::span(drawn_).subspan(c * 4 * blocks, count);
                bridge(W[c], part_shares_, values);
                for (std::size_t j = 0; j < count; ++j) {
                    sums_[parts_[j].pixel * channels_ + c] += std::sqrt(parts_[j].share) * values[j];
                }
            }
        }

        std::span<double> sums_;
        std::size_t channels_;
        std::span<noise_request<D>> requests_;
        std::unique_ptr<noise_request<D>[]> scratch_;
        std::vector<double> values_; ///< [levels, children, channels]
        std::vector<look> looks_;
        std::vector<look> parts_;
        std::vector<double> part_shares_;
        std::vector<std::array<std::uint32_t, 4>> counters_;
        std::vector<double> drawn_;
        std::array<double, children> root_shares_{};
    };

    key root_;
};

} // namespace genrender

#include <genrender/core/end_header.inl>
