// SPDX-License-Identifier: MIT
// The nodes of a glTF file: which of them are in its scene, and where each is while animations play.
#pragma once

#include "gltf_animation.hpp"
#include "gltf_document.hpp"

#include <glm/ext/matrix_transform.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace genrender::examples {

/// Translation, rotation and scale, applied in the opposite order.
struct gltf_transform {
    glm::vec3 translation{0};
    glm::quat rotation{1, 0, 0, 0};
    glm::vec3 scale{1};

    glm::mat4 matrix() const {
        auto result = glm::mat4_cast(glm::normalize(rotation));
        for (int axis = 0; axis < 3; ++axis) {
            result[axis] *= scale[axis];
        }
        result[3] = glm::vec4(translation, 1);
        return result;
    }
};

/// All nodes of a document, by their numbers in the file.
class gltf_nodes {
public:
    /// At rest; `to_y_up` is put before the roots. Throws file_error at a child that does not exist, that has two
    /// parents or that is among its own ancestors, and at transforms of a wrong number of numbers.
    gltf_nodes(gltf_document const& document, glm::mat4 const& to_y_up) : to_y_up_(to_y_up) {
        auto const& sources = document.model.nodes;
        nodes_.resize(sources.size());
        for (std::size_t i = 0; i < sources.size(); ++i) {
            read_transform(document, sources[i], i);
            for (auto const child : sources[i].children) {
                auto const number = checked(document, child, "a child of node " + std::to_string(i));
                if (nodes_[number].parent) {
                    document.refuse("node " + std::to_string(child) + " has two parents, expected a tree of nodes");
                }
                nodes_[number].parent = i;
            }
        }
        std::vector<std::size_t> roots;
        for (std::size_t i = 0; i < nodes_.size(); ++i) {
            if (!nodes_[i].parent) {
                roots.push_back(i);
            }
        }
        order_ = descendants(document, roots);
        if (order_.size() != nodes_.size()) {
            document.refuse("has nodes among their own ancestors, expected a tree of nodes");
        }
        list_scene(document);
    }

    /// Follows these animations from now on, by the last one that moves a property.
    void play(std::vector<gltf_animation const*> const& animations) {
        for (auto& node : nodes_) {
            node.tracks = {};
        }
        for (auto const* const animation : animations) {
            for (auto const& channel : animation->channels) {
                nodes_[channel.node].tracks[static_cast<std::size_t>(channel.property)] = channel.track.get();
            }
        }
    }

    /// The nodes of the file's scene, parents before children, in the order of the file's lists.
    std::vector<std::size_t> const& in_scene() const { return in_scene_; }

    /// Each node's space to the world's at a time in seconds.
    std::vector<glm::mat4> to_world(double seconds) const {
        std::vector<glm::mat4> result(nodes_.size());
        for (auto const i : order_) {
            result[i] = (nodes_[i].parent ? result[*nodes_[i].parent] : to_y_up_) * local(nodes_[i], seconds);
        }
        return result;
    }

    /// The weights of the morph targets of a node that an animation moves; nothing if none does.
    std::optional<std::vector<float>> weights(std::size_t node, double seconds) const {
        auto const* const track = nodes_[node].tracks[static_cast<std::size_t>(gltf_property::weights)];
        return track == nullptr ? std::nullopt : std::optional(track->at(seconds));
    }

private:
    struct placed_node {
        std::optional<std::size_t> parent;
        std::optional<glm::mat4> matrix; ///< where the file gives one instead of
        gltf_transform rest;
        std::array<gltf_track const*, 4> tracks{}; ///< of each gltf_property
    };

    static glm::mat4 local(placed_node const& node, double seconds) {
        auto const& [translation, rotation, scale, weights] = node.tracks;
        if (translation == nullptr && rotation == nullptr && scale == nullptr) {
            return node.matrix ? *node.matrix : node.rest.matrix();
        }
        auto transform = node.rest;
        if (translation != nullptr) {
            auto const t = translation->at(seconds);
            transform.translation = {t[0], t[1], t[2]};
        }
        if (rotation != nullptr) {
            auto const q = rotation->at(seconds);
            transform.rotation = glm::quat(q[3], q[0], q[1], q[2]);
        }
        if (scale != nullptr) {
            auto const s = scale->at(seconds);
            transform.scale = {s[0], s[1], s[2]};
        }
        return transform.matrix();
    }

