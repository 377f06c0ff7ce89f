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

/// Whether all coordinates are finite numbers.
inline bool is_place(glm::vec3 const& p) { return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z); }

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

/// The weights of a mesh's morph targets at `time`; targets that the keys do not name keep `weights`.
inline void morph_weights_at(aiMeshMorphAnim const& channel, double time, std::vector<float>& weights) {
    if (channel.mNumKeys == 0) {
        return;
    }
    std::span<aiMeshMorphKey const> const keys(channel.mKeys, channel.mNumKeys);
    auto const at = interval_at(keys, time, aiAnimBehaviour_CONSTANT, aiAnimBehaviour_CONSTANT);
    for (unsigned i = 0; i < std::min(keys[at.first].mNumValuesAndWeights, keys[at.second].mNumValuesAndWeights); ++i) {
        auto const target = keys[at.first].mValues[i];
        if (target < weights.size()) {
            weights[target] = static_cast<float>(keys[at.first].mWeights[i] * (1 - at.factor) +
                                                 keys[at.second].mWeights[i] * at.factor);
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

/// All nodes of a scene, parents before children. Refers to the scene, which must outlive it.
class model_nodes {
public:
    /// At rest; `to_y_up` is put before the root.
    model_nodes(aiScene const& scene, glm::mat4 const& to_y_up) : to_y_up_(to_y_up) {
        list(*scene.mRootNode, std::nullopt);
    }

    /// Moved by these animations from now on, by the last one that names a node.
    void play(std::span<aiAnimation const* const> animations) {
        for (auto& entry : nodes_) {
            entry.channel = nullptr;
        }
        for (auto const* const animation : animations) {
            for (unsigned i = 0; i < animation->mNumChannels; ++i) {
                if (auto const node = find(animation->mChannels[i]->mNodeName)) {
                    nodes_[*node].channel = animation->mChannels[i];
                    nodes_[*node].ticks_per_second = ticks_per_second(*animation);
                }
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
            auto const local = entry.channel != nullptr ? transform_at(*entry.channel, entry.source->mTransformation,
                                                                       seconds * entry.ticks_per_second)
                                                        : to_glm(entry.source->mTransformation);
            result.push_back((entry.parent ? result[*entry.parent] : to_y_up_) * local);
        }
        return result;
    }

private:
    struct placed_node {
        aiNode const* source = nullptr;
        std::optional<std::size_t> parent;
        aiNodeAnim const* channel = nullptr;
        double ticks_per_second = 1;
    };

    void list(aiNode const& node, std::optional<std::size_t> parent) {
        auto const index = nodes_.size();
        nodes_.push_back({&node, parent});
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
