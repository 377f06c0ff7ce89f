// SPDX-License-Identifier: MIT
// A curve of an FBX file, whose segments may be cubic or steps, as one of straight lines that looks the same.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <stdexcept>
#include <vector>

namespace genrender::examples {

/// What FBX says of the way from a key to the next.
struct fbx_key_attributes {
    std::int32_t flags = 0;    ///< 2 a step, 4 straight, 8 cubic; with a cubic one how its tangents are found
    float right_slope = 0;     ///< of a tangent that was set, per second
    float next_left_slope = 0; ///< at the next key
    std::uint32_t weights = 0; ///< lengths of both tangents, 16 bits each, in ten thousandths of the way
};

/// A curve: value i at time i, in FBX's ticks.
struct fbx_curve {
    std::vector<std::int64_t> times;
    std::vector<float> values;
    std::vector<fbx_key_attributes> attributes; ///< of each key
};

namespace detail {

inline constexpr double fbx_ticks_per_second = 46186158000.0;

enum fbx_key_flag : std::int32_t {
    fbx_step = 0x2,
    fbx_cubic = 0x8,
    fbx_next_value = 0x100, ///< of a step: at once to the next value
    fbx_found = 0x300,      ///< of a cubic: the tangent is found from the neighbours
    fbx_flat_at_equals = 0x1000,
    fbx_no_overshoot = 0x4000,
    fbx_weighted_right = 0x1000000,
    fbx_weighted_next_left = 0x2000000
};

/// A file that is not as FBX says: it is left to others, who say what is wrong with it.
struct not_understood : std::runtime_error {
    not_understood() : std::runtime_error("FBX") {}
};

inline void require_understood(bool is_so) {
    if (!is_so) {
        throw not_understood();
    }
}

/// Attributes of each key from those of runs of keys.
inline std::vector<fbx_key_attributes> attributes_of_keys(std::vector<fbx_key_attributes> const& runs,
                                                          std::vector<std::int32_t> const& counts, std::size_t keys) {
    require_understood(runs.size() == counts.size());
    std::vector<fbx_key_attributes> result;
    for (std::size_t i = 0; i < runs.size(); ++i) {
        require_understood(counts[i] >= 0 && static_cast<std::size_t>(counts[i]) <= keys - result.size());
        result.insert(result.end(), static_cast<std::size_t>(counts[i]), runs[i]);
    }
    return result;
}

/// The tangents of a curve, per second, and their lengths as shares of the way.
class fbx_tangents {
public:
    explicit fbx_tangents(fbx_curve const& curve) : curve_(curve) {}

    double right_slope(std::size_t key) const {
        auto const& own = curve_.attributes[key];
        return (own.flags & fbx_found) != 0 ? found_slope(key) : static_cast<double>(own.right_slope);
    }
    double left_slope(std::size_t key) const {
        auto const& own = curve_.attributes[key];
        auto const is_found = (own.flags & fbx_cubic) != 0 && (own.flags & fbx_found) != 0;
        return is_found ? found_slope(key) : static_cast<double>(curve_.attributes[key - 1].next_left_slope);
    }
    double right_weight(std::size_t key) const {
        auto const& own = curve_.attributes[key];
        return (own.flags & fbx_weighted_right) != 0 ? share(own.weights & 0xffffu) : 1 / 3.0;
    }
    double left_weight(std::size_t key) const {
        auto const& before = curve_.attributes[key - 1];
        return (before.flags & fbx_weighted_next_left) != 0 ? share(before.weights >> 16) : 1 / 3.0;
    }
    double seconds_after(std::size_t key) const {
        return static_cast<double>(curve_.times[key + 1] - curve_.times[key]) / fbx_ticks_per_second;
    }
    double rise_after(std::size_t key) const {
        return static_cast<double>(curve_.values[key + 1]) - static_cast<double>(curve_.values[key]);
    }

private:
    static double share(std::uint32_t weight) { return std::min(static_cast<double>(weight) * 1e-4, 1.0); }

