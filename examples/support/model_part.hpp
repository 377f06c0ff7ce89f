// SPDX-License-Identifier: MIT
// One mesh of a file that assimp has read at one node: where its vertices are when the nodes have moved.
#pragma once

#include "model_nodes.hpp"
#include "model_report.hpp"
#include "model_shape.hpp"

#include <genrender/scene/animation.hpp>
#include <genrender/scene/mesh.hpp>
#include <genrender/scene/skinning.hpp>

#include <assimp/mesh.h>
#include <assimp/scene.h>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace genrender::examples {

/// A mesh at a node (see model_shape for where its vertices are).
class model_part {
public:
    /// Throws file_error that begins with `path` if positions are not finite or triangles name vertices that do not
    /// exist.
    model_part(std::string const& path, aiMesh const& source, model_nodes const& nodes, std::size_t node, model_uvs uvs,
               std::size_t uv_set = 0)
        : node_(node), names_{nodes.node(node).mName.C_Str(), source.mName.C_Str()} {
        model_arrays arrays;
        arrays.surface = surface_of(source, uvs, uv_set);
        read_joints(source, nodes, arrays);
        read_morph_targets(source, arrays);
        shape_.emplace(path, names_[0].empty() ? names_[1] : names_[0], std::move(arrays));
    }

    model_object_report const& report() const { return shape_->report(); }

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
        auto weights = morph_weights_;
        if (morph_channel_ != nullptr) {
            morph_weights_at(*morph_channel_, seconds * morph_ticks_per_second_, weights);
        }
        if (!shape_->has_joints()) {
            return shape_->at(object, weights, to_world[node_]);
        }
        std::vector<glm::mat4> global;
        for (auto const joint : joint_nodes_) {
            global.push_back(to_world[joint]);
        }
        return shape_->at(object, weights, global, bind_);
    }

private:
    static mesh surface_of(aiMesh const& source, model_uvs uvs, std::size_t uv_set) {
        mesh surface;
        auto const has_uvs = uvs == model_uvs::from_file && uv_set < AI_MAX_NUMBER_OF_TEXTURECOORDS &&
                             source.HasTextureCoords(static_cast<unsigned>(uv_set)) &&
                             source.mNumUVComponents[uv_set] >= 2;
        for (unsigned i = 0; i < source.mNumVertices; ++i) {
            surface.positions.push_back(to_glm(source.mVertices[i]));
            if (has_uvs) {
                auto const& uv = source.mTextureCoords[uv_set][i];
                surface.uvs.push_back({uv.x, uv.y});
            }
        }
        for (unsigned i = 0; i < source.mNumFaces; ++i) {
            auto const& face = source.mFaces[i];
            if (face.mNumIndices == 3) { // points and lines have no surface
                surface.triangles.push_back({face.mIndices[0], face.mIndices[1], face.mIndices[2]});
            }
        }
        return surface;
    }

    void read_joints(aiMesh const& source, model_nodes const& nodes, model_arrays& arrays) {
        if (source.mNumBones == 0) {
            return;
        }
        arrays.weights.resize(source.mNumVertices);
        for (unsigned i = 0; i < source.mNumBones; ++i) {
            auto const& bone = *source.mBones[i];
            auto const joint = static_cast<std::uint32_t>(joint_nodes_.size());
            joint_nodes_.push_back(nodes.find(bone.mName).value_or(node_));
            bind_.push_back(to_glm(bone.mOffsetMatrix));
            for (unsigned k = 0; k < bone.mNumWeights; ++k) {
                auto const& weight = bone.mWeights[k];
                if (weight.mVertexId < source.mNumVertices && weight.mWeight > 0) {
                    add_weight(arrays.weights[weight.mVertexId], joint, weight.mWeight);
                }
            }
        }
        arrays.joints = joint_nodes_.size();

        // Vertices that no joint holds stay with the mesh's node
        joint_nodes_.push_back(node_);
        bind_.emplace_back(1.0f);
    }

    void read_morph_targets(aiMesh const& source, model_arrays& arrays) {
        for (unsigned target = 0; target < source.mNumAnimMeshes; ++target) {
            auto const& morphed = *source.mAnimMeshes[target];
            auto& offsets = arrays.morph_offsets.emplace_back(source.mNumVertices, glm::vec3(0));
            for (unsigned i = 0; morphed.HasPositions() && i < std::min(source.mNumVertices, morphed.mNumVertices);
                 ++i) {
                offsets[i] = to_glm(morphed.mVertices[i]) - to_glm(source.mVertices[i]);
            }
            morph_weights_.push_back(morphed.mWeight);
        }
    }

    std::size_t node_;
    std::array<std::string, 2> names_; ///< of the node and of the mesh
    std::optional<model_shape> shape_; ///< made once the mesh is read
    std::vector<std::size_t> joint_nodes_;
    std::vector<glm::mat4> bind_;
    std::vector<float> morph_weights_; ///< at rest
    aiMeshMorphAnim const* morph_channel_ = nullptr;
    double morph_ticks_per_second_ = 1;
};

} // namespace genrender::examples
