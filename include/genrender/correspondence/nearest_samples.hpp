// SPDX-License-Identifier: MIT
// The points nearest to a place in canonical coordinates: a k-d tree of nanoflann's behind a small door.
#pragma once

#include <genrender/core/begin_header.inl>

#include <nanoflann.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

namespace genrender {

/// Points of D canonical coordinates and a search for those nearest to a place. Copies share the tree.
template <std::size_t D>
class nearest_samples {
public:
    /// How many points a search visits. Canonical distance is not distance on the screen: where a surface is seen at a
    /// grazing angle, the closest pixel of the screen is among the nearest few.
    static constexpr std::size_t visited = 8;

    nearest_samples() = default;
    /// Of places that are numbered in their order.
    explicit nearest_samples(std::vector<std::array<float, D>> places)
        : cloud_(places.empty() ? nullptr : std::make_shared<cloud>(std::move(places))) {}

    /// Calls `visit(number of the point)` for the `visited` points nearest to `place`, nearest first; all if there are
    /// fewer. Numbers count the points from 0 in the order in which they were given.
    template <class Visit>
    void visit_nearest(std::array<float, D> const& place, Visit&& visit) const {
        if (!cloud_) {
            return;
        }
        std::array<std::uint32_t, visited> numbers{};
        std::array<float, visited> squared{};
        nanoflann::KNNResultSet<float, std::uint32_t> nearest(visited);
        nearest.init(numbers.data(), squared.data());
        cloud_->tree.findNeighbors(nearest, place.data(), {});
        for (std::size_t k = 0; k < nearest.size(); ++k) {
            visit(std::size_t{numbers[k]});
        }
    }

    /// Bytes of a tree of so many points, about: its copy of them, their order and its nodes.
    static constexpr std::size_t expected_bytes(std::size_t count) {
        constexpr std::size_t of_node = D > 2 ? 10 : 9; // for a point
        constexpr std::size_t block = 8192;             // nodes are allocated in such
        auto const nodes = (count * of_node + block - 1) / block * block;
        return count * (sizeof(std::array<float, D>) + sizeof(std::uint32_t)) + nodes;
    }

private:
    struct cloud {
        explicit cloud(std::vector<std::array<float, D>> given) : places(std::move(given)), tree(int{D}, *this) {}

        // What nanoflann asks of a data set.
        std::size_t kdtree_get_point_count() const { return places.size(); }
        float kdtree_get_pt(std::size_t number, std::size_t axis) const { return places[number][axis]; }
        template <class Box>
        bool kdtree_get_bbox(Box&) const {
            return false;
        }

        std::vector<std::array<float, D>> places;
        nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, cloud>, cloud, int{D}, std::uint32_t>
            tree;
    };

    std::shared_ptr<cloud const> cloud_;
};

} // namespace genrender

#include <genrender/core/end_header.inl>
