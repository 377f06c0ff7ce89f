// SPDX-License-Identifier: MIT
// The built-in animated scenes by their names.
#pragma once

#include "bouncing_balls.hpp"
#include "camera_rotation.hpp"
#include "walking_figure.hpp"

#include <genrender/core/error.hpp>
#include <genrender/scene/animation.hpp>

#include <array>
#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

namespace genrender::scenes {

/// Any animation behind one type: what a program holds when a user chooses the scene by name. A model of animation.
class any_animation {
public:
    template <animation Animation>
    explicit any_animation(Animation scene) : frame_count_(scene.frame_count()) {
        // Shared, because std::function copies what it holds and a scene may be large.
        frame_ = [shared = std::make_shared<Animation const>(std::move(scene))](frame_index i) {
            return shared->frame(i);
        };
    }

    std::size_t frame_count() const { return frame_count_; }
    posed_scene frame(frame_index i) const { return frame_(i); }

private:
    std::size_t frame_count_;
    std::function<posed_scene(frame_index)> frame_;
};

/// What make_scene knows.
inline constexpr std::array<std::string_view, 3> names{"camera_rotation", "bouncing_balls", "walking_figure"};

/// The built-in scene of that name in `frame_count` frames. Throws value_error at any other name and at 0 frames.
inline any_animation make_scene(std::string_view name, std::size_t frame_count) {
    require_value(frame_count > 0, "make_scene", "frame_count", frame_count, "at least 1");
    if (name == "camera_rotation") {
        return any_animation(camera_rotation(frame_count));
    }
    if (name == "bouncing_balls") {
        return any_animation(bouncing_balls(frame_count));
    }
    require_value(name == "walking_figure", "make_scene", "name", std::string(name),
                  "camera_rotation, bouncing_balls or walking_figure");
    return any_animation(walking_figure(frame_count));
}

} // namespace genrender::scenes
