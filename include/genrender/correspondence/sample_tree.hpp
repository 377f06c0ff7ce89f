// SPDX-License-Identifier: MIT
// The points nearest to a place in canonical coordinates: a k-d tree of nanoflann's behind a small door.
#pragma once

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
        auto const count = cloud_->tree.knnSearch(place.data(), visited, numbers.data(), squared.data());
        for (std::size_t k = 0; k < count; ++k) {
            visit(std::size_t{numbers[k]});
        }
    }

private:
    struct cloud {
        explicit cloud(std::vector<std::array<float, D>> given) : places(std::move(given)), tree(D, *this) {}

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
