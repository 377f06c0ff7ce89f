// SPDX-License-Identifier: MIT
// Eq. 6 on tensors of LibTorch by the rows of a call, and the place of a kernel of your own for a kind of device.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/adapters/torch_plans.hpp>
#include <genrender/core/error.hpp>
#include <genrender/core/strided_view.hpp>

#include <ATen/core/Tensor.h>
#include <ATen/ops/addcmul.h>
#include <ATen/ops/embedding_bag.h>

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <tuple>

namespace genrender::adapters {

/// F_out of eq. 6 for F_hat [frames, tokens, channels] and F_KF [keyframes, tokens, channels] by rows on their device. It
/// may write into F_hat and return it; it returns an undefined tensor for scalars that it does not know.
using torch_mix_kernel = at::Tensor (*)(at::Tensor const& F_hat, at::Tensor const& F_KF, torch_rows const& rows);

/// The kernel that mix_torch_rows tries first for features on a kind of device; null for none, as at the start of a program.
/// Assign one before the first run: adapters/cuda/torch_mix.cuh has that for CUDA devices. Throws value_error for a kind
/// beyond those that LibTorch has.
inline std::atomic<torch_mix_kernel>& torch_mix_kernel_of(at::DeviceType kind) {
    static std::array<std::atomic<torch_mix_kernel>, c10::COMPILE_TIME_MAX_DEVICE_TYPES> kernels{};
    auto const number = static_cast<std::size_t>(kind);
    require_value(number < kernels.size(), "torch_mix_kernel_of", "kind", number, "a kind of device");
    return kernels[number];
}

/// F_out of eq. 6 in the scalars of F_hat: F_hat [frames, tokens, channels], F_KF [keyframes, tokens, channels], rows of a
/// call on their device. Without a kernel for the device it is one embedding_bag in float32 (float64 for such features)
/// and leaves F_hat as it is. Throws shape_error if there is not one row for each token of F_hat.
inline at::Tensor mix_torch_rows(at::Tensor const& F_hat, at::Tensor const& F_KF, torch_rows const& rows) {
    require_extents("mix_torch_rows", "rows", std::array{static_cast<std::size_t>(rows.own.size(0))},
                    std::array{static_cast<std::size_t>(F_hat.size(0) * F_hat.size(1))});
    if (auto const kernel = torch_mix_kernel_of(F_hat.device().type()).load()) {
        if (auto F_out = kernel(F_hat, F_KF, rows); F_out.defined()) {
            return F_out;
        }
    }
    auto const type = c10::promoteTypes(F_hat.scalar_type(), at::kFloat);
    auto const own = F_hat.reshape({-1, F_hat.size(2)}).to(type);
    auto const source = F_KF.reshape({-1, F_KF.size(2)}).to(type);
    constexpr std::int64_t sum = 0;
    auto const bag =
        at::embedding_bag(source, rows.index, rows.offsets, false, sum, false, rows.weights.to(type), true);
    return at::addcmul(std::get<0>(bag), own, rows.own.to(type)).view(F_hat.sizes()).to(F_hat.scalar_type());
}

} // namespace genrender::adapters

#include <genrender/core/end_header.inl>
