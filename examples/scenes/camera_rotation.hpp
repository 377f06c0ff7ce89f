// SPDX-License-Identifier: MIT
// [GR sec. 5] A still life on a round stage, seen by a camera that goes around it.
#pragma once

#include <genrender/scene/animation.hpp>
#include <genrender/scene/primitives.hpp>

#include <glm/ext/matrix_transform.hpp>
#include <glm/mat4x4.hpp>
#include <glm/trigonometric.hpp>
#include <glm/vec3.hpp>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

namespace genrender::scenes {

/// Columns, balls and blocks around a globe on a plinth; nothing moves but the camera. A model of animation.
class camera_rotation {
public:
    /// The camera goes through `turn` radians in all, in equal steps; after a whole turn the last frame is followed by
    /// the first.
    explicit camera_rotation(std::size_t frame_count, float turn = glm::radians(360.0f))
        : frame_count_(frame_count), turn_(turn) {
        place(make_disk(7.5f, 96), {0, 0, 0});
        place(make_cylinder(0.85f, 0.7f, 48), {0, 0.35f, 0});
        place(make_sphere(0.8f, 64), {0, 1.5f, 0});
        place(make_box({0.75f, 1.9f, 0.75f}), {-1.7f, 0.95f, -0.8f}, 25);
        place(make_capsule(0.4f, 0.95f, 40), {1.75f, 0.875f, -0.6f});
        place(make_box({1.15f, 0.75f, 1.15f}), {-1.15f, 0.375f, 1.7f}, -32);
        place(make_sphere(0.36f, 40), {-1.1f, 1.11f, 1.65f});
        place(make_cylinder(0.33f, 1.5f, 40), {0.55f, 0.75f, -2.05f});
        place(make_sphere(0.52f, 48), {1.35f, 0.52f, 1.75f});
        place(make_sphere(0.3f, 40), {0.45f, 0.3f, 2.1f});
    }

    std::size_t frame_count() const { return frame_count_; }

    posed_scene frame(frame_index i) const {
        auto const angle = turn_ * static_cast<float>(i.value) / static_cast<float>(frame_count_) + 0.35f;
        auto const position = glm::vec3(6.0f * std::sin(angle), 2.5f, 6.0f * std::cos(angle));
        return {look_at(position, {0, 1.02f, 0}, glm::radians(43.0f)), objects_};
    }

private:
    void place(mesh surface, glm::vec3 at, float degrees = 0) {
        auto const to_world = glm::rotate(glm::translate(glm::mat4(1), at), glm::radians(degrees), glm::vec3(0, 1, 0));
        auto const number = object_index{static_cast<std::uint32_t>(objects_.size())};
        objects_.push_back(pose(number, std::make_shared<mesh const>(std::move(surface)), to_world));
    }

    std::size_t frame_count_;
    float turn_;
    std::vector<posed_object> objects_;
};

} // namespace genrender::scenes
