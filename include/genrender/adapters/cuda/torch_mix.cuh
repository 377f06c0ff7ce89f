// SPDX-License-Identifier: MIT
// Eq. 6 of LibTorch's features on CUDA devices by the fused kernel: for a unit that nvcc compiles, of a program with LibTorch.
#pragma once

#include <genrender/adapters/cuda/mix_rows.cuh>
#include <genrender/adapters/torch_mix.hpp>

#include <ATen/core/Tensor.h>
#include <c10/cuda/CUDAGuard.h>
#include <c10/cuda/CUDAStream.h>

#include <cstdint>
#include <stdexcept>
#include <string>

namespace genrender::adapters::cuda {

namespace detail {

/// Calls `body` with a pointer to the elements of x; false for scalars that the kernel does not know.
template <class Body>
bool with_elements(at::Tensor const& x, Body const& body) {
    switch (x.scalar_type()) {
    case at::kFloat:
        body(static_cast<float*>(x.data_ptr()));
        return true;
    case at::kHalf:
        body(static_cast<__half*>(x.data_ptr()));
        return true;
    case at::kBFloat16:
        body(static_cast<__nv_bfloat16*>(x.data_ptr()));
        return true;
    default:
        return false;
    }
}

} // namespace detail

/// A torch_mix_kernel: writes F_out into F_hat where its memory has no gaps, else into a copy, and returns that. For float32,
/// float16 and bfloat16, those of F_hat and of F_KF being any two of them; undefined for other scalars. Runs on the stream
/// that LibTorch uses at the moment. Throws std::runtime_error if the kernel cannot be launched.
inline at::Tensor mix_torch_rows(at::Tensor const& F_hat, at::Tensor const& F_KF, torch_rows const& rows) {
    c10::cuda::CUDAGuard const guard(F_hat.device());
    auto const F = F_hat.contiguous();
    auto const source = F_KF.contiguous();
    device_row_lists const plan{rows.offsets.data_ptr<std::int32_t>(), rows.index.data_ptr<std::int32_t>(),
                                rows.weights.data_ptr<float>(), rows.own.data_ptr<float>(),
                                static_cast<std::int32_t>(rows.own.size(0))};
    auto const channels = static_cast<std::int32_t>(F.size(2));
    auto code = cudaSuccess;
    bool is_known = false;
    detail::with_elements(F, [&](auto* to) {
        is_known = detail::with_elements(source, [&](auto const* from) {
            code = mix_rows(to, from, plan, channels, c10::cuda::getCurrentCUDAStream().stream());
        });
    });
    if (code != cudaSuccess) {
        throw std::runtime_error(std::string("mix_torch_rows: ") + cudaGetErrorString(code));
    }
    return is_known ? F : at::Tensor();
}

/// Lets torch_attention_call::mix run the fused kernel on CUDA devices from now on; call it before the first run. In a unit
/// of nvcc's: `bool const is_fused = genrender::adapters::cuda::use_fused_mix();`. Returns true.
inline bool use_fused_mix() {
    torch_mix_kernel_of(at::kCUDA) = mix_torch_rows;
    return true;
}

} // namespace genrender::adapters::cuda
