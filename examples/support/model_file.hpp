// SPDX-License-Identifier: MIT
// [GR sec. 3] An animated scene from a model file of any format that assimp reads: glTF, FBX, Collada, X and many more.
#pragma once

#include "model_camera.hpp"
#include "model_nodes.hpp"
#include "model_part.hpp"
#include "model_report.hpp"

#include <genrender/core/error.hpp>
#include <genrender/core/index.hpp>
#include <genrender/scene/animation.hpp>
#include <genrender/scene/bounds.hpp>

#include <assimp/Importer.hpp>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <glm/ext/matrix_transform.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace genrender::examples {

/// Where a model is looked at from.
enum class model_view {
    automatic, ///< orbiting around a rigid model; an animated one by the file's camera if that sees it, else still
    file,      ///< the file's first camera, whatever it sees
    still,     ///< one camera for all frames, from `azimuth` and `elevation`, that sees every frame
    orbiting   ///< one turn around the model, which starts at `azimuth`
};

/// The axis that points upwards in a file.
enum class model_up {
    from_file, ///< what the file says, y if it says nothing
    y,
    z
};

/// How a model file becomes an animation.
struct model_options {
    /// Number of frames; 0: the whole animation at `frames_per_second`.
    std::size_t frames = 16;
    /// Without a value the frames go once through the animation, whose end a loop shows as its start; with one it
    /// starts again when it is over.
    std::optional<double> frames_per_second{};
    float aspect = 1;          ///< width / height of the image that cameras are fitted to
    float vertical_fov = 0.6f; ///< of cameras that are not the file's, radians
    float azimuth = 0.5f;      ///< 0 looks from +z, pi / 2 from +x; radians
    float elevation = 0.3f;    ///< above the ground, radians, in (-pi / 2, pi / 2)
    model_view view = model_view::automatic;
    model_up up = model_up::from_file;
    model_uvs uvs = model_uvs::from_file;
    std::optional<std::size_t> animation{}; ///< which of the file's; without a value the first that lasts
};

/// A loaded model: an animation (see scene/animation.hpp). Copies share the file's data, which nobody changes.
class model_animation {
public:
    std::size_t frame_count() const { return times_.size(); }

    /// Frame i: every mesh instance is an object, in the order of the file's nodes. Throws value_error beyond the end.
    posed_scene frame(frame_index i) const {
        require_value(i.value < times_.size(), "model_animation", "frame", i.value, "a frame of the animation");
        return {cameras_[i.value], objects_at(times_[i.value])};
    }

    model_report const& report() const { return report_; }

private:
    friend model_animation load_model(std::filesystem::path const&, model_options const&);

    model_animation(std::filesystem::path const& path, model_options const& options) : path_(path.string()) {
        read();
        auto const* const animation = choose_animation(options);
        choose_times(animation, options);
        nodes_ = std::make_shared<model_nodes const>(*scene_, animation, to_y_up(options.up));
        add_parts(animation, options);
        choose_cameras(animation != nullptr, options);
    }

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

    aiAnimation const* choose_animation(model_options const& options) {
        if (options.animation) {
            require_value(*options.animation < scene_->mNumAnimations, "load_model", "options.animation",
                          *options.animation, "one of the file's animations");
            return scene_->mAnimations[*options.animation];
        }
        for (unsigned i = 0; i < scene_->mNumAnimations; ++i) {
            auto const times = key_times(*scene_->mAnimations[i]);
            if (times.second > times.first) {
                return scene_->mAnimations[i];
            }
        }
        return nullptr;
    }

