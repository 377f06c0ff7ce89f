// SPDX-License-Identifier: MIT
// [GR sec. 3] A pinhole camera: where it stands, how wide it sees, and the ray through each pixel's centre.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/error.hpp>
#include <genrender/core/finite.hpp>
#include <genrender/core/index.hpp>
#include <genrender/scene/bounds.hpp>

#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace genrender {

/// A pinhole camera with square pixels. Camera space is right-handed: x right, y up, the view along -z.
struct camera {
    glm::mat4 view{1};           ///< world space to camera space, rigid
    float vertical_fov = 0.7f;   ///< angle between the bottom and the top of the image, radians, in (0, pi)
    float near_distance = 0.05f; ///< what is nearer than this along the view is not seen; > 0, scene units
};

/// Throws value_error if the camera cannot see: a view that is not finite, an angle outside (0, pi), a near distance
/// that is not finite and > 0. `function` begins the text.
inline void validate(camera const& eye, char const* function = "validate") {
    auto finite = true;
    for (int column = 0; column < 4; ++column) {
        for (int row = 0; row < 4; ++row) {
            finite = finite && is_finite(eye.view[column][row]);
        }
    }
    require_value(finite, function, "camera.view", "not finite", "a finite matrix");
    require_value(eye.vertical_fov > 0 && eye.vertical_fov < std::numbers::pi_v<float>, function, "camera.vertical_fov",
                  eye.vertical_fov, "an angle between 0 and pi");
    require_value(eye.near_distance > 0 && is_finite(eye.near_distance), function, "camera.near_distance",
                  eye.near_distance, "a finite distance above 0");
}

/// The camera at `position` that looks at `target` with `up` upwards in the image. Throws value_error if the view has
/// no direction (`target` at `position`) or lies along `up`.
inline camera look_at(glm::vec3 position, glm::vec3 target, float vertical_fov, glm::vec3 up = {0, 1, 0}) {
    auto const direction = target - position;
    require_value(glm::length(direction) > 0, "look_at", "target", "the camera's position", "another point");
    require_value(glm::length(glm::cross(direction, up)) > 1e-6f * glm::length(direction) * glm::length(up), "look_at",
                  "up", "along the view", "another direction");
    camera eye;
    eye.view = glm::lookAt(position, target, up);
    eye.vertical_fov = vertical_fov;
    validate(eye, "look_at");
    return eye;
}

/// The nearest camera that looks along `direction` at the middle of `box` and sees the whole sphere around the box in
/// an image of `aspect` = width / height. Throws value_error at a box of one point, and as look_at does.
inline camera fit_camera(bounds const& box, glm::vec3 direction, float vertical_fov, float aspect) {
    require_value(box.radius() > 0, "fit_camera", "box", "a single point", "an extent above 0");
    require_value(aspect > 0 && is_finite(aspect), "fit_camera", "aspect", aspect, "width / height above 0");
    require_value(glm::length(direction) > 0, "fit_camera", "direction", "zero", "a direction");
    // The sphere touches the narrower pair of the four planes that bound the view.
    auto const half_height = std::tan(vertical_fov * 0.5f);
    auto const half_angle = std::atan(half_height * std::min(1.0f, aspect));
    auto const distance = box.radius() / std::sin(half_angle);
    auto eye = look_at(box.centre() - glm::normalize(direction) * distance, box.centre(), vertical_fov);
    eye.near_distance = std::max(0.5f * (distance - box.radius()), 1e-3f * distance);
    return eye;
}

/// The camera's position in world space.
inline glm::vec3 position_of(camera const& eye) { return glm::vec3(glm::inverse(eye.view)[3]); }

/// The plane one unit in front of a camera, and where each pixel's centre lies on it: x to the right, y up. Point (x,
/// y) is seen along (x, y, -1) in camera space, whose multiple by the depth is the point seen.
class image_plane {
public:
    /// The plane of an image of `grid` pixels, row 0 on top.
    image_plane(camera const& eye, grid_extents grid)
        : half_height_(std::tan(static_cast<double>(eye.vertical_fov) * 0.5)),
          height_(static_cast<double>(grid.height)), width_(static_cast<double>(grid.width)) {}

    /// The centre of the pixel.
    glm::dvec2 centre_of(pixel p) const { return {x_of(p.column + 0.5), y_of(p.row + 0.5)}; }
    /// x of an image position `column`, in pixels from the left border.
    double x_of(double column) const { return (2 * column - width_) / height_ * half_height_; }
    /// y of an image position `row`, in pixels from the top border.
    double y_of(double row) const { return (height_ - 2 * row) / height_ * half_height_; }
    /// The inverse of x_of.
    double column_of(double x) const { return (x / half_height_ * height_ + width_) / 2; }
    /// The inverse of y_of.
    double row_of(double y) const { return (height_ - y / half_height_ * height_) / 2; }

private:
    double half_height_;
    double height_;
    double width_;
};

} // namespace genrender

#include <genrender/core/end_header.inl>
