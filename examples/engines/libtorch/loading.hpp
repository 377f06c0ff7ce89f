// SPDX-License-Identifier: MIT
// The network in ATen of a file's tensors.
#pragma once

#include "../comparison.hpp"
#include "network.hpp"

#include <genrender/adapters/torch_plans.hpp>

namespace genrender::examples {

// docs:begin libtorch_network
/// The network of a file's tensors.
inline engine::network network_of(named_tensors const& file, reference::unet_config const& config, at::Device device) {
    auto const& heads = config.attention_head_dim;
    engine::network network{{}, {heads.begin(), heads.end()}, static_cast<std::int64_t>(config.norm_num_groups)};
    for (auto const& [name, tensor] : file) {
        std::vector<std::int64_t> const shape(tensor.shape.begin(), tensor.shape.end());
        strided_view<float const, 1> const values(tensor.values.data(), {tensor.values.size()});
        network.tensors[name] = adapters::tensor_of(values).view(shape).to(device, at::kFloat, false, true);
    }
    return network;
}
// docs:end

} // namespace genrender::examples
