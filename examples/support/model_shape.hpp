// SPDX-License-Identifier: MIT
// One mesh of a model file, ready to be posed: its surface, the joints and morph targets that move its vertices.
#pragma once

#include "model_report.hpp"
#include "triangle_atlas.hpp"

#include <genrender/core/error.hpp>
#include <genrender/core/index.hpp>
#include <genrender/scene/animation.hpp>
#include <genrender/scene/mesh.hpp>
#include <genrender/scene/skinning.hpp>

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace genrender::examples {

/// Which texture coordinates a model gets.
enum class model_uvs {
    from_file, ///< a set of the file's; a mesh without it gets an atlas
    atlas      ///< an atlas of its triangles for every mesh: nothing overlaps
};

/// What a reader found of one mesh, as the file has it.
struct model_arrays {
    mesh surface;                                      ///< `uvs` is empty where the file has none that are wanted
    std::vector<joint_weights> weights;                ///< one a vertex, of any sum; empty without joints
    std::size_t joints = 0;                            ///< how many joints there are for the weights to name
    std::vector<std::vector<glm::vec3>> morph_offsets; ///< [targets][vertices], from the surface's positions
};

/// Lets the vertex follow the joint too if it is one of its four heaviest.
inline void add_weight(joint_weights& vertex, std::uint32_t joint, float weight) {
    int lightest = 0;
    for (int k = 1; k < 4; ++k) {
        lightest = vertex.weights[k] < vertex.weights[lightest] ? k : lightest;
    }
    if (weight > vertex.weights[lightest]) {
        vertex.weights[lightest] = weight;
        vertex.joints[lightest] = joint;
    }
}

/// A mesh whose positions follow v' = sum_j w_j G_j B_j (v + sum_k m_k d_k): m the morph weights, d the targets'
/// offsets, G the joints' nodes, B the inverse binds; without joints G is the mesh's own node. Instances share it.
class model_shape {
public:
    /// Throws file_error that begins with `path` and names `name` if positions are not finite or triangles name
    /// vertices that do not exist.
    model_shape(std::string const& path, std::string name, model_arrays arrays)
        : joints_(arrays.joints), joint_weights_(std::move(arrays.weights)),
          morph_offsets_(std::move(arrays.morph_offsets)) {
        report_.name = name.empty() ? "unnamed" : std::move(name);
        auto& surface = arrays.surface;
        check(path, surface);
        hold_free_vertices();
        report_.joints = joints_;
        report_.morph_targets = morph_offsets_.size();
        report_.has_made_uvs = surface.uvs.size() != surface.positions.size() ||
                               !std::all_of(surface.uvs.begin(), surface.uvs.end(),
                                            [](glm::vec2 uv) { return genrender::detail::is_finite(uv); });
        if (report_.has_made_uvs) {
            surface.uvs.assign(surface.positions.size(), {});
            auto atlas = make_triangle_atlas(surface);
            surface = std::move(atlas.surface);
            rearrange(atlas.source);
        }
        count(surface);
        surface_ = std::make_shared<mesh const>(std::move(surface));
    }

    /// About an object of this shape; its name is that of the first.
    model_object_report const& report() const { return report_; }
    bool has_joints() const { return !joint_weights_.empty(); }

    /// As a rigid object at a node, with one weight a morph target; targets without a weight are left out.
    posed_object at(object_index object, std::span<float const> morph_weights, glm::mat4 const& to_world) const {
        return {object, surface_, transformed(morphed(morph_weights), to_world)};
    }

    /// With its joints' spaces at `joints_to_world` and what takes the rest pose to them, `bind`. Both have one more
    /// element, at the end, for the vertices that no joint holds.
    posed_object at(object_index object, std::span<float const> morph_weights,
                    std::span<glm::mat4 const> joints_to_world, std::span<glm::mat4 const> bind) const {
        return {object, surface_, skin(morphed(morph_weights), joint_weights_, joints_to_world, bind)};
    }

private:
    void check(std::string const& path, mesh const& surface) const {
        for (std::size_t i = 0; i < surface.positions.size(); ++i) {
            if (!genrender::detail::is_finite(surface.positions[i])) {
                throw file_error(path + ": vertex " + std::to_string(i) + " of " + report_.name +
                                 " is not finite, expected coordinates");
            }
        }
        for (std::size_t i = 0; i < surface.triangles.size(); ++i) {
            auto const& t = surface.triangles[i];
            if (std::max({t.x, t.y, t.z}) >= surface.positions.size()) {
                throw file_error(path + ": triangle " + std::to_string(i) + " of " + report_.name + " is " +
                                 extents_text({t.x, t.y, t.z}) + ", expected vertices below " +
                                 std::to_string(surface.positions.size()));
            }
        }
    }

    void hold_free_vertices() {
        auto const own = static_cast<std::uint32_t>(joints_);
        for (auto& vertex : joint_weights_) {
            if (vertex.weights == glm::vec4(0)) {
                add_weight(vertex, own, 1);
            }
        }
        joint_weights_ = normalized(std::move(joint_weights_));
    }

    void rearrange(std::span<std::uint32_t const> source) {
        auto const rearranged = [&](auto const& given) {
            std::remove_cvref_t<decltype(given)> result;
            for (auto const vertex : source) {
                result.push_back(given[vertex]);
            }
            return result;
        };
        if (!joint_weights_.empty()) {
            joint_weights_ = rearranged(joint_weights_);
        }
        for (auto& offsets : morph_offsets_) {
            offsets = rearranged(offsets);
        }
    }

    void count(mesh const& surface) {
        report_.vertices = surface.positions.size();
        report_.triangles = surface.triangles.size();
        for (auto const& uv : surface.uvs) {
            report_.uvs_outside += uv.x < 0 || uv.x > 1 || uv.y < 0 || uv.y > 1;
        }
    }

    std::vector<glm::vec3> morphed(std::span<float const> weights) const {
        auto positions = surface_->positions;
        for (std::size_t target = 0; target < std::min(weights.size(), morph_offsets_.size()); ++target) {
            for (std::size_t i = 0; weights[target] != 0 && i < positions.size(); ++i) {
                positions[i] += weights[target] * morph_offsets_[target][i];
            }
        }
        return positions;
    }

    model_object_report report_;
    std::shared_ptr<mesh const> surface_;
    std::size_t joints_;
    std::vector<joint_weights> joint_weights_;          ///< one a vertex; empty without joints
    std::vector<std::vector<glm::vec3>> morph_offsets_; ///< [targets][vertices]
};

} // namespace genrender::examples
