// SPDX-License-Identifier: MIT
// A jointed figure: one mesh of round parts, each with its own chart, a skeleton, and the weights between them.
#pragma once

#include <genrender/scene/mesh.hpp>
#include <genrender/scene/primitives.hpp>
#include <genrender/scene/skinning.hpp>

#include <glm/common.hpp>
#include <glm/ext/matrix_transform.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <vector>

namespace genrender::scenes {

/// Joints of the figure; those of the right side follow those of the left by `right_side`.
enum joint : std::uint32_t {
    pelvis,
    spine,
    chest,
    neck,
    upper_arm,
    forearm,
    hand,
    thigh,
    shin,
    foot,
    joint_count = 16
};
inline constexpr std::uint32_t right_side = 6;

/// A figure of 1.75 units that stands on y = 0, faces +z and has its left at +x.
struct mannequin {
    mesh surface;
    std::vector<joint_weights> weights; ///< one for each vertex
    skeleton bones;
    std::vector<glm::mat4> bind; ///< inverse bind of the bones
};

namespace detail {

/// A joint and the height at which its influence ends and the next one's begins, softened over `softness` on both
/// sides.
struct joint_span {
    std::uint32_t joint;
    float lower_end;
    float softness;
};

/// Weights of a vertex at height y on a limb whose joints follow each other downwards.
inline joint_weights weights_along(float y, std::initializer_list<joint_span> limb) {
    joint_weights result;
    auto rest = 1.0f;
    int place = 0;
    for (auto const& span : limb) {
        auto const share = glm::smoothstep(span.lower_end - span.softness, span.lower_end + span.softness, y);
        result.joints[place] = span.joint;
        result.weights[place] = rest * share;
        rest *= 1 - share;
        ++place;
    }
    return normalized({result})[0];
}

/// Points on a smooth curve through `points` (Catmull-Rom, four steps each); the distance from the axis stays at least
/// 0.
inline std::vector<glm::vec2> smooth_profile(std::vector<glm::vec2> const& points) {
    std::vector<glm::vec2> curve;
    for (std::size_t i = 0; i + 1 < points.size(); ++i) {
        auto const& p1 = points[i];
        auto const& p2 = points[i + 1];
        auto const p0 = i > 0 ? points[i - 1] : glm::vec2(-p2.x, p2.y);
        auto const p3 = i + 2 < points.size() ? points[i + 2] : glm::vec2(-p1.x, p1.y);
        for (int step = 0; step < 4; ++step) {
            auto const t = static_cast<float>(step) / 4;
            auto const p = 0.5f * (2.0f * p1 + t * (p2 - p0) + t * t * (2.0f * p0 - 5.0f * p1 + 4.0f * p2 - p3) +
                                   t * t * t * (3.0f * (p1 - p2) + p3 - p0));
            curve.push_back({step == 0 ? p1.x : std::max(p.x, 1e-4f), p.y});
        }
    }
    curve.push_back(points.back());
    return curve;
}

/// A part swept around y, stretched by `scale`, moved to `at`, its seam turned to the back, its chart put in the atlas.
inline mesh body_part(std::vector<glm::vec2> const& profile, glm::vec3 scale, glm::vec3 at, glm::vec2 lower,
                      glm::vec2 upper) {
    auto part = revolve(smooth_profile(profile), 40);
    part.normals.clear();
    for (auto& p : part.positions) {
        p = glm::vec3(-p.x, p.y, -p.z) * scale + at;
    }
    place_uvs(part, lower + 0.01f, upper - 0.01f);
    return part;
}

inline std::vector<glm::vec2> const& unit_circle_profile() {
    static std::vector<glm::vec2> const profile{{0, 1},          {0.5f, 0.866f},  {0.866f, 0.5f}, {1, 0},
                                                {0.866f, -0.5f}, {0.5f, -0.866f}, {0, -1}};
    return profile;
}

template <class Weights>
void add_part(mannequin& figure, mesh const& part, Weights const& weights_of) {
    append(figure.surface, part);
    for (auto const& p : part.positions) {
        figure.weights.push_back(weights_of(p.y));
    }
}

} // namespace detail

/// Makes the figure; always the same.
inline mannequin make_mannequin() {
    using detail::weights_along;
    mannequin figure;

    auto const add_joint = [&](std::optional<std::uint32_t> parent, glm::vec3 from_parent) {
        figure.bones.parents.push_back(parent);
        figure.bones.rest.push_back(glm::translate(glm::mat4(1), from_parent));
    };
    add_joint(std::nullopt, {0, 0.95f, 0});
    add_joint(pelvis, {0, 0.13f, 0});
    add_joint(spine, {0, 0.17f, 0});
    add_joint(chest, {0, 0.25f, 0});
    for (auto const side : {1.0f, -1.0f}) {
        auto const first = side > 0 ? 0 : right_side;
        add_joint(chest, {0.195f * side, 0.165f, 0});
        add_joint(upper_arm + first, {0, -0.28f, 0});
        add_joint(forearm + first, {0, -0.25f, 0});
        add_joint(pelvis, {0.092f * side, -0.03f, 0});
        add_joint(thigh + first, {0, -0.42f, 0});
        add_joint(shin + first, {0, -0.41f, 0});
    }
    figure.bind = inverse_bind(figure.bones);

    detail::add_part(figure,
                     detail::body_part({{0, 1.585f},
                                        {0.05f, 1.575f},
                                        {0.054f, 1.51f},
                                        {0.075f, 1.475f},
                                        {0.145f, 1.445f},
                                        {0.182f, 1.39f},
                                        {0.18f, 1.31f},
                                        {0.165f, 1.22f},
                                        {0.142f, 1.11f},
                                        {0.142f, 1.05f},
                                        {0.165f, 0.96f},
                                        {0.17f, 0.90f},
                                        {0.13f, 0.83f},
                                        {0, 0.80f}},
                                       {1.06f, 1, 0.72f}, {0, 0, 0}, {0, 0}, {0.5f, 0.5f}),
                     [](float y) {
                         return weights_along(
                             y,
                             {{neck, 1.5f, 0.05f}, {chest, 1.25f, 0.08f}, {spine, 1.06f, 0.08f}, {pelvis, -1, 0.1f}});
                     });
    detail::add_part(figure,
                     detail::body_part(detail::unit_circle_profile(), {0.09f, 0.125f, 0.107f}, {0, 1.645f, 0.018f},
                                       {0.4f, 0.5f}, {0.8f, 0.8f}),
                     [](float) {
                         return joint_weights{glm::uvec4(neck), {1, 0, 0, 0}};
                     });
    for (auto const side : {1.0f, -1.0f}) {
        auto const first = side > 0 ? 0 : right_side;
        auto const column = side > 0 ? 0.0f : 1.0f;
        auto const arm = [first](float y) {
            return weights_along(
                y, {{upper_arm + first, 1.135f, 0.05f}, {forearm + first, 0.885f, 0.025f}, {hand + first, -1, 0.1f}});
        };
        auto const leg = [first](float y) {
            return weights_along(
                y, {{thigh + first, 0.5f, 0.06f}, {shin + first, 0.09f, 0.035f}, {foot + first, -1, 0.1f}});
        };
        detail::add_part(figure,
                         detail::body_part({{0, 1.485f},
                                            {0.046f, 1.465f},
                                            {0.062f, 1.41f},
                                            {0.054f, 1.3f},
                                            {0.045f, 1.18f},
                                            {0.041f, 1.135f},
                                            {0.044f, 1.08f},
                                            {0.038f, 0.99f},
                                            {0.027f, 0.89f},
                                            {0, 0.86f}},
                                           {1.05f, 1, 1.1f}, {0.195f * side, 0, 0}, {0.2f * column, 0.5f},
                                           {0.2f * column + 0.2f, 1}),
                         arm);
        detail::add_part(figure,
                         detail::body_part(detail::unit_circle_profile(), {0.023f, 0.095f, 0.043f},
                                           {0.195f * side, 0.80f, 0.005f}, {0.8f, 0.5f + 0.25f * column},
                                           {1, 0.75f + 0.25f * column}),
                         arm);
        detail::add_part(figure,
                         detail::body_part({{0, 0.965f},
                                            {0.066f, 0.95f},
                                            {0.09f, 0.88f},
                                            {0.086f, 0.77f},
                                            {0.07f, 0.62f},
                                            {0.056f, 0.52f},
                                            {0.054f, 0.46f},
                                            {0.06f, 0.37f},
                                            {0.05f, 0.26f},
                                            {0.036f, 0.14f},
                                            {0.04f, 0.08f},
                                            {0, 0.04f}},
                                           {1.12f, 1, 1.2f}, {0.092f * side, 0, 0}, {0.5f + 0.25f * column, 0},
                                           {0.75f + 0.25f * column, 0.5f}),
                         leg);
        auto shoe =
            detail::body_part(detail::unit_circle_profile(), {0.05f, 0.06f, 0.138f}, {0.092f * side, 0.04f, 0.065f},
                              {0.4f + 0.2f * column, 0.8f}, {0.6f + 0.2f * column, 1});
        for (auto& p : shoe.positions) {
            p.y = std::max(p.y, 0.0f); // a flat sole to stand on
        }
        detail::add_part(figure, shoe, [first](float) {
            return joint_weights{glm::uvec4(foot + first), {1, 0, 0, 0}};
        });
    }
    return figure;
}

} // namespace genrender::scenes
