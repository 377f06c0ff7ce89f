// SPDX-License-Identifier: MIT
// [GR sec. 5] A figure that walks over a ground plane, skinned to a skeleton; the camera goes along.
#pragma once

#include "mannequin.hpp"
#include "walk_cycle.hpp"

#include <genrender/scene/animation.hpp>
#include <genrender/scene/primitives.hpp>
#include <genrender/scene/skinning.hpp>

#include <glm/ext/matrix_transform.hpp>
#include <glm/mat4x4.hpp>
#include <glm/trigonometric.hpp>
#include <glm/vec3.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

namespace genrender::scenes {

/// A walking mannequin. Its feet find the ground and the ground passes at the speed of the standing foot. A model of
/// animation.
class walking_figure {
public:
    /// One whole walk cycle (two steps) for every 24 frames, at least one; it begins and ends at the same phase.
    explicit walking_figure(std::size_t frame_count)
        : frame_count_(frame_count), cycles_(std::max(1.0f, std::round(static_cast<float>(frame_count) / 24))),
          figure_(make_mannequin()), skin_surface_(std::make_shared<mesh const>(figure_.surface)) {
        stride_ = measured_stride();
        auto const way = stride_ * cycles_;
        place(make_plane({22, 22 + way}, 8), {0, 0, way / 2});
        objects_.push_back({{1}, skin_surface_, {}});
        // Stones along the far side of the path, so that what is behind the figure moves too.
        for (auto z = -3.2f; z < way + 1; z += 2.6f) {
            place(make_cylinder(0.28f, 1.1f, 32), {-2.9f, 0.55f, z + 0.6f});
            place(make_box({0.7f, 0.5f, 0.7f}), {-2.0f, 0.25f, z + 1.7f});
            place(make_sphere(0.42f, 40), {-3.8f, 0.42f, z + 2.2f});
        }
    }

    std::size_t frame_count() const { return frame_count_; }
    /// The way of one walk cycle, in scene units.
    float stride() const { return stride_; }

    posed_scene frame(frame_index i) const {
        auto const part = static_cast<float>(i.value) / static_cast<float>(std::max<std::size_t>(frame_count_, 1));
        auto const cycles = part * cycles_;
        auto const way = glm::vec3(0, 0, cycles * stride_);
        auto positions = standing(cycles - std::floor(cycles));
        for (auto& p : positions) {
            p += way;
        }
        // The camera swings from the figure's side towards its front.
        auto const angle = glm::radians(62.0f - 36.0f * part);
        auto const eye = way + glm::vec3(3.15f * std::sin(angle), 1.75f, 3.15f * std::cos(angle));
        posed_scene scene{look_at(eye, way + glm::vec3(0, 0.9f, 0), glm::radians(36.0f)), objects_};
        scene.objects[figure_number].positions = std::move(positions);
        return scene;
    }

private:
    static constexpr std::size_t figure_number = 1;

    void place(mesh surface, glm::vec3 at) {
        object_index const number{static_cast<std::uint32_t>(objects_.size())};
        objects_.push_back(
            pose(number, std::make_shared<mesh const>(std::move(surface)), glm::translate(glm::mat4(1), at)));
    }

    /// Posed positions at a phase of the walk, with the lowest on y = 0 and the pelvis over the origin.
    std::vector<glm::vec3> standing(float phase) const {
        auto positions = skin(figure_.surface.positions, figure_.weights, joint_transforms(phase), figure_.bind);
        auto lowest = positions.front().y;
        for (auto const& p : positions) {
            lowest = std::min(lowest, p.y);
        }
        for (auto& p : positions) {
            p.y -= lowest;
        }
        return positions;
    }

    std::vector<glm::mat4> joint_transforms(float phase) const {
        auto local = figure_.bones.rest;
        auto const turn = [&](std::uint32_t joint, float angle, glm::vec3 axis) {
            local[joint] = glm::rotate(local[joint], angle, axis);
        };
        constexpr glm::vec3 sideways{1, 0, 0}, upwards{0, 1, 0}, forwards{0, 0, 1};
        auto const trunk = trunk_at(phase);
        local[pelvis] = glm::translate(local[pelvis], {trunk.sway, 0, 0});
        turn(pelvis, trunk.pelvis_turn, upwards);
        turn(pelvis, trunk.pelvis_drop, forwards);
        turn(spine, glm::radians(2.5f), sideways);
        turn(spine, trunk.chest_turn / 2, upwards);
        turn(spine, -trunk.pelvis_drop, forwards);
        turn(chest, trunk.chest_turn / 2, upwards);
        // The head looks ahead whatever the shoulders do.
        turn(neck, -trunk.pelvis_turn - trunk.chest_turn, upwards);
        for (auto const side : {1.0f, -1.0f}) {
            auto const first = side > 0 ? 0 : right_side;
            auto const limbs = limbs_at(side > 0 ? phase : phase < 0.5f ? phase + 0.5f : phase - 0.5f);
            turn(upper_arm + first, glm::radians(7.0f) * side, forwards);
            turn(upper_arm + first, -limbs.shoulder, sideways);
            turn(forearm + first, -limbs.elbow, sideways);
            turn(thigh + first, -trunk.pelvis_drop, forwards);
            turn(thigh + first, -limbs.hip, sideways);
            turn(shin + first, limbs.knee, sideways);
            turn(foot + first, -limbs.ankle, sideways);
        }
        return global_transforms(figure_.bones, local);
    }

    /// How far the ground passes under the lowest point in one cycle: then no standing foot slides on the whole.
    float measured_stride() const {
        constexpr int samples = 96;
        auto stride = 0.0f;
        auto now = standing(0);
        for (int k = 0; k < samples; ++k) {
            auto next = standing(static_cast<float>((k + 1) % samples) / samples);
            auto const lowest =
                std::min_element(now.begin(), now.end(), [](auto const& a, auto const& b) { return a.y < b.y; });
            stride += lowest->z - next[static_cast<std::size_t>(lowest - now.begin())].z;
            now = std::move(next);
        }
        return stride;
    }

    std::size_t frame_count_;
    float cycles_;
    mannequin figure_;
    std::shared_ptr<mesh const> skin_surface_;
    float stride_ = 0;
    std::vector<posed_object> objects_; ///< the figure's positions are left to frame()
};

} // namespace genrender::scenes
