// SPDX-License-Identifier: MIT
// What every animation owes beyond its concept, as checks for models of the library and of users.
#pragma once

#include <genrender/core/parallel.hpp>
#include <genrender/scene/animation.hpp>

#include <doctest/doctest.h>

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <set>
#include <vector>

namespace genrender::testing {

/// Whether two frames show the same objects at the same places through the same camera, bit by bit.
inline bool is_same_scene(posed_scene const& a, posed_scene const& b) {
    auto same = a.camera.view == b.camera.view && a.camera.vertical_fov == b.camera.vertical_fov &&
                a.camera.near_distance == b.camera.near_distance && a.objects.size() == b.objects.size();
    for (std::size_t i = 0; same && i < a.objects.size(); ++i) {
        same = a.objects[i].object == b.objects[i].object && a.objects[i].positions == b.objects[i].positions;
    }
    return same;
}

/// Checks the laws of animation on every frame of `scene`.
template <animation Animation>
void check_animation_laws(Animation const& scene) {
    std::size_t const frames = scene.frame_count();
    std::vector<posed_scene> in_order;
    std::map<object_index, std::shared_ptr<mesh const>> surfaces;
    for (std::size_t i = 0; i < frames; ++i) {
        in_order.push_back(scene.frame({static_cast<std::uint32_t>(i)}));
        validate(in_order.back().camera);
        std::set<object_index> seen;
        for (auto const& posed : in_order.back().objects) {
            REQUIRE(seen.insert(posed.object).second);
            REQUIRE(posed.surface != nullptr);
            validate(*posed.surface);
            REQUIRE(posed.positions.size() == posed.surface->positions.size());
            // An object keeps its texture coordinates for the whole animation.
            auto const& first = surfaces.emplace(posed.object, posed.surface).first->second;
            REQUIRE(first->uvs == posed.surface->uvs);
            REQUIRE(first->triangles == posed.surface->triangles);
        }
    }
    // Backwards and on two threads, every frame is what it was.
    std::vector<char> same(frames, 0);
    threaded_loop{2}(frames, [&](std::size_t i) {
        auto const frame = frames - 1 - i;
        same[frame] = is_same_scene(in_order[frame], scene.frame({static_cast<std::uint32_t>(frame)}));
    });
    for (auto const frame_is_same : same) {
        REQUIRE(frame_is_same);
    }
}

} // namespace genrender::testing
