// SPDX-License-Identifier: MIT
// Random numbers one after another, for a program that invents a scene: the same for the same seed and number of scene.
#pragma once

#include <genrender/core/random.hpp>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include <cmath>
#include <cstdint>
#include <numbers>

namespace genrender::examples {

/// A sequence of draws. Two with different seeds or numbers are independent.
class random_draw {
public:
    random_draw(std::uint64_t seed, std::uint32_t number) : seed_(seed), number_(number) {}

    /// Uniform in [lowest, highest).
    float uniform(float lowest, float highest) {
        auto const value = uniform_value(seed_, random_stream::user, {number_, drawn_++, 0});
        return lowest + (highest - lowest) * static_cast<float>(value);
    }

    /// A whole number in [0, bound), bound > 0.
    std::uint32_t below(std::uint32_t bound) {
        return uniform_below(bound, seed_, random_stream::user, {number_, drawn_++, 0});
    }

    /// True with this probability.
    bool chance(float probability) { return uniform(0, 1) < probability; }

    /// A direction, uniform on the unit sphere.
    glm::vec3 direction() {
        auto const y = uniform(-1, 1);
        auto const angle = uniform(0, 2 * std::numbers::pi_v<float>);
        auto const radius = std::sqrt(1 - y * y);
        return {radius * std::cos(angle), y, radius * std::sin(angle)};
    }

private:
    std::uint64_t seed_;
    std::uint32_t number_;
    std::uint32_t drawn_ = 0;
};

} // namespace genrender::examples
