// SPDX-License-Identifier: MIT
// [GR sec. 3] A model file of glTF 2.0, as the standard says: what it means is not guessed.
#pragma once

#include "gltf_accessor.hpp"
#include "gltf_animation.hpp"
#include "gltf_document.hpp"
#include "gltf_instances.hpp"
#include "gltf_mesh.hpp"
#include "gltf_nodes.hpp"
#include "gltf_skin.hpp"
#include "model_assembly.hpp"
#include "model_scene.hpp"
#include "model_shape.hpp"

#include <genrender/core/index.hpp>
#include <genrender/scene/animation.hpp>
#include <genrender/scene/camera.hpp>

#include <glm/geometric.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace genrender::examples {

/// A glTF file. Skinned vertices follow their joints alone, whatever their own node does; the weights of a node come
/// before those of its mesh; instances of EXT_mesh_gpu_instancing are objects.
class gltf_scene final : public model_scene {
public:
    /// Throws file_error with the reason if the file cannot be read, is not what the format allows, needs an extension
    /// that is not known or holds no triangles.
    explicit gltf_scene(std::filesystem::path const& path, model_assembly const& assembly = {})
        : document_(read_gltf(path)), nodes_(document_, assembly.up == model_up::z ? z_up_to_y_up() : glm::mat4(1)) {
        gltf_accessors accessors(document_);
        skins_ = gltf_skins(document_, accessors);
        animations_ = gltf_animations(document_, accessors);
        list_takes();
        for (auto const node : nodes_.in_scene()) {
            add_lens(node);
            add_mesh(node, accessors, assembly);
        }
        if (objects_.empty()) {
            document_.refuse("holds no triangles, expected a mesh at a node");
        }
        if (document_.model.scenes.size() > 1) {
            document_.notes.push_back("The file has " + std::to_string(document_.model.scenes.size()) +
                                      " scenes; its default one is shown.");
        }
        if (assembly.up == model_up::z) {
            document_.notes.push_back("The file's z axis is taken as up.");
        }
        // What has been read lies in shapes and tracks now
        document_.model = {};
    }

    std::vector<model_take> const& takes() const override { return takes_; }
    std::vector<model_lens> const& lenses() const override { return lenses_; }
    std::vector<model_object_report> const& objects() const override { return reports_; }
    std::vector<std::string> const& notes() const override { return document_.notes; }

    void play(std::span<std::size_t const> takes) override {
        std::vector<gltf_animation const*> playing;
        for (auto const take : takes) {
            playing.push_back(&animations_[take]);
        }
        nodes_.play(playing);
    }

    std::vector<posed_object> objects_at(double seconds) const override {
        auto const to_world = nodes_.to_world(seconds);
        std::vector<posed_object> posed;
        for (auto const& object : objects_) {
            object_index const index{static_cast<std::uint32_t>(posed.size())};
            auto const weights = nodes_.weights(object.node, seconds).value_or(object.weights);
            if (!object.shape->has_joints()) {
                posed.push_back(object.shape->at(index, weights, to_world[object.node] * object.instance));
                continue;
            }
            std::vector<glm::mat4> joints;
            for (auto const joint : skins_[object.skin].joints) {
                joints.push_back(to_world[joint]);
            }
            joints.push_back(to_world[object.node]); // for vertices that no joint holds
            posed.push_back(object.shape->at(index, weights, joints, skins_[object.skin].bind));
        }
        return posed;
    }

    camera eye_at(std::size_t lens, double seconds, float aspect, float near_distance) const override {
        auto const& source = eyes_[lens];
        auto const to_world = nodes_.to_world(seconds)[source.node];
        auto const tangent = std::tan(source.vertical_fov / 2);
        // An image that is narrower than the file's shows its whole width
        auto const widened = source.aspect > aspect ? tangent * source.aspect / aspect : tangent;
        auto const position = glm::vec3(to_world[3]);
        auto const reach = std::max(1.0f, glm::length(position)); // far from the middle of the world 1 may be nothing
        auto const target = position - reach * glm::normalize(glm::vec3(to_world[2]));
        auto eye = look_at(position, target, 2 * std::atan(widened), glm::normalize(glm::vec3(to_world[1])));
        eye.near_distance = near_distance;
        return eye;
    }

private:
    struct placed_shape {
        std::shared_ptr<model_shape const> shape;
        std::size_t node = 0;
        std::size_t skin = 0;       ///< of a shape with joints
        std::vector<float> weights; ///< of its morph targets at rest
        glm::mat4 instance{1};
    };

    struct placed_lens {
        std::size_t node = 0;
        float vertical_fov = 0;
        float aspect = 0; ///< width / height; 0 where the file leaves it open
    };

