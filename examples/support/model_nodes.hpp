// SPDX-License-Identifier: MIT
// The nodes of a model file and how its keys move them: positions and scales go straight between keys, rotations round.
#pragma once

#include <assimp/anim.h>
#include <assimp/scene.h>
#include <glm/gtc/quaternion.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace genrender::examples {

/// assimp's row-major matrix as GLM's.
inline glm::mat4 to_glm(aiMatrix4x4 const& m) {
    return {m.a1, m.b1, m.c1, m.d1, m.a2, m.b2, m.c2, m.d2, m.a3, m.b3, m.c3, m.d3, m.a4, m.b4, m.c4, m.d4};
}
inline glm::vec3 to_glm(aiVector3D const& p) { return {p.x, p.y, p.z}; }
inline glm::quat to_glm(aiQuaternion const& q) { return glm::normalize(glm::quat(q.w, q.x, q.y, q.z)); }

/// Between which two keys a time lies, and how far: 0 at `first`, 1 at `second`, beyond them only when extrapolated.
struct key_interval {
    std::size_t first = 0;
    std::size_t second = 0;
    double factor = 0;
};

/// Where `time` lies among keys that are sorted by time. Before the first and after the last key: `before` and
/// `after` repeat the keys from the start, or go on along the two outermost ones; else the outermost key holds.
/// (assimp's "default" would jump to the pose without animation; glTF, FBX and X mean the nearest key, and so do
/// viewers.) There must be a key.
template <class Key>
key_interval interval_at(std::span<Key const> keys, double time, aiAnimBehaviour before, aiAnimBehaviour after) {
    auto const begin = keys.front().mTime;
    auto const end = keys.back().mTime;
    auto const rule = time < begin ? before : time > end ? after : aiAnimBehaviour_CONSTANT;
    if (rule == aiAnimBehaviour_REPEAT && end > begin) {
        time -= std::floor((time - begin) / (end - begin)) * (end - begin);
    } else if (rule != aiAnimBehaviour_LINEAR) {
        time = std::clamp(time, begin, end);
    }
    if (keys.size() == 1) {
        return {};
    }
    auto const later =
        std::upper_bound(keys.begin(), keys.end(), time, [](double t, Key const& key) { return t < key.mTime; });
    auto const second = static_cast<std::size_t>(
        std::clamp<std::ptrdiff_t>(later - keys.begin(), 1, static_cast<std::ptrdiff_t>(keys.size()) - 1));
    auto const span = keys[second].mTime - keys[second - 1].mTime;
    return {second - 1, second, span > 0 ? (time - keys[second - 1].mTime) / span : 1.0};
}

/// Translation, rotation and scale at `time`, as a matrix; a part without keys is that of `rest`.
inline glm::mat4 transform_at(aiNodeAnim const& channel, aiMatrix4x4 const& rest, double time) {
    aiVector3D scaling, position;
    aiQuaternion rotation;
    rest.Decompose(scaling, rotation, position);
    auto const vector_at = [&](aiVectorKey const* keys, unsigned count, aiVector3D const& otherwise) {
        if (count == 0) {
            return to_glm(otherwise);
        }
        auto const at = interval_at(std::span(keys, count), time, channel.mPreState, channel.mPostState);
        return glm::mix(to_glm(keys[at.first].mValue), to_glm(keys[at.second].mValue), static_cast<float>(at.factor));
    };
    auto const t = vector_at(channel.mPositionKeys, channel.mNumPositionKeys, position);
    auto const s = vector_at(channel.mScalingKeys, channel.mNumScalingKeys, scaling);
    auto r = to_glm(rotation);
    if (channel.mNumRotationKeys > 0) {
        auto const* const keys = channel.mRotationKeys;
        auto const at = interval_at(std::span<aiQuatKey const>(keys, channel.mNumRotationKeys), time, channel.mPreState,
                                    channel.mPostState);
        r = glm::slerp(to_glm(keys[at.first].mValue), to_glm(keys[at.second].mValue), static_cast<float>(at.factor));
    }
    auto matrix = glm::mat4_cast(r);
    for (int axis = 0; axis < 3; ++axis) {
        matrix[axis] *= s[axis];
    }
    matrix[3] = glm::vec4(t, 1);
    return matrix;
}