    void choose_times(aiAnimation const* animation, model_options const& options) {
        auto const fps = options.frames_per_second.value_or(0);
        require_value(!options.frames_per_second || (fps > 0 && std::isfinite(fps)), "load_model",
                      "options.frames_per_second", fps, "a rate above 0");
        if (animation == nullptr) {
            require_value(options.frames > 0, "load_model", "options.frames", options.frames,
                          "at least 1 where the file has no animation");
            times_.assign(options.frames, 0);
            return;
        }
        auto const [begin, end] = key_times(*animation);
        auto const ticks_per_second = animation->mTicksPerSecond > 0 ? animation->mTicksPerSecond : 25.0;
        auto const duration = end - begin;
        report_.animation = animation->mName.C_Str();
        report_.seconds = duration / ticks_per_second;
        require_value(options.frames > 0 || fps > 0, "load_model", "options.frames", options.frames,
                      "at least 1, or frames_per_second");
        auto const frames =
            options.frames > 0 ? options.frames
                               : std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(report_.seconds * fps)));
        for (std::size_t i = 0; i < frames; ++i) {
            auto const frame = static_cast<double>(i);
            auto const ticks =
                fps > 0 ? frame * ticks_per_second / fps : frame * duration / static_cast<double>(frames);
            times_.push_back(begin + (duration > 0 ? std::fmod(ticks, duration) : 0.0));
        }
        if (scene_->mNumAnimations > 1) {
            report_.notes.push_back("Plays " + report_.animation + ", one of " +
                                    std::to_string(scene_->mNumAnimations) + " animations.");
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
            report_.notes.push_back("The file's z axis is taken as up.");
            return glm::rotate(glm::mat4(1), -quarter, {1, 0, 0});
        }
        return axis == 0 ? glm::rotate(glm::mat4(1), quarter, {0, 0, 1}) : glm::mat4(1);
    }

    void add_parts(aiAnimation const* animation, model_options const& options) {
        for (std::size_t node = 0; node < nodes_->size(); ++node) {
            for (unsigned i = 0; i < nodes_->node(node).mNumMeshes; ++i) {
                auto const& source = *scene_->mMeshes[nodes_->node(node).mMeshes[i]];
                model_part part(path_, source, *nodes_, node, animation, options.uvs);
                if (part.report().triangles > 0) {
                    report_.objects.push_back(part.report());
                    parts_.push_back(std::move(part));
                }
            }
        }
        if (parts_.empty()) {
            throw file_error(path_ + ": holds no triangles, expected a mesh at a node");
        }
    }

    std::vector<posed_object> objects_at(double time) const {
        auto const to_world = nodes_->to_world(time);
        std::vector<posed_object> objects;
        for (std::size_t i = 0; i < parts_.size(); ++i) {
            objects.push_back(parts_[i].at({static_cast<std::uint32_t>(i)}, to_world, time));
        }
        return objects;
    }

    void choose_cameras(bool is_animated, model_options const& options) {
        require_value(options.aspect > 0 && std::isfinite(options.aspect), "load_model", "options.aspect",
                      options.aspect, "width / height above 0");
        require_value(options.vertical_fov > 0 && options.vertical_fov < 3.1f, "load_model", "options.vertical_fov",
                      options.vertical_fov, "an angle between 0 and pi");
        require_value(std::abs(options.elevation) < 1.57f, "load_model", "options.elevation", options.elevation,
                      "an angle between -pi / 2 and pi / 2");

        // Collect where the model is in all frames
        std::vector<glm::vec3> points;
        for (std::size_t i = 0; i < (is_animated ? times_.size() : 1); ++i) {
            for (auto const& object : objects_at(times_[i])) {
                for (auto const& p : object.positions) {
                    if (!is_place(p)) {
                        throw file_error(path_ +
                                         ": moves vertices to places that are not finite, expected coordinates");
                    }
                    points.push_back(p);
                }
            }
        }
        auto const box = bounds_of(points);
        if (!(box.radius() > 0)) {
            throw file_error(path_ + ": has all its vertices at one point, expected a surface");
        }

        if (options.view == model_view::file && !use_file_camera(points, box, options)) {
            throw file_error(path_ + ": holds no camera that can be used, expected a perspective camera at a node");
        }
        if (options.view == model_view::automatic && is_animated && scene_->mNumCameras > 0) {
            use_file_camera(points, box, options);
        }
        if (!cameras_.empty()) {
            return;
        }
        if (options.view == model_view::still || (options.view == model_view::automatic && is_animated)) {
            cameras_.assign(times_.size(), fit_points(points, view_direction(options.azimuth, options.elevation),
                                                      options.vertical_fov, options.aspect));
            return;
        }
        cameras_ = orbit_cameras(points, options.azimuth, options.elevation, options.vertical_fov, options.aspect,
                                 times_.size());
    }

    // Returns whether there are cameras now. One that hardly sees the model belongs to a scene that this file is a
    // part of.
    bool use_file_camera(std::span<glm::vec3 const> points, bounds const& box, model_options const& options) {
        auto source = scene_->mNumCameras > 0 ? *scene_->mCameras[0] : aiCamera{};
        auto const node = scene_->mNumCameras > 0 ? nodes_->find(source.mName) : std::nullopt;
        if (!node || source.mOrthographicWidth > 0) {
            return false;
        }
        // A glTF camera stands where its node is; assimp 5.2 adds the node's translation once more
        auto const ending = std::filesystem::path(path_).extension();
        source.mPosition = ending == ".gltf" || ending == ".glb" ? aiVector3D{} : source.mPosition;
        try {
            for (auto const time : times_) {
                cameras_.push_back(
                    file_camera(source, nodes_->to_world(time)[*node], options.aspect, 1e-3f * box.radius()));
            }
        } catch (value_error const& reason) {
            report_.notes.push_back(std::string("The file's camera cannot be used: ") + reason.what() + ".");
            cameras_.clear();
            return false;
        }
        auto const percent = 100 * count_seen(cameras_.front(), points, options.aspect) / points.size();
        if (options.view == model_view::automatic && percent < 50) {
            report_.notes.push_back("The file's camera is not used: it sees " + std::to_string(percent) +
                                    " % of the model.");
            cameras_.clear();
            return false;
        }
        report_.notes.push_back("Looks through the file's camera, which sees " + std::to_string(percent) +
                                " % of the model.");
        return true;
    }

    std::string path_;
    std::shared_ptr<aiScene const> scene_;
    std::shared_ptr<model_nodes const> nodes_;
    std::vector<model_part> parts_;
    std::vector<double> times_; ///< of each frame, in ticks
    std::vector<camera> cameras_;
    model_report report_;
};

static_assert(animation<model_animation>);

/// The model in `path`: nodes, skins of up to four joints a vertex and morph targets move as the file says; materials
/// are left out; v is 0 at the texture's top. A mesh without UVs gets an atlas of its triangles. Throws file_error
/// with assimp's reason if the file cannot be read or holds nothing to see, value_error at impossible options.
inline model_animation load_model(std::filesystem::path const& path, model_options const& options = {}) {
    return model_animation(path, options);
}

} // namespace genrender::examples
