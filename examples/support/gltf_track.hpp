// SPDX-License-Identifier: MIT
// The keys of one animated property of a glTF file, and its value between them: held, straight, round or by a spline.
#pragma once

#include <glm/gtc/quaternion.hpp>

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

namespace genrender::examples {

/// How a property goes from key to key.
enum class gltf_interpolation {
    step,   ///< it stays and then jumps
    linear, ///< it goes straight; a rotation goes round, the shorter way
    cubic   ///< by a Hermite spline whose tangents the file gives, a second
};

/// Keys of a property of `width` numbers; before the first and after the last key the nearest one holds.
struct gltf_track {
    gltf_interpolation interpolation = gltf_interpolation::linear;
    bool is_rotation = false;  ///< quaternions x, y, z, w
    std::size_t width = 0;     ///< numbers a key
    std::vector<float> times;  ///< of the keys, seconds, none before the one that precedes it; at least one
    std::vector<float> values; ///< [keys][width]; of a cubic one [keys][3][width]: in-tangent, value, out-tangent

    /// The value at a time.
    std::vector<float> at(double seconds) const {
        auto const later = std::upper_bound(times.begin(), times.end(), seconds,
                                            [](double t, float key) { return t < static_cast<double>(key); });
        if (later == times.begin() || later == times.end()) {
            auto const key = value_of(later == times.begin() ? 0 : times.size() - 1);
            return unit({key.begin(), key.end()});
        }
        auto const second = static_cast<std::size_t>(later - times.begin());
        auto const span = times[second] - times[second - 1];
        auto const factor = static_cast<float>(seconds - static_cast<double>(times[second - 1])) / span;
        return unit(between(second - 1, second, factor, span));
    }

private:
    std::span<float const> part_of(std::size_t key, std::size_t part) const {
        auto const parts = interpolation == gltf_interpolation::cubic ? 3u : 1u;
        return std::span(values).subspan((key * parts + part) * width, width);
    }

    std::span<float const> value_of(std::size_t key) const {
        return part_of(key, interpolation == gltf_interpolation::cubic ? 1 : 0);
    }

    std::vector<float> between(std::size_t first, std::size_t second, float s, float span) const {
        auto const a = value_of(first);
        auto const b = value_of(second);
        if (interpolation == gltf_interpolation::step) {
            return {a.begin(), a.end()};
        }
        if (interpolation == gltf_interpolation::linear && is_rotation) {
            auto const q = glm::slerp(glm::normalize(glm::quat(a[3], a[0], a[1], a[2])),
                                      glm::normalize(glm::quat(b[3], b[0], b[1], b[2])), s);
            return {q.x, q.y, q.z, q.w};
        }
        std::vector<float> result(width);
        for (std::size_t i = 0; i < width; ++i) {
            if (interpolation == gltf_interpolation::linear) {
                result[i] = a[i] + s * (b[i] - a[i]);
                continue;
            }
            auto const out = span * part_of(first, 2)[i];
            auto const in = span * part_of(second, 0)[i];
            result[i] = a[i] * (1 + 2 * s) * (1 - s) * (1 - s) + out * s * (1 - s) * (1 - s) +
                        b[i] * s * s * (3 - 2 * s) + in * s * s * (s - 1);
        }
        return result;
    }

    std::vector<float> unit(std::vector<float> value) const {
        if (is_rotation) {
            auto const q = glm::normalize(glm::quat(value[3], value[0], value[1], value[2]));
            return {q.x, q.y, q.z, q.w};
        }
        return value;
    }
};

} // namespace genrender::examples
