// SPDX-License-Identifier: MIT
// [GR sec. 3] A model file of any format that assimp reads: FBX, Collada, OBJ, X and many more.
#pragma once

#include "model_assembly.hpp"
#include "model_camera.hpp"
#include "model_nodes.hpp"
#include "model_part.hpp"
#include "model_scene.hpp"

#include <genrender/core/error.hpp>
#include <genrender/core/index.hpp>
#include <genrender/scene/animation.hpp>

#include <assimp/Importer.hpp>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <glm/ext/matrix_transform.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <memory>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace genrender::examples {

/// A file that assimp has read.
class assimp_scene final : public model_scene {
public:
    /// Throws file_error with assimp's reason if the file cannot be read or holds no triangles.
    explicit assimp_scene(std::filesystem::path const& path, model_assembly const& assembly = {})
        : path_(path.string()) {
        read();
        list_takes();
        for (unsigned i = 0; i < scene_->mNumCameras; ++i) {
            auto const& source = *scene_->mCameras[i];
            lenses_.push_back({source.mName.C_Str(), source.mOrthographicWidth > 0, source.mAspect});
        }
        nodes_.emplace(*scene_, to_y_up(assembly.up));
        add_parts(assembly);
    }

    std::vector<model_take> const& takes() const override { return takes_; }
    std::vector<model_lens> const& lenses() const override { return lenses_; }
    std::vector<model_object_report> const& objects() const override { return objects_; }
    std::vector<std::string> const& notes() const override { return notes_; }

    double frames_per_second() const override {
        double rate = 0;
        return scene_->mMetaData != nullptr && scene_->mMetaData->Get("CustomFrameRate", rate) && rate > 0 ? rate : 24;
    }

    void play(std::span<std::size_t const> takes) override {
        std::vector<aiAnimation const*> animations;
        for (auto const take : takes) {
            animations.push_back(scene_->mAnimations[take]);
        }
        nodes_->play(animations);
        for (auto& part : parts_) {
            part.play(animations);
        }
    }

    std::vector<posed_object> objects_at(double seconds) const override {
        auto const to_world = nodes_->to_world(seconds);
        std::vector<posed_object> objects;
        for (std::size_t i = 0; i < parts_.size(); ++i) {
            objects.push_back(parts_[i].at({static_cast<std::uint32_t>(i)}, to_world, seconds));
        }
        return objects;
    }

    camera eye_at(std::size_t lens, double seconds, float aspect, float near_distance) const override {
        auto const& source = *scene_->mCameras[lens];
        auto const node = nodes_->find(source.mName);
        require_value(node.has_value(), "model", "camera", lenses_[lens].name, "one that stands at a node");
        return file_camera(source, nodes_->to_world(seconds)[*node], aspect, near_distance);
    }

private:
    void read() {
        auto const importer = std::make_shared<Assimp::Importer>();
        std::string reason;
        try {
            scene_ = std::shared_ptr<aiScene const>(
                importer, importer->ReadFile(path_, aiProcess_Triangulate | aiProcess_LimitBoneWeights |
                                                        aiProcess_FlipUVs | aiProcess_ValidateDataStructure));
            reason = importer->GetErrorString();
        } catch (std::exception const& failure) {
            reason = failure.what();
        }
        if (scene_ == nullptr || scene_->mRootNode == nullptr) {
            throw file_error(path_ + ": cannot be read as a model (" + reason +
                             "), expected a whole file that assimp knows");
        }
    }

    void add_parts(model_assembly const& assembly) {
        for (std::size_t node = 0; node < nodes_->size(); ++node) {
            for (unsigned i = 0; i < nodes_->node(node).mNumMeshes; ++i) {
                model_part part(path_, *scene_->mMeshes[nodes_->node(node).mMeshes[i]], *nodes_, node, assembly.uvs,
                                assembly.uv_set);
                if (part.report().triangles > 0) {
                    objects_.push_back(part.report());
                    parts_.push_back(std::move(part));
                }
            }
        }
        if (parts_.empty()) {
            throw file_error(path_ + ": holds no triangles, expected a mesh at a node");
        }
    }

    void list_takes() {
        for (unsigned i = 0; i < scene_->mNumAnimations; ++i) {
            auto const& source = *scene_->mAnimations[i];
            auto const [begin, end] = key_times(source);
            model_take take{source.mName.C_Str(), begin / ticks_per_second(source), end / ticks_per_second(source), {}};
            for (unsigned k = 0; k < source.mNumChannels; ++k) {
                take.targets.push_back(source.mChannels[k]->mNodeName.C_Str());
            }
            for (unsigned k = 0; k < source.mNumMorphMeshChannels; ++k) {
                take.targets.push_back(std::string("weights of ") + source.mMorphMeshChannels[k]->mName.C_Str());
            }
            std::sort(take.targets.begin(), take.targets.end());
            take.targets.erase(std::unique(take.targets.begin(), take.targets.end()), take.targets.end());
            takes_.push_back(std::move(take));
        }
    }

    glm::mat4 to_y_up(model_up up) {
        // Most readers turn the scene themselves, as their format defines its axes; FBX tells; Blender's files are z-up
        int axis = up == model_up::z ? 2 : 1;
        if (up == model_up::from_file) {
            auto const is_turned = !scene_->mRootNode->mTransformation.IsIdentity();
            if (std::filesystem::path(path_).extension() == ".blend") {
                axis = 2;
            } else if (scene_->mMetaData == nullptr || is_turned || !scene_->mMetaData->Get("UpAxis", axis)) {
                axis = 1;
            }
        }
        constexpr auto quarter = std::numbers::pi_v<float> / 2;
        if (axis == 2) {
            notes_.push_back("The file's z axis is taken as up.");
            return glm::rotate(glm::mat4(1), -quarter, {1, 0, 0});
        }
        return axis == 0 ? glm::rotate(glm::mat4(1), quarter, {0, 0, 1}) : glm::mat4(1);
    }

    std::string path_;
    std::shared_ptr<aiScene const> scene_;
    std::optional<model_nodes> nodes_; ///< made once the file is read
    std::vector<model_part> parts_;
    std::vector<model_take> takes_;
    std::vector<model_lens> lenses_;
    std::vector<model_object_report> objects_;
    std::vector<std::string> notes_;
};

} // namespace genrender::examples
