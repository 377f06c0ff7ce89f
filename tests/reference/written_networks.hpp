// SPDX-License-Identifier: MIT
// Small networks of random weights in a folder of diffusers' layout.
#pragma once

#include "small_networks.hpp"

#include <genrender/reference/controlnet.hpp>
#include <genrender/reference/diffusers_config.hpp>
#include <genrender/reference/safetensors_weights.hpp>
#include <genrender/reference/unet.hpp>

#include <concepts>
#include <filesystem>
#include <fstream>

namespace genrender::testing {

using namespace genrender::reference;

/// Builds both networks, by which their tensors are taken.
template <std::floating_point Real>
void build_networks(unet_config const& config, weights<Real>& unet_weights, weights<Real>& control_weights) {
    site_list sites({4, 4});
    controlnet<Real> const control(config, control_weights, sites);
    unet<Real> const network(config, unet_weights, sites);
}

/// Those of small_config and seed 3, in a folder that is removed with the object.
struct written_networks {
    temporary_file folder{"networks"};
    weights<float> unet_weights = weights<float>::seeded(3, "unet");
    weights<float> control_weights = weights<float>::seeded(3, "controlnet");

    explicit written_networks(safetensors_storage storage = safetensors_storage::f32) {
        auto const config = small_config();
        build_networks(config, unet_weights, control_weights);
        write("unet", unet_json(config), unet_weights, storage);
        write("controlnet", controlnet_json(config), control_weights, storage);
        std::filesystem::create_directories(path() / "scheduler");
        std::ofstream(path() / "scheduler" / "scheduler_config.json") << scheduler_json(config);
    }
    std::filesystem::path path() const { return folder.path(); }

private:
    void write(char const* name, nlohmann::json const& json, weights<float> const& tensors,
               safetensors_storage storage) const {
        std::filesystem::create_directories(path() / name);
        std::ofstream(path() / name / "config.json") << json;
        write_weights((path() / name / "diffusion_pytorch_model.safetensors").string(), tensors, storage);
    }
};

} // namespace genrender::testing
