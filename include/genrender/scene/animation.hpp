// SPDX-License-Identifier: MIT
// [GR sec. 3] The concept of an animated scene: what the camera sees and where every surface is, frame by frame.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/index.hpp>
#include <genrender/scene/camera.hpp>
#include <genrender/scene/mesh.hpp>

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include <concepts>
#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

namespace genrender {

/// One object in one frame. Its triangles and UVs are shared with every other frame; only positions are the frame's
/// own.
struct posed_object {
    object_index object;                 ///< the number that its pixels get
    std::shared_ptr<mesh const> surface; ///< triangles and UVs; its positions are the rest pose
    std::vector<glm::vec3> positions;    ///< world space, this frame; one for each of the surface's
};

/// All that one frame shows, and the eye it is seen by.
struct posed_scene {
    genrender::camera camera;          ///< the eye that sees the objects
    std::vector<posed_object> objects; ///< in any order
};

/// `positions` moved by an affine transform.
inline std::vector<glm::vec3> transformed(std::vector<glm::vec3> positions, glm::mat4 const& transform) {
    for (auto& p : positions) {
        p = glm::vec3(transform * glm::vec4(p, 1));
    }
    return positions;
}

/// A rigid object: the surface's rest pose moved by `to_world`.
inline posed_object pose(object_index object, std::shared_ptr<mesh const> surface, glm::mat4 const& to_world) {
    auto positions = transformed(surface->positions, to_world);
    return {object, std::move(surface), std::move(positions)};
}

/// An animated scene of any length, given frame by frame: a loaded file, a simulation, a formula.
///
/// expression            | type                          | meaning
/// ----------------------|-------------------------------|-------------------------------------------------
/// `scene.frame_count()` | convertible to `std::size_t`  | number of frames
/// `scene.frame(i)`      | convertible to `posed_scene`  | frame i, for `i.value < scene.frame_count()`
///
/// These the compiler cannot check, and a model owes them (check_animation_laws of testing/animation_laws.hpp checks
/// them): frame(i) depends on i alone, whatever was asked before, and
/// may be called by several threads at once; an object number names the same surface, with the same UVs and triangles,
/// in every frame that shows it (this is what a point on a texture keeps its appearance by); no two objects of a frame
/// share a number.
/// See also: rasterize, which turns an animation into maps.
template <class Animation>
concept animation = requires(Animation const& scene, frame_index i) {
    { scene.frame_count() } -> std::convertible_to<std::size_t>;
    { scene.frame(i) } -> std::convertible_to<posed_scene>;
};

} // namespace genrender

#include <genrender/core/end_header.inl>
