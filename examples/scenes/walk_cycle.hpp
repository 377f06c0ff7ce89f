// SPDX-License-Identifier: MIT
// How joints turn in a walk: angles over one cycle, shaped after gait analysis (Perry & Burnfield, Gait Analysis).
#pragma once

#include <glm/trigonometric.hpp>

#include <cmath>
#include <numbers>

namespace genrender::scenes {

/// Joint angles of one leg and the arm of the same side at a moment of the walk, radians.
struct limb_angles {
    float hip;      ///< > 0: thigh forwards
    float knee;     ///< > 0: bent
    float ankle;    ///< > 0: toes up
    float shoulder; ///< > 0: upper arm forwards
    float elbow;    ///< > 0: bent
};

/// A bump of height 1 around `centre` on the circle of phases [0, 1).
inline float phase_bump(float phase, float centre, float width) {
    auto const distance = (phase - centre) - std::round(phase - centre);
    return std::exp(-(distance / width) * (distance / width));
}

/// The limbs of one side; phase 0 is the moment this side's heel meets the ground, 1 the next time it does; toes leave
/// the ground at about 0.62. The other side is half a cycle away.
inline limb_angles limbs_at(float phase) {
    auto const turn = 2 * std::numbers::pi_v<float>;
    limb_angles degrees{};
    degrees.hip = 9 + 26 * std::cos(turn * (phase + 0.04f)) - 3 * std::cos(2 * turn * (phase - 0.02f));
    degrees.knee = 3 + 11 * phase_bump(phase, 0.14f, 0.08f) + 58 * phase_bump(phase, 0.70f, 0.14f);
    degrees.ankle = 1 - 8 * phase_bump(phase, 0.07f, 0.05f) + 9 * phase_bump(phase, 0.43f, 0.13f) -
                    13 * phase_bump(phase, 0.64f, 0.06f) + 3 * phase_bump(phase, 0.85f, 0.1f);
    // The arm swings against the leg, and bends more when it is in front.
    degrees.shoulder = 3 - 25 * std::cos(turn * (phase - 0.02f));
    degrees.elbow = 24 - 13 * std::cos(turn * (phase - 0.06f));
    return {glm::radians(degrees.hip), glm::radians(degrees.knee), glm::radians(degrees.ankle),
            glm::radians(degrees.shoulder), glm::radians(degrees.elbow)};
}

/// How the trunk answers the legs; phase 0 is the moment the left heel meets the ground. Radians and scene units.
struct trunk_motion {
    float pelvis_turn; ///< about the vertical; > 0: left hip backwards
    float pelvis_drop; ///< > 0: right side lower
    float chest_turn;  ///< about the vertical, against the pelvis
    float sway;        ///< sideways, towards the left
};

inline trunk_motion trunk_at(float phase) {
    auto const turn = 2 * std::numbers::pi_v<float>;
    return {glm::radians(-7 * std::cos(turn * phase)), glm::radians(4 * std::sin(turn * (phase + 0.02f))),
            glm::radians(15 * std::cos(turn * phase)), 0.022f * std::sin(turn * (phase - 0.02f))};
}

} // namespace genrender::scenes
