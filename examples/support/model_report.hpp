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
    bool has_made_uvs = false;   ///< the file has none, or none that can be used, or new ones were asked for
    std::size_t uvs_outside = 0; ///< vertices with u or v outside [0, 1]
    uv_overlap overlap{};        ///< over a texture of 512 x 512 texels; load_model counts it

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
    bool asked_for_uvs = false;               ///< new texture coordinates were asked for
};

namespace detail {

/// A count with commas between thousands.
inline std::string grouped(std::size_t count) {
    auto text = std::to_string(count);
    for (auto at = static_cast<std::ptrdiff_t>(text.size()) - 3; at > 0; at -= 3) {
        text.insert(static_cast<std::size_t>(at), ",");
    }
    return text;
}

/// `1 joint`, `12,000 joints`.
inline std::string counted(std::size_t count, std::string const& noun) {
    return grouped(count) + " " + noun + (count == 1 ? "" : "s");
}

/// What is said of the objects that `is_meant` holds for: `2 objects have` and `(A, B)`, of at most three names.
struct named_objects {
    std::size_t count = 0;
    std::string have;
    std::string names;

    template <class Predicate>
    named_objects(std::vector<model_object_report> const& objects, Predicate const& is_meant) {
        constexpr std::size_t most_names = 3;
        for (auto const& object : objects) {
            if (is_meant(object) && ++count <= most_names) {
                names += (count > 1 ? ", " : "") + object.name;
            }
        }
        have = counted(count, "object") + (count == 1 ? " has" : " have");
        names = "(" + names + (count > most_names ? " and " + grouped(count - most_names) + " more" : "") + ")";
    }
};

/// Triangles, joints and morph targets of all objects.
inline std::string contents_of(std::vector<model_object_report> const& objects) {
    std::size_t triangles = 0, joints = 0, morph_targets = 0;
    for (auto const& object : objects) {
        triangles += object.triangles;
        joints = std::max(joints, object.joints); // objects of one skeleton share them
        morph_targets += object.morph_targets;
    }
    auto text = objects.size() == 1 ? objects.front().name + ": " : counted(objects.size(), "object") + " of ";
    text += counted(triangles, "triangle");
    if (joints > 0) {
        text += (objects.size() == 1 ? ", " : ", up to ") + counted(joints, "joint");
    }
    if (morph_targets > 0) {
        text += ", " + counted(morph_targets, "morph target");
    }
    return text + ".";
}

} // namespace detail

/// The whole report: first what was chosen and read, then what the model consists of, then a line for each kind of
/// trouble with its texture coordinates.
inline std::vector<std::string> lines_of(model_report const& report) {
    auto lines = report.notes;
    if (report.objects.empty()) {
        return lines;
    }
    lines.push_back(detail::contents_of(report.objects));
    detail::named_objects const without(
        report.objects, [&](auto const& object) { return object.has_made_uvs && !report.asked_for_uvs; });
    if (without.count > 0) {
        lines.push_back(without.have + " no usable UVs " + without.names + ": an atlas of the triangles was made.");
    }
    detail::named_objects const outside(
        report.objects, [](auto const& object) { return !object.has_made_uvs && object.uvs_outside > 0; });
    if (outside.count > 0) {
        lines.push_back(outside.have + " UVs outside [0, 1] " + outside.names +
                        ": where texels are used the texture repeats there.");
    }
    auto most = 0.0;
    detail::named_objects const overlapping(report.objects, [&](auto const& object) {
        auto const share = object.has_made_uvs ? 0 : object.overlapping_share();
        most = std::max(most, share);
        return share > 0.01;
    });
    if (overlapping.count > 0) {
        char share[16];
        std::snprintf(share, sizeof share, "%.0f %%", 100 * most);
        lines.push_back(overlapping.have + " texels that belong to several places " + overlapping.names + ", up to " +
                        share + ": those places look alike; --atlas tells them apart.");
    }
    return lines;
}

} // namespace genrender::examples
