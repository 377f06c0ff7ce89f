// SPDX-License-Identifier: MIT
// What rows of the table are measured by: how far latents are apart, and the processor's time.
#pragma once

#include <genrender/core/error.hpp>
#include <genrender/core/tensor.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <ctime>
#include <functional>

namespace genrender::examples {

/// The greatest difference of two stacks of latents, in parts of the range of the second. Throws shape_error if their
/// shapes differ.
inline double difference(latents<float> const& z, latents<float> const& reference) {
    require_extents("difference", "z", z.shape(), reference.shape());
    double greatest = 0;
    for (std::size_t i = 0; i < z.size(); ++i) {
        auto const apart = std::abs(static_cast<double>(z.data()[i]) - static_cast<double>(reference.data()[i]));
        greatest = apart <= greatest ? greatest : apart; // what is not a number stays
    }
    auto const [low, high] = std::minmax_element(reference.begin(), reference.end());
    return greatest / (static_cast<double>(*high) - static_cast<double>(*low));
}

/// Seconds of the processor's time, which other programs of the machine do not lengthen.
inline double seconds_of(std::function<void()> const& work) {
    auto const start = std::clock();
    work();
    return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
}

} // namespace genrender::examples
