// SPDX-License-Identifier: MIT
// Your own correspondence in place of the library's: points of a rolling ball in its rest pose, without any texture.
#include <genrender/maps/uv_maps.hpp>
#include <genrender/reference/stable_diffusion.hpp>
#include <genrender/pipeline/render.hpp>

#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/trigonometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <cmath>
#include <cstdio>
#include <exception>
#include <numbers>

using namespace genrender;

using namespace genrender::reference;

// The scene in a formula: a ball that rolls over the picture [-1, 1]^2 and turns to the viewer, who looks along -z.
struct rolling_ball {
    static constexpr float radius = 0.7f;
    std::size_t frames;

    float time(frame_index i) const { return static_cast<float>(i.value) / static_cast<float>(frames - 1); }
    glm::vec2 centre(frame_index i) const { return {0.5f * time(i) - 0.25f, 0}; }
    glm::mat3 turn(frame_index i) const {
        auto const rolled = glm::rotate(glm::mat4(1), -0.5f / radius * time(i), glm::vec3(0, 0, 1));
        return glm::mat3(glm::rotate(rolled, 1.2f - 1.2f * time(i), glm::vec3(1, 0, 0)));
    }

    // The point of the unit ball at rest that is seen at `at`; none beside the ball.
    std::optional<glm::vec3> seen_at(frame_index i, glm::vec2 at) const {
        auto const on_ball = (at - centre(i)) / radius;
        auto const depth = 1 - glm::dot(on_ball, on_ball);
        return depth > 0 ? std::optional(glm::transpose(turn(i)) * glm::vec3(on_ball, std::sqrt(depth))) : std::nullopt;
    }
    // Where a point of the ball at rest is seen; none if it is on the far side. The rim belongs to the near side.
    std::optional<glm::vec2> place_of(frame_index i, glm::vec3 point) const {
        auto const turned = turn(i) * point;
        return turned.z > -1e-4f ? std::optional(centre(i) + radius * glm::vec2(turned)) : std::nullopt;
    }
};

// Picture coordinates of the centre of a cell, row 0 on top.
glm::vec2 centre_of(grid_extents grid, std::size_t row, std::size_t column) {
    return {2 * (static_cast<float>(column) + 0.5f) / static_cast<float>(grid.width) - 1,
            1 - 2 * (static_cast<float>(row) + 0.5f) / static_cast<float>(grid.height)};
}

// The user's model of correspondence_map. A surface point is what the scene says it is: here a place on the ball at
// rest.
// docs:begin rest_pose_map
struct rest_pose_map {
    using point_type = glm::vec3;
    rolling_ball ball;
    grid_extents extents;

    std::size_t frame_count() const { return ball.frames; }
    grid_extents grid() const { return extents; }
    std::optional<glm::vec3> point_at(frame_index i, token_index t) const {
        return ball.seen_at(i, centre_of(extents, t.value / extents.width, t.value % extents.width));
    }
    std::optional<token_index> token_at(frame_index i, glm::vec3 const& point) const {
        auto const at = ball.place_of(i, point);
        if (!at || std::abs(at->x) >= 1 || std::abs(at->y) >= 1) {
            return std::nullopt;
        }
        auto const row = static_cast<std::uint32_t>((1 - at->y) / 2 * static_cast<float>(extents.height));
        auto const column = static_cast<std::uint32_t>((1 + at->x) / 2 * static_cast<float>(extents.width));
        return token_index{row * static_cast<std::uint32_t>(extents.width) + column};
    }
};
static_assert(correspondence_map<rest_pose_map>);
// docs:end

int main() try {
    // What a renderer would draw: UVs as on a globe, pinched at the poles, and how near the ball is.
    rolling_ball const ball{4};
    grid_extents const pixels{128, 128};
    uv_maps maps(ball.frames, pixels);
    auto nearness = tensor<float, 3>::from_shape(maps.coverage.shape());
    nearness.fill(0);
    for (std::uint32_t i = 0; i < ball.frames; ++i) {
        for (std::size_t p = 0; p < pixels.size(); ++p) {
            auto const at = centre_of(pixels, p / pixels.width, p % pixels.width);
            if (auto const point = ball.seen_at({i}, at)) {
                auto const pi = std::numbers::pi_v<float>;
                maps.uv(i, p / pixels.width, p % pixels.width, 0) = std::atan2(point->x, point->z) / (2 * pi) + 0.5f;
                maps.uv(i, p / pixels.width, p % pixels.width, 1) = std::acos(glm::clamp(point->y, -1.0f, 1.0f)) / pi;
                maps.coverage(i, p / pixels.width, p % pixels.width) = 1;
                nearness(i, p / pixels.width, p % pixels.width) = (ball.turn({i}) * *point).z;
            }
        }
    }
    auto const UV = to_uv_view(maps);

    // Noise still comes from the UV maps; every feature resolution gets a map from `make_map`.
    stable_diffusion<float> const pipeline{pipeline_files(GENRENDER_MINIATURE "/weights")};
    auto const network =
        pipeline.network(pipeline.conditioning(to_view(nearness), {.text = "a red dotted ball", .guidance_scale = 1}));
    render_settings<float> settings;
    settings.steps = 2;
    settings.keyframes.count = 2;
    // docs:begin own_correspondence
    auto const make_map = [&](grid_extents grid) { return rest_pose_map{ball, grid}; };
    auto const by_rest_pose =
        render<generative_rendering, rest_pose_map>(network, UV, {.settings = settings, .make_map = make_map});
    auto const by_footprints = render(network, UV, {.settings = settings});
    // docs:end

    std::printf("Tokens of the ball that some keyframe shows, too:\n  feature map   rest pose   footprints\n");
    for (auto const& [grid, count] : by_rest_pose.report.coverage) {
        auto const footprints = by_footprints.report.coverage.at(grid);
        std::printf("  %3zu x %-3zu    %8.1f %%   %8.1f %%\n", grid.height, grid.width, 100 * count.share(),
                    100 * footprints.share());
        require_value(count.share() > 0.8, "your_own_correspondence", "coverage", count.share(), "above 0.8");
    }
} catch (std::exception const& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
}
