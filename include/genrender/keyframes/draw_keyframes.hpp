// SPDX-License-Identifier: MIT
// [GR alg. 1: KF] The keyframes of a step, drawn and shuffled; a pure function of seed and step.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/error.hpp>
#include <genrender/core/index.hpp>
#include <genrender/core/random.hpp>

#include <cstddef>
#include <cstdint>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace genrender {

/// How the keyframes of a step are chosen.
enum class keyframe_drawing : std::uint8_t {
    uniform,    ///< any m different frames, all alike likely (default)
    stratified, ///< one frame of each of m equal stretches of the animation
    fixed       ///< the same given frames in every step, in the order given
};

/// Which frames become keyframes.
struct keyframe_settings {
    std::size_t count = 4; ///< m, at most the number of frames; ignored by keyframe_drawing::fixed
    keyframe_drawing drawing = keyframe_drawing::uniform; ///< how they are chosen
    std::vector<frame_index> frames;                      ///< for keyframe_drawing::fixed
    std::uint64_t seed = 0;                               ///< of the drawing alone: the noise has its own
};

/// KF = shuffle({i_1, ..., i_m}): different frames of an animation of `frame_count` frames, in an order drawn anew each
/// `step`, which is also the order in which their features fill the texture. Every step can be asked for alone; other
/// frames than keyframes are drawn from a `stream` of their own. Throws value_error if no keyframe is asked for, more
/// than there are frames, or fixed ones repeat or do not exist.
inline std::vector<frame_index> draw_keyframes(keyframe_settings const& settings, std::size_t frame_count,
                                               std::size_t step, random_stream stream = random_stream::keyframes) {
    if (settings.drawing == keyframe_drawing::fixed) {
        require_value(!settings.frames.empty(), "draw_keyframes", "frames", "empty", "at least one keyframe");
        std::set<frame_index> seen;
        for (auto const frame : settings.frames) {
            require_value(frame.value < frame_count && seen.insert(frame).second, "draw_keyframes", "frames",
                          frame.value, ("different frames below " + std::to_string(frame_count)).c_str());
        }
        return settings.frames;
    }
    auto const m = settings.count;
    require_value(m >= 1 && m <= frame_count, "draw_keyframes", "count", m,
                  ("1 to the animation's " + std::to_string(frame_count) + " frames").c_str());
    auto const draw_below = [&](std::size_t bound, std::uint32_t draw) {
        return uniform_below(static_cast<std::uint32_t>(bound), settings.seed, stream,
                             {static_cast<std::uint32_t>(step), draw, 0});
    };

    std::vector<frame_index> keyframes;
    if (settings.drawing == keyframe_drawing::stratified) {
        for (std::size_t k = 0; k < m; ++k) {
            auto const begin = k * frame_count / m;
            auto const end = (k + 1) * frame_count / m;
            keyframes.push_back(
                {static_cast<std::uint32_t>(begin + draw_below(end - begin, static_cast<std::uint32_t>(k)))});
        }
    } else {
        for (std::uint32_t i = 0; i < frame_count; ++i) {
            keyframes.push_back({i});
        }
    }
    // Shuffle the front m places (Fisher-Yates), which also draws without replacement.
    auto const offset = static_cast<std::uint32_t>(m);
    for (std::size_t k = 0; k < m && k + 1 < keyframes.size(); ++k) {
        auto const other = k + draw_below(keyframes.size() - k, offset + static_cast<std::uint32_t>(k));
        std::swap(keyframes[k], keyframes[other]);
    }
    keyframes.resize(m);
    return keyframes;
}

} // namespace genrender

#include <genrender/core/end_header.inl>