    /// From the key before to the key after; flat at the ends, and where a curve that must not overshoot turns.
    double found_slope(std::size_t key) const {
        if (key == 0 || key + 1 == curve_.times.size()) {
            return 0;
        }
        auto const flags = curve_.attributes[key].flags;
        auto const before = rise_after(key - 1);
        auto const after = rise_after(key);
        auto const slope = (before + after) / (seconds_after(key - 1) + seconds_after(key));
        if ((flags & fbx_flat_at_equals) != 0 && (before == 0 || after == 0)) {
            return 0;
        }
        if ((flags & fbx_no_overshoot) != 0) {
            if (before * after <= 0) {
                return 0;
            }
            auto const most = std::min(std::abs(before) / (seconds_after(key - 1) * left_weight(key)),
                                       std::abs(after) / (seconds_after(key) * right_weight(key)));
            return std::copysign(std::min(std::abs(slope), most), slope);
        }
        return slope;
    }

    fbx_curve const& curve_;
};

/// At share u of a cubic Bezier curve that begins at 0.
inline double bezier_at(double u, double second, double third, double last) {
    auto const rest = 1 - u;
    return 3 * u * rest * (rest * second + u * third) + u * u * u * last;
}

} // namespace detail

/// The curve with keys added such that straight lines between all keys follow it: within 2 in 10,000 of a segment's
/// rise where that lasts longer than a frame, and through the middle of shorter ones, which are of motion sampled a
/// frame. Nothing if it consists of straight lines already, or if its parts differ in number or its times do not grow.
inline std::optional<fbx_curve> straightened(fbx_curve const& curve) {
    auto const count = curve.times.size();
    if (curve.values.size() != count || curve.attributes.size() != count ||
        std::adjacent_find(curve.times.begin(), curve.times.end(), std::greater_equal<>()) != curve.times.end()) {
        return std::nullopt;
    }
    detail::fbx_tangents const tangents(curve);
    fbx_curve result;
    auto const add = [&](std::int64_t time, float value, std::int64_t end) {
        if (time > result.times.back() && time < end) {
            result.times.push_back(time);
            result.values.push_back(value);
        }
    };
    for (std::size_t i = 0; i < count; ++i) {
        result.times.push_back(curve.times[i]);
        result.values.push_back(curve.values[i]);
        if (i + 1 == count) {
            break;
        }
        auto const flags = curve.attributes[i].flags;
        auto const begin = curve.times[i];
        auto const end = curve.times[i + 1];
        auto const rise = tangents.rise_after(i);
        if ((flags & detail::fbx_step) != 0 && rise != 0) {
            auto const at_once = (flags & detail::fbx_next_value) != 0;
            add(at_once ? begin + 1 : end - 1, curve.values[at_once ? i + 1 : i], end);
        }
        if ((flags & detail::fbx_cubic) == 0) {
            continue;
        }

        // The way as a Bezier curve in time and value
        auto const seconds = tangents.seconds_after(i);
        auto const out = seconds * tangents.right_weight(i);
        auto const in = seconds * tangents.left_weight(i + 1);
        auto const second = out * tangents.right_slope(i);
        auto const third = rise - in * tangents.left_slope(i + 1);
        auto const time_at = [&](double u) { return detail::bezier_at(u, out, seconds - in, seconds); };
        auto const rise_at = [&](double u) { return detail::bezier_at(u, second, third, rise); };
        auto bend = 0.0;
        for (double const u : {0.25, 0.5, 0.75}) {
            bend = std::max(bend, std::abs(rise_at(u) - rise * time_at(u) / seconds));
        }
        if (!(bend > 1e-4 * std::abs(rise) + 1e-7)) {
            continue;
        }
        auto const parts = seconds < 1.01 / 24 ? 2.0 : std::clamp(std::floor(seconds * 192), 8.0, 64.0);
        for (double part = 1; part < parts; ++part) {
            auto const u = part / parts;
            add(begin + std::llround(time_at(u) * detail::fbx_ticks_per_second),
                static_cast<float>(static_cast<double>(curve.values[i]) + rise_at(u)), end);
        }
    }
    return result.times.size() > count ? std::optional(result) : std::nullopt;
}

} // namespace genrender::examples
