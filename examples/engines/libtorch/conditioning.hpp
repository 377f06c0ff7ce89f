// SPDX-License-Identifier: MIT
// What a network of LibTorch is told in the comparison, and the device that it runs on.
#pragma once

#include "../comparison.hpp"

#include <genrender/adapters/torch_denoiser.hpp>

#include <cstdlib>

namespace genrender::examples {

using namespace genrender::adapters;

/// The device that the environment variable GENRENDER_ENGINE_DEVICE names, else the processor.
inline at::Device chosen_device() {
    auto const* const named = std::getenv("GENRENDER_ENGINE_DEVICE");
    return at::Device(named != nullptr ? named : "cpu");
}

// docs:begin libtorch_denoiser
/// What a case tells a network; `hints` are as the network takes them, on its device.
inline torch_conditioning conditioning_of(engine_case const& given, at::Tensor const& hints) {
    auto const& told = given.conditioning;
    auto const& config = given.config;
    auto const rows = [&](auto const& text) { return tensor_of(text.view()).unsqueeze(0).to(hints.device()); };
    return {.hints = hints,
            .prompts = {rows(told.empty_prompt), rows(told.prompt)},
            .guidance_scale = told.guidance_scale,
            .predicted = config.prediction_type,
            .schedule = discrete_noise_schedule(
                scaled_linear_alphas_cumprod(config.beta_start, config.beta_end, config.num_train_timesteps))};
}

/// A network as a denoiser of a case.
inline torch_denoiser denoiser_of(engine_case const& given, torch_network network, at::Tensor const& hints) {
    auto const [frames, channels, height, width] = given.conditioning.hint.extents();
    auto const scale = given.config.hint_scale();
    return {
        std::move(network), conditioning_of(given, hints), given.config.in_channels, {height / scale, width / scale}};
}
// docs:end

} // namespace genrender::examples
