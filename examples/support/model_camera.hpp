// SPDX-License-Identifier: MIT
// [GR sec. 3] Where a loaded model is looked at from: the file's camera, one that sees all frames, or one that orbits.
#pragma once

#include "model_nodes.hpp"

#include <genrender/core/error.hpp>
#include <genrender/scene/bounds.hpp>
#include <genrender/scene/camera.hpp>

#include <assimp/camera.h>
#include <glm/geometric.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/common.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <span>
#include <vector>

namespace genrender::examples {

/// The direction of a view that comes from `azimuth` (0: from +z, growing towards +x) and `elevation` above the
/// ground, radians.
inline glm::vec3 view_direction(float azimuth, float elevation) {
    return {-std::sin(azimuth) * std::cos(elevation), -std::sin(elevation), -std::cos(azimuth) * std::cos(elevation)};
}

/// The three axes of a view along `direction` with y upwards.
struct view_axes {
    glm::vec3 right, up, forward;

    explicit view_axes(glm::vec3 direction)
        : right(glm::normalize(glm::cross(direction, glm::vec3(0, 1, 0)))),
          up(glm::normalize(glm::cross(right, direction))), forward(glm::normalize(direction)) {}
};

/// Share of the image's half height and half width that fitted cameras fill.
inline constexpr float fitted_share = 0.9f;

/// The nearest camera along `direction` that has all `points` within the inner nine tenths of an image of `aspect` =
/// width / height, in its middle. Exact: the view's four planes touch the points. `direction` must not be vertical.
inline camera fit_points(std::span<glm::vec3 const> points, glm::vec3 direction, float vertical_fov, float aspect) {
    view_axes const axes(direction);
    auto const t_y = fitted_share * std::tan(vertical_fov / 2);
    auto const t_x = t_y * aspect;
    // A point is inside the right plane of an eye at (X, Y, Z) if x - X <= t_x (z - Z), that is x - t_x z <= X - t_x Z
    constexpr auto lowest = std::numeric_limits<float>::lowest();
    float right = lowest, left = lowest, top = lowest, bottom = lowest, nearest = -lowest;
    for (auto const& p : points) {
        auto const x = glm::dot(p, axes.right);
        auto const y = glm::dot(p, axes.up);
        auto const z = glm::dot(p, axes.forward);
        right = std::max(right, x - t_x * z);
        left = std::max(left, -x - t_x * z);
        top = std::max(top, y - t_y * z);
        bottom = std::max(bottom, -y - t_y * z);
        nearest = std::min(nearest, z);
    }
    auto const X = (right - left) / 2;
    auto const Y = (top - bottom) / 2;
    auto const Z = std::min(-(right + left) / (2 * t_x), -(top + bottom) / (2 * t_y));
    auto const position = X * axes.right + Y * axes.up + Z * axes.forward;
    auto eye = look_at(position, position + axes.forward, vertical_fov);
    eye.near_distance = std::max((nearest - Z) / 2, 1e-4f * bounds_of(points).radius());
    return eye;
}

/// How far from `centre` cameras must stand to have all `points` within the inner nine tenths of the image from any
/// azimuth.
inline float orbit_distance(std::span<glm::vec3 const> points, glm::vec3 centre, float elevation, float vertical_fov,
                            float aspect) {
    auto const t_y = fitted_share * std::tan(vertical_fov / 2);
    auto const t_x = t_y * aspect;
    // Going around, a point reaches every place of its circle around the vertical axis through `centre`
    constexpr int steps = 64;
    view_axes const axes(view_direction(0, elevation));
    auto distance = 0.0f;
    for (auto const& p : points) {
        auto const radius = std::hypot(p.x - centre.x, p.z - centre.z);
        for (int i = 0; i < steps; ++i) {
            auto const angle = 2 * std::numbers::pi_v<float> * static_cast<float>(i) / steps;
            glm::vec3 const q(radius * std::sin(angle), p.y - centre.y, radius * std::cos(angle));
            auto const reach = std::max(std::abs(glm::dot(q, axes.right)) / t_x, std::abs(glm::dot(q, axes.up)) / t_y);
            distance = std::max(distance, reach - glm::dot(q, axes.forward));
        }
    }
    return distance;
}

/// Cameras that go once around the middle of `points`, from `azimuth` on towards +x, all at the distance above.
inline std::vector<camera> orbit_cameras(std::span<glm::vec3 const> points, float azimuth, float elevation,
                                         float vertical_fov, float aspect, std::size_t frames) {
    auto const box = bounds_of(points);
    auto const distance = orbit_distance(points, box.centre(), elevation, vertical_fov, aspect);
    std::vector<camera> cameras;
    for (std::size_t i = 0; i < frames; ++i) {
        auto const turn = static_cast<float>(i) / static_cast<float>(frames);
        auto const direction = view_direction(azimuth + 2 * std::numbers::pi_v<float> * turn, elevation);
        cameras.push_back(look_at(box.centre() - distance * direction, box.centre(), vertical_fov));
        cameras.back().near_distance = 1e-3f * box.radius();
    }
    return cameras;
}

/// The file's camera, whose node's space goes to the world by `to_world`. The vertical angle is the file's where the
/// image is at least as wide as the file's, else it is widened so that the file's whole width stays in view. Throws
/// value_error at a camera that cannot see.
inline camera file_camera(aiCamera const& source, glm::mat4 const& to_world, float aspect, float near_distance) {
    auto const position = glm::vec3(to_world * glm::vec4(to_glm(source.mPosition), 1));
    auto const direction = glm::mat3(to_world) * to_glm(source.mLookAt);
    auto const up = glm::mat3(to_world) * to_glm(source.mUp);
    auto const narrower = source.mAspect > 0 ? std::min(source.mAspect, aspect) : aspect;
    auto const vertical_fov = 2 * std::atan(std::tan(source.mHorizontalFOV / 2) / narrower);
    auto eye = look_at(position, position + glm::normalize(direction), vertical_fov, glm::normalize(up));
    eye.near_distance = near_distance;
    return eye;
}

/// How many of the points lie within the image, in front of the eye.
inline std::size_t count_seen(camera const& eye, std::span<glm::vec3 const> points, float aspect) {
    auto const t_y = std::tan(eye.vertical_fov / 2);
    return static_cast<std::size_t>(std::count_if(points.begin(), points.end(), [&](glm::vec3 const& point) {
        auto const p = glm::vec3(eye.view * glm::vec4(point, 1));
        return -p.z > eye.near_distance && std::abs(p.y) <= -p.z * t_y && std::abs(p.x) <= -p.z * t_y * aspect;
    }));
}

/// A model that fills less of a picture is not what the picture is of.
inline constexpr double least_filled_share = 0.02;

/// Share of the image, in [0, 1], that the upright rectangle around the points in front of the eye fills.
inline double filled_share(camera const& eye, std::span<glm::vec3 const> points, float aspect) {
    auto const t_y = std::tan(eye.vertical_fov / 2);
    glm::vec2 low(1), high(-1);
    for (auto const& point : points) {
        auto const p = glm::vec3(eye.view * glm::vec4(point, 1));
        if (-p.z > eye.near_distance) {
            glm::vec2 const at(p.x / (-p.z * t_y * aspect), p.y / (-p.z * t_y));
            low = glm::min(low, glm::clamp(at, -1.0f, 1.0f));
            high = glm::max(high, glm::clamp(at, -1.0f, 1.0f));
        }
    }
    auto const extent = glm::max(high - low, glm::vec2(0));
    return static_cast<double>(extent.x * extent.y / 4);
}

} // namespace genrender::examples
