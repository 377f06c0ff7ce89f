// SPDX-License-Identifier: MIT
// Animations that settings are chosen on: still scenes of the miniature's small world, set in motion.
#pragma once

#include "caption.hpp"

#include <examples/miniature/world_scene.hpp>
#include <examples/miniature/world_shapes.hpp>

#include <genrender/core/error.hpp>
#include <genrender/core/index.hpp>
#include <genrender/scene/animation.hpp>

#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>
#include <glm/mat4x4.hpp>
#include <glm/trigonometric.hpp>
#include <glm/vec3.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace genrender::examples {

/// The names of development scenes.
inline constexpr std::array<std::string_view, 3> development_names{"turning_thing", "circled_pair", "hopping_things"};

/// The seed that development scenes are drawn by; training has 1, and 2 for what it holds out.
inline constexpr std::uint64_t development_seed = 90210;

/// One thing that tumbles in the air, two things that the camera goes around, or three and more that hop and turn: the
/// first scene of that many things, on a ground and under a sky, without figures, whose limbs share one texture, so that
/// their correspondences are not known. A model of animation.
class development_world {
public:
    /// Throws value_error for a name that is not in development_names.
    development_world(std::string_view name, std::size_t frames) : name_(name), frames_(frames) {
        auto const number = std::find(development_names.begin(), development_names.end(), name);
        require_value(number != development_names.end(), "development_world", "name", name_,
                      "turning_thing, circled_pair or hopping_things");
        auto const wanted = static_cast<std::size_t>(number - development_names.begin()) + 1;
        for (std::uint32_t k = 0;; ++k) {
            world_ = miniature::draw_world(development_seed, k, miniature::picture_set::training);
            auto const& of = world_.description;
            auto const count = of.shapes.size();
            auto const has_figures =
                std::find(of.shapes.begin(), of.shapes.end(), miniature::world_shape::figure) != of.shapes.end();
            if (of.has_ground && !of.is_room() && !has_figures && (count == wanted || (wanted == 3 && count > 3))) {
                break;
            }
        }
    }

    std::size_t frame_count() const { return frames_; }

    posed_scene frame(frame_index i) const {
        auto posed = world_.scene;
        auto const t = static_cast<float>(i.value);
        if (name_ == "circled_pair") {
            posed.camera.view *= turned(world_.target, glm::radians(4.0f) * t, upright);
            return posed;
        }
        for (auto& thing : posed.objects) {
            if (thing.object.value == 0) {
                continue;
            }
            // Not upright, or bands around a thing would stay where they are.
            auto const axis = glm::normalize(glm::vec3(1, 2, 0.5f));
            auto motion = turned(middle_of(thing.positions), glm::radians(6.0f) * t, axis);
            if (name_ == "turning_thing") {
                motion = glm::translate(glm::mat4(1), {0, 0.4f, 0}) * motion;
            } else {
                auto const side = thing.object.value % 2 == 0 ? 1.0f : -1.0f;
                motion =
                    glm::translate(glm::mat4(1), {side * 0.04f * t, 0.5f * std::abs(std::sin(0.35f * t)), 0}) * motion;
            }
            thing.positions = transformed(std::move(thing.positions), motion);
        }
        return posed;
    }

    /// What a caption calls its things.
    subject_words subject() const {
        auto const& shapes = world_.description.shapes;
        return shapes.size() > 1
                   ? subject_words{"some", "things"}
                   : subject_words{"a", std::string(miniature::shape_words[static_cast<std::size_t>(shapes.front())])};
    }

    /// How patterns lie on the objects, by their numbers; number 0 is the ground.
    std::vector<miniature::pattern_layout> layouts() const {
        std::vector<miniature::pattern_layout> layouts{miniature::pattern_layout::flat};
        for (auto const shape : world_.description.shapes) {
            layouts.push_back(miniature::layout_of(shape));
        }
        return layouts;
    }

private:
    static constexpr glm::vec3 upright{0, 1, 0};

    /// A turn about an axis through a point.
    static glm::mat4 turned(glm::vec3 at, float angle, glm::vec3 axis) {
        return glm::translate(glm::rotate(glm::translate(glm::mat4(1), at), angle, axis), -at);
    }

    static glm::vec3 middle_of(std::vector<glm::vec3> const& positions) {
        auto lower = glm::vec3(std::numeric_limits<float>::max());
        auto upper = -lower;
        for (auto const& p : positions) {
            lower = glm::min(lower, p);
            upper = glm::max(upper, p);
        }
        return (lower + upper) * 0.5f;
    }

    std::string name_;
    std::size_t frames_;
    miniature::world_scene world_;
};

} // namespace genrender::examples
