// SPDX-License-Identifier: MIT
// One mesh of a model file at one node: its surface, and where its vertices are when the nodes have moved.
#pragma once

#include "model_nodes.hpp"
#include "model_report.hpp"
#include "triangle_atlas.hpp"

#include <genrender/core/error.hpp>
#include <genrender/scene/animation.hpp>
#include <genrender/scene/mesh.hpp>
#include <genrender/scene/skinning.hpp>
#include <genrender/scene/uv_overlap.hpp>

#include <assimp/mesh.h>
#include <assimp/scene.h>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace genrender::examples {

/// Which texture coordinates a model gets.
enum class model_uvs {
    from_file, ///< a set of the file's; a mesh without it gets an atlas
    atlas      ///< an atlas of its triangles for every mesh: nothing overlaps
};

/// A mesh at a node. Positions follow v' = sum_j w_j G_j B_j (v + sum_k m_k d_k): m the morph weights, d the targets'
/// offsets, G the joints' nodes, B the inverse binds; without joints G is the mesh's own node.
class model_part {
public:
    /// Throws file_error that begins with `path` if positions are not finite or triangles name vertices that do not
    /// exist.
    model_part(std::string const& path, aiMesh const& source, model_nodes const& nodes, std::size_t node, model_uvs uvs,
               std::size_t uv_set = 0)
        : node_(node), names_{nodes.node(node).mName.C_Str(), source.mName.C_Str()} {
        report_.name = nodes.node(node).mName.length > 0 ? nodes.node(node).mName.C_Str() : source.mName.C_Str();
        report_.name = report_.name.empty() ? "unnamed" : report_.name;
        auto surface = surface_of(path, source, uvs, uv_set);
        read_joints(source, nodes);
        read_morph_targets(source);
        if (report_.has_made_uvs) {
            auto atlas = make_triangle_atlas(surface);
            surface = std::move(atlas.surface);
            rearrange(atlas.source);
        }
        count(surface);
        surface_ = std::make_shared<mesh const>(std::move(surface));
    }

    model_object_report const& report() const { return report_; }

    /// Morphed by these animations from now on, by the last one that names its node or mesh.
    void play(std::span<aiAnimation const* const> animations) {
        morph_channel_ = nullptr;
        for (auto const* const animation : animations) {
            for (unsigned i = 0; i < animation->mNumMorphMeshChannels; ++i) {
                // Called after the node or the mesh, in some formats with a number behind a star
                std::string const full_name = animation->mMorphMeshChannels[i]->mName.C_Str();
                auto const name = full_name.substr(0, full_name.find('*'));
                if (name == names_[0] || name == names_[1]) {
                    morph_channel_ = animation->mMorphMeshChannels[i];
                    morph_ticks_per_second_ = ticks_per_second(*animation);
                }
            }
        }
    }

    /// The part with its nodes at `to_world`, at a time in seconds.
    posed_object at(object_index object, std::span<glm::mat4 const> to_world, double seconds) const {
        // Add the morph targets
        auto positions = surface_->positions;
        auto weights = morph_weights_;
        if (morph_channel_ != nullptr) {
            morph_weights_at(*morph_channel_, seconds * morph_ticks_per_second_, weights);
        }
        for (std::size_t target = 0; target < weights.size(); ++target) {
            for (std::size_t i = 0; weights[target] != 0 && i < positions.size(); ++i) {
                positions[i] += weights[target] * morph_offsets_[target][i];
            }
        }

        // Follow the joints, or the node
        if (joint_nodes_.empty()) {
            return {object, surface_, transformed(std::move(positions), to_world[node_])};
        }
        std::vector<glm::mat4> global;
        for (auto const joint : joint_nodes_) {
            global.push_back(to_world[joint]);
        }
        return {object, surface_, skin(positions, joint_weights_, global, bind_)};
    }

private:
    mesh surface_of(std::string const& path, aiMesh const& source, model_uvs uvs, std::size_t uv_set) {
        mesh surface;
        auto is_uv_usable = uvs == model_uvs::from_file && uv_set < AI_MAX_NUMBER_OF_TEXTURECOORDS &&
                            source.HasTextureCoords(static_cast<unsigned>(uv_set)) &&
                            source.mNumUVComponents[uv_set] >= 2;
        for (unsigned i = 0; i < source.mNumVertices; ++i) {
            surface.positions.push_back(to_glm(source.mVertices[i]));
            if (!is_place(surface.positions.back())) {
                throw file_error(path + ": vertex " + std::to_string(i) + " of " + report_.name +
                                 " is not finite, expected coordinates");
            }
            if (is_uv_usable) {
                auto const uv = to_glm(source.mTextureCoords[uv_set][i]);
                surface.uvs.push_back({uv.x, uv.y});
                is_uv_usable = is_place(uv);
            }
        }
        for (unsigned i = 0; i < source.mNumFaces; ++i) {
            auto const& face = source.mFaces[i];
            if (face.mNumIndices != 3) {
                continue; // points and lines have no surface
            }
            surface.triangles.push_back({face.mIndices[0], face.mIndices[1], face.mIndices[2]});
            auto const& t = surface.triangles.back();
            if (std::max({t.x, t.y, t.z}) >= source.mNumVertices) {
                throw file_error(path + ": triangle " + std::to_string(i) + " of " + report_.name + " is " +
                                 extents_text({t.x, t.y, t.z}) + ", expected vertices below " +
                                 std::to_string(source.mNumVertices));
            }
        }
        if (!is_uv_usable) {
            surface.uvs.assign(surface.positions.size(), {});
        }
        report_.has_made_uvs = !is_uv_usable;
        return surface;
    }

