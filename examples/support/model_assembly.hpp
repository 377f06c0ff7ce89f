// SPDX-License-Identifier: MIT
// What of a model file is used, whoever reads it.
#pragma once

#include "model_shape.hpp"

#include <glm/ext/matrix_transform.hpp>
#include <glm/mat4x4.hpp>

#include <cstddef>
#include <numbers>

namespace genrender::examples {

/// The axis that points upwards in a file.
enum class model_up {
    from_file, ///< what the file says, y if it says nothing
    y,
    z
};

/// What of a file is used.
struct model_assembly {
    model_uvs uvs = model_uvs::from_file;
    std::size_t uv_set = 0;
    model_up up = model_up::from_file;
};

/// Turns a world whose z axis points upwards so that y does.
inline glm::mat4 z_up_to_y_up() { return glm::rotate(glm::mat4(1), -std::numbers::pi_v<float> / 2, {1, 0, 0}); }

} // namespace genrender::examples
