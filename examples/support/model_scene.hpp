// SPDX-License-Identifier: MIT
// [GR sec. 3] What a reader of model files hands out: meshes that move, the animations that move them, and cameras.
#pragma once

#include "model_report.hpp"

#include <genrender/scene/animation.hpp>
#include <genrender/scene/camera.hpp>

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace genrender::examples {

/// One animation of a file.
struct model_take {
    std::string name;
    double begin = 0;                 ///< first key, seconds
    double end = 0;                   ///< last key, seconds; `begin` if it moves nothing
    std::vector<std::string> targets; ///< what it moves, each once and sorted: nodes, and meshes by their morph weights
};

/// One camera of a file.
struct model_lens {
    std::string name;
    bool is_orthographic = false; ///< it has no eye, so it cannot be rendered from
    float aspect = 0;             ///< width / height of its picture; 0 if the file does not say
};

/// A model file, read. Everything is in one world with y upwards; v is 0 at the texture's top.
class model_scene {
public:
    virtual ~model_scene() = default;

    /// The file's animations in its order.
    virtual std::vector<model_take> const& takes() const = 0;
    /// The file's cameras in its order.
    virtual std::vector<model_lens> const& lenses() const = 0;
    /// The mesh instances in the order of the file's nodes; object_index i is the i-th.
    virtual std::vector<model_object_report> const& objects() const = 0;
    /// Frames a second that the file says its author worked in; 24 where it says nothing.
    virtual double frames_per_second() const { return 24; }
    /// What is worth knowing about the reading, as sentences.
    virtual std::vector<std::string> const& notes() const = 0;

    /// Plays these takes together from now on, which are indices of takes(); none: everything is at rest.
    virtual void play(std::span<std::size_t const> takes) = 0;
    /// Every instance at a time in seconds.
    virtual std::vector<posed_object> objects_at(double seconds) const = 0;
    /// The eye of a lens that is not orthographic at a time in seconds, for an image of `aspect` = width / height. The
    /// vertical angle is the file's where the image is at least as wide as the file's, else it is widened so that the
    /// file's whole width stays in view. Throws value_error at a camera that cannot see.
    virtual camera eye_at(std::size_t lens, double seconds, float aspect, float near_distance) const = 0;
};

} // namespace genrender::examples
