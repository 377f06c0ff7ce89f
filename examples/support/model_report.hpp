// SPDX-License-Identifier: MIT
// What a loaded model consists of, and what about its texture coordinates a user should know, as numbers and as text.
#pragma once

#include <genrender/scene/mesh.hpp>
#include <genrender/scene/uv_overlap.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdio>
#include <string>
#include <vector>

namespace genrender::examples {

/// One object of a model: one mesh at one node.
struct model_object_report {
    std::string name;
    std::size_t vertices = 0;
    std::size_t triangles = 0;
    std::size_t joints = 0; ///< that move its vertices
    std::size_t morph_targets = 0;
    bool has_made_uvs = false;   ///< the file has none, or none that can be used, or was asked for new ones
    std::size_t uvs_outside = 0; ///< vertices with u or v outside [0, 1]
    uv_overlap overlap{};        ///< over a texture of 512 x 512 texels

    /// Share of the used texels that several places of the surface claim, in [0, 1].
    double overlapping_share() const {
        return static_cast<double>(overlap.overlapping) /
               static_cast<double>(std::max<std::size_t>(overlap.covered, 1));
    }
};

/// All about a model that its loader noticed.
struct model_report {
    std::vector<model_object_report> objects; ///< object_index i is objects[i]
    std::string animation;                    ///< name of the animation that is played; empty without one
    double seconds = 0;                       ///< its length
    std::vector<std::string> notes;           ///< sentences
};

/// One line of text for an object.
inline std::string text_of(model_object_report const& object) {
    std::string text = object.name + ": " + std::to_string(object.triangles) + " triangles";
    if (object.joints > 0) {
        text += ", " + std::to_string(object.joints) + " joints";
    }
    if (object.morph_targets > 0) {
        text += ", " + std::to_string(object.morph_targets) + " morph targets";
    }
    if (object.has_made_uvs) {
        return text + "; no usable UVs in the file: an atlas of its triangles was made";
    }
    if (object.uvs_outside > 0) {
        text += "; " + std::to_string(object.uvs_outside) + " of " + std::to_string(object.vertices) +
                " UVs lie outside [0, 1]: wrap the UV maps";
    }
    if (object.overlapping_share() > 0.01) {
        char share[16];
        std::snprintf(share, sizeof share, "%.0f %%", 100 * object.overlapping_share());
        text += std::string("; ") + share +
                " of its texels belong to several places, which will look alike (an atlas would not)";
    }
    return text;
}

/// The whole report, a line an object and a line a note.
inline std::vector<std::string> lines_of(model_report const& report) {
    std::vector<std::string> lines;
    for (auto const& object : report.objects) {
        lines.push_back(text_of(object));
    }
    lines.insert(lines.end(), report.notes.begin(), report.notes.end());
    return lines;
}

} // namespace genrender::examples