    static std::size_t checked(gltf_document const& document, int node, std::string const& what) {
        auto const count = document.model.nodes.size();
        if (node < 0 || static_cast<std::size_t>(node) >= count) {
            document.refuse(what + " is node " + std::to_string(node) + ", expected one of " + std::to_string(count));
        }
        return static_cast<std::size_t>(node);
    }

    void read_transform(gltf_document const& document, tinygltf::Node const& source, std::size_t number) {
        auto& node = nodes_[number];
        auto const has = [&](std::vector<double> const& values, std::size_t width, char const* name) {
            if (!values.empty() && values.size() != width) {
                document.refuse("the " + std::string(name) + " of node " + std::to_string(number) + " has " +
                                std::to_string(values.size()) + " numbers, expected " + std::to_string(width));
            }
            return !values.empty();
        };
        auto const& t = source.translation;
        auto const& r = source.rotation;
        auto const& s = source.scale;
        if (has(source.matrix, 16, "matrix")) {
            auto& matrix = node.matrix.emplace();
            for (int i = 0; i < 16; ++i) {
                matrix[i / 4][i % 4] = static_cast<float>(source.matrix[static_cast<std::size_t>(i)]);
            }
            decompose(matrix, node.rest);
        }
        if (has(t, 3, "translation")) {
            node.rest.translation = glm::vec3(glm::dvec3(t[0], t[1], t[2]));
        }
        if (has(r, 4, "rotation")) {
            node.rest.rotation = glm::quat(glm::dquat(r[3], r[0], r[1], r[2]));
        }
        if (has(s, 3, "scale")) {
            node.rest.scale = glm::vec3(glm::dvec3(s[0], s[1], s[2]));
        }
    }

    // Of a matrix without shear, as the format asks for
    static void decompose(glm::mat4 const& matrix, gltf_transform& transform) {
        transform.translation = glm::vec3(matrix[3]);
        glm::mat3 axes(matrix);
        for (int axis = 0; axis < 3; ++axis) {
            transform.scale[axis] = glm::length(axes[axis]);
        }
        transform.scale.x *= glm::determinant(axes) < 0 ? -1.0f : 1.0f;
        for (int axis = 0; axis < 3; ++axis) {
            axes[axis] /= transform.scale[axis] != 0 ? transform.scale[axis] : 1.0f;
        }
        transform.rotation = glm::quat_cast(axes);
    }

    /// The nodes and all below them, parents first. Each has one parent, so none is reached twice unless named twice.
    std::vector<std::size_t> descendants(gltf_document const& document, std::vector<std::size_t> const& from) const {
        std::vector<std::size_t> order;
        std::vector<std::size_t> waiting(from.rbegin(), from.rend());
        while (!waiting.empty()) {
            auto const node = waiting.back();
            waiting.pop_back();
            order.push_back(node);
            if (order.size() > nodes_.size()) {
                document.refuse("names a node of its scene twice, expected each once");
            }
            auto const& children = document.model.nodes[node].children;
            for (auto child = children.rbegin(); child != children.rend(); ++child) {
                waiting.push_back(static_cast<std::size_t>(*child));
            }
        }
        return order;
    }

    void list_scene(gltf_document const& document) {
        auto const& scenes = document.model.scenes;
        if (scenes.empty()) {
            in_scene_ = order_;
            return;
        }
        auto const number = document.model.defaultScene < 0 ? 0 : document.model.defaultScene;
        if (static_cast<std::size_t>(number) >= scenes.size()) {
            document.refuse("shows scene " + std::to_string(number) + ", expected one of " +
                            std::to_string(scenes.size()));
        }
        std::vector<std::size_t> roots;
        for (auto const node : scenes[static_cast<std::size_t>(number)].nodes) {
            roots.push_back(checked(document, node, "a root of the scene"));
        }
        in_scene_ = descendants(document, roots);
    }

    glm::mat4 to_y_up_;
    std::vector<placed_node> nodes_;
    std::vector<std::size_t> order_; ///< of all, parents first
    std::vector<std::size_t> in_scene_;
};

} // namespace genrender::examples
