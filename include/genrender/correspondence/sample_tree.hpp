// SPDX-License-Identifier: MIT
// The points nearest to a place in canonical coordinates: a k-d tree of nanoflann's behind a small door.
#pragma once

#include <genrender/core/begin_header.inl>

#include <nanoflann.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

namespace genrender {

/// Points of D canonical coordinates and a search for those nearest to a place. Copies share the tree.
template <std::size_t D>
class sample_tree {
public:
    /// How many points a search visits. Canonical distance is not distance on the screen: where a surface is seen at a
    /// grazing angle, the closest pixel of the screen is among the nearest few.
    static constexpr std::size_t visited = 8;

    sample_tree() = default;
    explicit sample_tree(std::vector<std::array<float, D>> places)
        : cloud_(std::make_shared<cloud>(std::move(places))) {}

    /// Calls `visit(number of the point)` for the `visited` points nearest to `place`, nearest first; all if there are
    /// fewer.
    template <class Visit>
    void visit_nearest(std::array<float, D> const& place, Visit&& visit) const {
        if (!cloud_) {
            return;
        }
        std::array<std::uint32_t, visited> numbers{};
        std::array<float, visited> squared{};
        nanoflann::KNNResultSet<float, std::uint32_t> nearest(visited);
        nearest.init(numbers.data(), squared.data());
        if (cloud_->tree) {
            cloud_->tree->findNeighbors(nearest, place.data(), {});
        } else {
            for (std::uint32_t number = 0; number < cloud_->places.size(); ++number) {
                auto const square = square_of(cloud_->places[number], place);
                if (square < nearest.worstDist()) {
                    nearest.addPoint(square, number);
                }
            }
        }
        for (std::size_t k = 0; k < nearest.size(); ++k) {
            visit(std::size_t{numbers[k]});
        }
    }

    /// Bytes of a tree of so many points, about: its copy of them, and of more than a few their order and some nodes.
    static constexpr std::size_t expected_bytes(std::size_t count) {
        constexpr std::size_t of_node = D > 2 ? 10 : 9; // for a point
        constexpr std::size_t block = 8192;             // nodes are allocated in such
        auto const nodes = (count * of_node + block - 1) / block * block;
        return count * sizeof(std::array<float, D>) + (count > few ? count * sizeof(std::uint32_t) + nodes : 0);
    }

private:
    /// So many points are gone through one by one, as fast as by a tree.
    static constexpr std::size_t few = 256;

    struct cloud {
        explicit cloud(std::vector<std::array<float, D>> given) : places(std::move(given)) {
            if (places.size() > few) {
                tree.emplace(int{D}, *this);
            }
        }

        // What nanoflann asks of a data set.
        std::size_t kdtree_get_point_count() const { return places.size(); }
        float kdtree_get_pt(std::size_t number, std::size_t axis) const { return places[number][axis]; }
        template <class Box>
        bool kdtree_get_bbox(Box&) const {
            return false;
        }

        std::vector<std::array<float, D>> places;
        std::optional<nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, cloud>, cloud, int{D},
                                                          std::uint32_t>>
            tree;
    };

    static float square_of(std::array<float, D> const& a, std::array<float, D> const& b) {
        float sum = 0;
        for (std::size_t d = 0; d < D; ++d) {
            sum += (a[d] - b[d]) * (a[d] - b[d]);
        }
        return sum;
    }

    std::shared_ptr<cloud const> cloud_;
};

} // namespace genrender

#include <genrender/core/end_header.inl>
