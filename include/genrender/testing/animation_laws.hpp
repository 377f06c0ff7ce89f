// SPDX-License-Identifier: MIT
// [GR sec. 3] The laws of animation, as a check of a model.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/scene/animation.hpp>
#include <genrender/scene/camera.hpp>
#include <genrender/scene/mesh.hpp>
#include <genrender/testing/at_once.hpp>
#include <genrender/testing/law_report.hpp>

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <set>
#include <stdexcept>
#include <string>
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

namespace detail {

/// Notes what `check()` throws as a broken law.
template <class Check>
void require_valid(law_report& report, char const* law, std::string const& where, Check const& check) {
    try {
        check();
    } catch (std::invalid_argument const& error) {
        report.add(law, where + ": " + error.what(), "no exception");
    }
}

} // namespace detail

/// Checks the laws of animation on every frame of `scene`, each of which is made twice. Throws what frame(i) throws.
template <animation Animation>
law_report check_animation_laws(Animation const& scene) {
    law_report report;
    std::size_t const frames = scene.frame_count();
    std::vector<posed_scene> in_order;
    std::map<object_index, std::shared_ptr<mesh const>> surfaces;
    for (std::size_t i = 0; i < frames; ++i) {
        in_order.push_back(scene.frame({static_cast<std::uint32_t>(i)}));
        auto const frame = "frame " + std::to_string(i);
        detail::require_valid(report, "animation: cameras can see", frame, [&] { validate(in_order.back().camera); });
        std::set<object_index> seen;
        for (auto const& posed : in_order.back().objects) {
            auto const object = "object " + std::to_string(posed.object.value) + " of " + frame;
            report.require(seen.insert(posed.object).second, "animation: no two objects of a frame share a number",
                           object + " twice", "it once");
            if (posed.surface == nullptr) {
                report.add("animation: every object has a surface", object + " without one", "a mesh");
                continue;
            }
            detail::require_valid(report, "animation: surfaces are meshes", object, [&] { validate(*posed.surface); });
            report.require(posed.positions.size() == posed.surface->positions.size(),
                           "animation: an object has a position for each of its surface's",
                           std::to_string(posed.positions.size()) + " of " + object,
                           std::to_string(posed.surface->positions.size()));
            // An object keeps its texture coordinates for the whole animation.
            auto const& first = surfaces.emplace(posed.object, posed.surface).first->second;
            report.require(first->uvs == posed.surface->uvs && first->triangles == posed.surface->triangles,
                           "animation: an object number names the same UVs and triangles in every frame",
                           "others of " + object, "those of the first frame that shows it");
        }
    }
    // Backwards and on two threads, every frame is what it was.
    std::vector<char> same(frames, 0);
    at_once(2, frames,
            [&](std::size_t i) { same[i] = is_same_scene(in_order[i], scene.frame({static_cast<std::uint32_t>(i)})); });
    for (std::size_t i = 0; i < frames; ++i) {
        report.require(same[i] != 0, "animation: frame(i) depends on i alone, from any thread",
                       "another frame " + std::to_string(i) + " when asked again", "the same");
    }
    return report;
}

} // namespace genrender::testing

#include <genrender/core/end_header.inl>