/// The weights of a mesh's morph targets at `time`; targets that no key names keep `weights`. A key may name some of
/// the targets only: each goes straight between the keys that name it, and holds before the first and after the last.
inline void morph_weights_at(aiMeshMorphAnim const& channel, double time, std::vector<float>& weights) {
    struct nearest_keys {
        aiMeshMorphKey const* before = nullptr;
        aiMeshMorphKey const* after = nullptr;
        double weight_before = 0;
        double weight_after = 0;
    };
    std::vector<nearest_keys> nearest(weights.size());
    for (auto const& key : std::span(channel.mKeys, channel.mNumKeys)) {
        for (unsigned i = 0; i < key.mNumValuesAndWeights; ++i) {
            if (key.mValues[i] >= weights.size()) {
                continue;
            }
            auto& found = nearest[key.mValues[i]];
            if (key.mTime <= time) {
                found.before = &key;
                found.weight_before = key.mWeights[i];
            } else if (found.after == nullptr) {
                found.after = &key;
                found.weight_after = key.mWeights[i];
            }
        }
    }
    for (std::size_t target = 0; target < weights.size(); ++target) {
        auto const& [before, after, weight_before, weight_after] = nearest[target];
        if (before != nullptr && after != nullptr) {
            auto const factor = (time - before->mTime) / (after->mTime - before->mTime);
            weights[target] = static_cast<float>(weight_before * (1 - factor) + weight_after * factor);
        } else if (before != nullptr || after != nullptr) {
            weights[target] = static_cast<float>(before != nullptr ? weight_before : weight_after);
        }
    }
}

/// Ticks a second of an animation's keys; 25 where the file says nothing.
inline double ticks_per_second(aiAnimation const& animation) {
    return animation.mTicksPerSecond > 0 ? animation.mTicksPerSecond : 25.0;
}

/// First and last time of the keys of an animation, in ticks; its stated duration if it has no keys at two times.
inline std::pair<double, double> key_times(aiAnimation const& animation) {
    auto begin = std::numeric_limits<double>::max();
    auto end = std::numeric_limits<double>::lowest();
    auto const include = [&](auto const* keys, unsigned count) {
        if (count > 0) {
            begin = std::min(begin, keys[0].mTime);
            end = std::max(end, keys[count - 1].mTime);
        }
    };
    for (unsigned i = 0; i < animation.mNumChannels; ++i) {
        auto const& channel = *animation.mChannels[i];
        include(channel.mPositionKeys, channel.mNumPositionKeys);
        include(channel.mRotationKeys, channel.mNumRotationKeys);
        include(channel.mScalingKeys, channel.mNumScalingKeys);
    }
    for (unsigned i = 0; i < animation.mNumMorphMeshChannels; ++i) {
        include(animation.mMorphMeshChannels[i]->mKeys, animation.mMorphMeshChannels[i]->mNumKeys);
    }
    return end > begin ? std::pair{begin, end} : std::pair{0.0, std::max(animation.mDuration, 0.0)};
}

/// Whether a key of the animation differs from the first of its channel.
inline bool moves_something(aiAnimation const& animation) {
    auto const varies = [](auto const* keys, unsigned count) {
        return std::any_of(keys, keys + count, [&](auto const& key) { return key.mValue != keys[0].mValue; });
    };
    for (unsigned i = 0; i < animation.mNumChannels; ++i) {
        auto const& channel = *animation.mChannels[i];
        if (varies(channel.mPositionKeys, channel.mNumPositionKeys) ||
            varies(channel.mRotationKeys, channel.mNumRotationKeys) ||
            varies(channel.mScalingKeys, channel.mNumScalingKeys)) {
            return true;
        }
    }
    for (unsigned i = 0; i < animation.mNumMorphMeshChannels; ++i) {
        auto const& channel = *animation.mMorphMeshChannels[i];
        for (unsigned k = 1; k < channel.mNumKeys; ++k) {
            auto const& first = channel.mKeys[0];
            auto const& key = channel.mKeys[k];
            auto const count = first.mNumValuesAndWeights;
            if (key.mNumValuesAndWeights != count || !std::equal(key.mValues, key.mValues + count, first.mValues) ||
                !std::equal(key.mWeights, key.mWeights + count, first.mWeights)) {
                return true;
            }
        }
    }
    return false;
}