    void read_joints(aiMesh const& source, model_nodes const& nodes) {
        if (source.mNumBones == 0) {
            return;
        }
        joint_weights_.resize(source.mNumVertices);
        for (unsigned i = 0; i < source.mNumBones; ++i) {
            auto const& bone = *source.mBones[i];
            auto const joint = static_cast<std::uint32_t>(joint_nodes_.size());
            joint_nodes_.push_back(nodes.find(bone.mName).value_or(node_));
            bind_.push_back(to_glm(bone.mOffsetMatrix));
            for (unsigned k = 0; k < bone.mNumWeights; ++k) {
                auto const& weight = bone.mWeights[k];
                if (weight.mVertexId < source.mNumVertices && weight.mWeight > 0) {
                    add_weight(joint_weights_[weight.mVertexId], joint, weight.mWeight);
                }
            }
        }
        report_.joints = joint_nodes_.size();

        // Vertices that no joint holds stay with the mesh's node
        auto const own = static_cast<std::uint32_t>(joint_nodes_.size());
        joint_nodes_.push_back(node_);
        bind_.emplace_back(1.0f);
        for (auto& vertex : joint_weights_) {
            if (vertex.weights == glm::vec4(0)) {
                add_weight(vertex, own, 1);
            }
        }
        joint_weights_ = normalized(std::move(joint_weights_));
    }

    // The four heaviest are kept: the file's reader limits most files to four already.
    static void add_weight(joint_weights& vertex, std::uint32_t joint, float weight) {
        int lightest = 0;
        for (int k = 1; k < 4; ++k) {
            lightest = vertex.weights[k] < vertex.weights[lightest] ? k : lightest;
        }
        if (weight > vertex.weights[lightest]) {
            vertex.weights[lightest] = weight;
            vertex.joints[lightest] = joint;
        }
    }

    void read_morph_targets(aiMesh const& source) {
        for (unsigned target = 0; target < source.mNumAnimMeshes; ++target) {
            auto const& morphed = *source.mAnimMeshes[target];
            auto& offsets = morph_offsets_.emplace_back(source.mNumVertices, glm::vec3(0));
            for (unsigned i = 0; morphed.HasPositions() && i < std::min(source.mNumVertices, morphed.mNumVertices);
                 ++i) {
                offsets[i] = to_glm(morphed.mVertices[i]) - to_glm(source.mVertices[i]);
            }
            morph_weights_.push_back(morphed.mWeight);
        }
        report_.morph_targets = morph_offsets_.size();
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
        report_.overlap = count_uv_overlap(surface, 512);
        for (auto const& uv : surface.uvs) {
            report_.uvs_outside += uv.x < 0 || uv.x > 1 || uv.y < 0 || uv.y > 1;
        }
    }

    std::size_t node_;
    std::array<std::string, 2> names_; ///< of the node and of the mesh
    model_object_report report_;
    std::shared_ptr<mesh const> surface_;
    std::vector<joint_weights> joint_weights_; ///< one a vertex; empty without joints
    std::vector<std::size_t> joint_nodes_;
    std::vector<glm::mat4> bind_;
    std::vector<std::vector<glm::vec3>> morph_offsets_; ///< [targets][vertices]
    std::vector<float> morph_weights_;                  ///< at rest
    aiMeshMorphAnim const* morph_channel_ = nullptr;
    double morph_ticks_per_second_ = 1;
};

} // namespace genrender::examples