    void list_takes() {
        for (auto const& animation : animations_) {
            model_take take{animation.name, 0, 0, {}};
            for (auto const& channel : animation.channels) {
                auto const& times = channel.track->times;
                auto const is_first = take.targets.empty();
                take.begin = is_first ? static_cast<double>(times.front())
                                      : std::min(take.begin, static_cast<double>(times.front()));
                take.end = is_first ? static_cast<double>(times.back())
                                    : std::max(take.end, static_cast<double>(times.back()));
                auto const node = "node " + std::to_string(channel.node);
                take.targets.push_back(channel.property == gltf_property::weights ? "weights of " + node : node);
            }
            std::sort(take.targets.begin(), take.targets.end());
            take.targets.erase(std::unique(take.targets.begin(), take.targets.end()), take.targets.end());
            takes_.push_back(std::move(take));
        }
    }

    void add_lens(std::size_t node) {
        auto const number = document_.model.nodes[node].camera;
        if (number < 0) {
            return;
        }
        if (static_cast<std::size_t>(number) >= document_.model.cameras.size()) {
            document_.refuse("node " + std::to_string(node) + " is camera " + std::to_string(number) +
                             ", expected one of " + std::to_string(document_.model.cameras.size()));
        }
        auto const& source = document_.model.cameras[static_cast<std::size_t>(number)];
        auto const& perspective = source.perspective;
        auto const is_aspect = perspective.aspectRatio > 1e-3 && perspective.aspectRatio < 1e3;
        auto const aspect = is_aspect ? static_cast<float>(perspective.aspectRatio) : 0.0f;
        lenses_.push_back({source.name, source.type != "perspective", aspect});
        eyes_.push_back({node, static_cast<float>(perspective.yfov), aspect});
    }

    void add_mesh(std::size_t node, gltf_accessors& accessors, model_assembly const& assembly) {
        auto const& source = document_.model.nodes[node];
        if (source.mesh < 0) {
            return;
        }
        auto const& meshes = document_.model.meshes;
        if (static_cast<std::size_t>(source.mesh) >= meshes.size()) {
            document_.refuse("node " + std::to_string(node) + " draws mesh " + std::to_string(source.mesh) +
                             ", expected one of " + std::to_string(meshes.size()));
        }
        if (source.skin >= 0 && static_cast<std::size_t>(source.skin) >= skins_.size()) {
            document_.refuse("node " + std::to_string(node) + " wears skin " + std::to_string(source.skin) +
                             ", expected one of " + std::to_string(skins_.size()));
        }
        auto const& mesh = meshes[static_cast<std::size_t>(source.mesh)];
        auto const name = source.name.empty() ? mesh.name : source.name;
        auto const& weights = source.weights.empty() ? mesh.weights : source.weights;
        auto const instances = gltf_instances(document_, accessors, node);
        for (std::size_t i = 0; i < mesh.primitives.size(); ++i) {
            auto const shape = shape_of(source, i, name, accessors, assembly);
            if (shape->report().triangles == 0) {
                continue;
            }
            for (std::size_t k = 0; k < instances.size(); ++k) {
                auto report = shape->report();
                report.name = (name.empty() ? "unnamed" : name) +
                              (instances.size() > 1 ? " " + std::to_string(k + 1) : std::string());
                reports_.push_back(std::move(report));
                objects_.push_back({shape,
                                    node,
                                    static_cast<std::size_t>(std::max(source.skin, 0)),
                                    {weights.begin(), weights.end()},
                                    instances[k]});
                vertices_ += shape->report().vertices;
                if (vertices_ > most_vertices) {
                    document_.refuse("draws more than " + std::to_string(most_vertices) +
                                     " vertices, expected a smaller model");
                }
                if (shape->has_joints()) {
                    break; // instances are placed by their node, which a skin does not follow
                }
            }
        }
    }

    /// A primitive of the node's mesh, once for each skin that it is drawn with.
    std::shared_ptr<model_shape const> shape_of(tinygltf::Node const& node, std::size_t primitive,
                                                std::string const& name, gltf_accessors& accessors,
                                                model_assembly const& assembly) {
        auto& shape = shapes_[{node.mesh, primitive, node.skin}];
        if (shape == nullptr) {
            auto const what = "primitive " + std::to_string(primitive) + " of mesh " + std::to_string(node.mesh);
            auto const joints = node.skin >= 0 ? skins_[static_cast<std::size_t>(node.skin)].joints.size() : 0;
            auto const& source = document_.model.meshes[static_cast<std::size_t>(node.mesh)].primitives[primitive];
            shape = std::make_shared<model_shape const>(
                document_.path, name, gltf_arrays(document_, accessors, source, joints, assembly, what));
        }
        return shape;
    }

    static constexpr std::size_t most_vertices = 100'000'000; ///< of all objects: more than a gigabyte a frame

    gltf_document document_;
    gltf_nodes nodes_;
    std::vector<gltf_skin> skins_;
    std::vector<gltf_animation> animations_;
    std::map<std::tuple<int, std::size_t, int>, std::shared_ptr<model_shape const>> shapes_; ///< mesh, primitive, skin
    std::vector<placed_shape> objects_;
    std::vector<model_object_report> reports_;
    std::vector<model_take> takes_;
    std::vector<model_lens> lenses_;
    std::vector<placed_lens> eyes_; ///< of each lens
    std::size_t vertices_ = 0;
};

} // namespace genrender::examples