/// All nodes of a scene, parents before children. Refers to the scene, which must outlive it.
class model_nodes {
public:
    /// At rest; `to_y_up` is put before the root.
    model_nodes(aiScene const& scene, glm::mat4 const& to_y_up) : to_y_up_(to_y_up) {
        list(*scene.mRootNode, std::nullopt);
    }

    /// Moved by these animations from now on, by the last one that names a node. What moves a node replaces its whole
    /// transformation, which FBX's reader splits over nodes before it that are named after it: those of them that
    /// nothing moves are then left out, but for the ones of the geometry, which belong to the mesh and come after the
    /// motion.
    void play(std::span<aiAnimation const* const> animations) {
        for (auto& entry : nodes_) {
            entry.channel = nullptr;
            entry.rest = entry.source->mTransformation;
            entry.fixed = to_glm(entry.rest);
        }
        for (auto const* const animation : animations) {
            for (unsigned i = 0; i < animation->mNumChannels; ++i) {
                if (auto const node = find(animation->mChannels[i]->mNodeName)) {
                    nodes_[*node].channel = animation->mChannels[i];
                    nodes_[*node].ticks_per_second = ticks_per_second(*animation);
                }
            }
        }
        for (std::size_t node = 0; node < nodes_.size(); ++node) {
            if (nodes_[node].channel != nullptr) {
                replace_helpers(node);
            }
        }
    }

    std::size_t size() const { return nodes_.size(); }
    aiNode const& node(std::size_t index) const { return *nodes_[index].source; }

    /// The first node of that name.
    std::optional<std::size_t> find(aiString const& name) const {
        auto const at = by_name_.find(name.C_Str());
        return at == by_name_.end() ? std::nullopt : std::optional(at->second);
    }

    /// Each node's space to the world's at a time in seconds; without an animation at any time.
    std::vector<glm::mat4> to_world(double seconds) const {
        std::vector<glm::mat4> result;
        result.reserve(nodes_.size());
        for (auto const& entry : nodes_) {
            auto const& parent = entry.parent ? result[*entry.parent] : to_y_up_;
            result.push_back(entry.channel != nullptr
                                 ? parent * transform_at(*entry.channel, entry.rest, seconds * entry.ticks_per_second) *
                                       entry.fixed
                                 : parent * entry.fixed);
        }
        return result;
    }

private:
    struct placed_node {
        aiNode const* source = nullptr;
        std::optional<std::size_t> parent;
        aiNodeAnim const* channel = nullptr;
        double ticks_per_second = 1;
        aiMatrix4x4 rest;      ///< what the channel stands for
        glm::mat4 fixed{1.0f}; ///< comes after the channel, or is all there is
    };

    // Puts the node's channel where the first of the nodes stands that FBX's reader made of its transformation.
    void replace_helpers(std::size_t node) {
        auto const tag = std::string(nodes_[node].source->mName.C_Str()) + "_$AssimpFbx$_";
        auto rest = nodes_[node].rest;
        auto first = node;
        nodes_[node].fixed = glm::mat4(1);
        while (auto const above = nodes_[first].parent) {
            auto& helper = nodes_[*above];
            std::string const name = helper.source->mName.C_Str();
            if (name.rfind(tag, 0) != 0) {
                break;
            }
            first = *above;
            if (helper.channel == nullptr && name.rfind(tag + "Geometric", 0) != 0) {
                rest = helper.rest * rest;
                helper.fixed = glm::mat4(1);
            }
        }
        nodes_[node].rest = rest;
        if (first != node && nodes_[first].channel == nullptr) {
            nodes_[first].channel = std::exchange(nodes_[node].channel, nullptr);
            nodes_[first].ticks_per_second = nodes_[node].ticks_per_second;
            nodes_[first].rest = rest;
        }
    }

    void list(aiNode const& node, std::optional<std::size_t> parent) {
        auto const index = nodes_.size();
        nodes_.push_back({&node, parent, nullptr, 1, node.mTransformation, to_glm(node.mTransformation)});
        by_name_.emplace(node.mName.C_Str(), index);
        for (unsigned i = 0; i < node.mNumChildren; ++i) {
            list(*node.mChildren[i], index);
        }
    }

    glm::mat4 to_y_up_;
    std::vector<placed_node> nodes_;
    std::map<std::string, std::size_t> by_name_;
};

} // namespace genrender::examples
