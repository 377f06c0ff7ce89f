// SPDX-License-Identifier: MIT
// A whole network of random weights, small enough to be run a hundred times, with numbers for prompts.
#pragma once

#include "small_networks.hpp"

#include <genrender/reference/network_conditioning.hpp>
#include <genrender/reference/reference_network.hpp>

#include <cstddef>
#include <cstdint>
#include <utility>

namespace genrender::testing {

using namespace genrender::reference;

/// Tokens of a prompt of two words [3, 6], others for each number; 0 is the empty prompt [1, 6].
template <class Real>
stack<Real, 2> small_prompt(std::uint64_t number) {
    return random_stack<Real, 2>({number == 0 ? std::size_t{1} : std::size_t{3}, 6}, 100 + number);
}

/// What a network of small_config is told: inverse depth [frames, height, width] of pictures and a prompt's number.
template <class Real>
network_conditioning<Real> small_conditioning(strided_view<float const, 3> inverse_depth, std::uint64_t prompt,
                                              Real guidance_scale = 2) {
    return {.hint = depth_hint<Real>(inverse_depth),
            .prompt = small_prompt<Real>(prompt),
            .empty_prompt = small_prompt<Real>(0),
            .guidance_scale = guidance_scale};
}

/// The network of the weights of a seed and an architecture like small_config.
template <class Real>
reference_network<Real> seeded_network(network_conditioning<Real> conditioning, std::uint64_t seed = 1,
                                       any_loop loop = {}, unet_config const& config = small_config()) {
    auto unet_weights = weights<Real>::seeded(seed, "unet");
    auto control_weights = weights<Real>::seeded(seed, "controlnet");
    return {config, unet_weights, control_weights, std::move(conditioning), std::move(loop)};
}

} // namespace genrender::testing
