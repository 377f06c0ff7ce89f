// SPDX-License-Identifier: MIT
// Eq. 6 on a CUDA device: one kernel that gathers by rows and mixes, for features of float, __half and __nv_bfloat16.
#pragma once

#include <cuda_bf16.h>
#include <cuda_fp16.h>
#include <cuda_runtime.h>

#include <cstddef>
#include <cstdint>

namespace genrender::adapters::cuda {

/// Padded rows of the frames of a call in a device's memory, the arrays of padded_rows one behind the other. Owns nothing.
struct device_rows {
    std::int32_t const* index = nullptr; ///< [rows, width] row of F_KF; any valid one in an entry that is not used
    float const* weights = nullptr;      ///< [rows, width] alpha times the plan's; 0 in an entry that is not used
    float const* own = nullptr;          ///< [rows] 1 - alpha, or 1 where no keyframe covers the token
    std::int32_t rows = 0;               ///< frames * tokens of the call
    std::int32_t width = 0;              ///< entries of a row
};

/// Rows of a call of any lengths in a device's memory, the arrays of call_rows. Owns nothing.
struct device_row_lists {
    std::int32_t const* offsets = nullptr; ///< [rows + 1] where the entries of a row begin, and those of the next
    std::int32_t const* index = nullptr;   ///< row of F_KF, one an entry
    float const* weights = nullptr;        ///< alpha times the plan's, one an entry
    float const* own = nullptr;            ///< [rows] 1 - alpha, or 1 where no keyframe covers the token
    std::int32_t rows = 0;                 ///< frames * tokens of the call
};

namespace detail {

/// The entries of a row.
struct entry_range {
    std::int64_t begin;
    std::int64_t end;
};
__device__ inline entry_range entries_of(device_rows const& plan, std::int64_t row) {
    return {row * plan.width, (row + 1) * plan.width};
}
__device__ inline entry_range entries_of(device_row_lists const& plan, std::int64_t row) {
    return {plan.offsets[row], plan.offsets[row + 1]};
}

inline bool is_valid(device_rows const& plan) { return plan.rows >= 0 && plan.width >= 0; }
inline bool is_valid(device_row_lists const& plan) { return plan.rows >= 0; }

/// So many values that are read or written at once.
template <class T, int N>
struct alignas(sizeof(T) * N) pack {
    T values[N];
};

__device__ inline float to_float(float x) { return x; }
__device__ inline float to_float(__half x) { return __half2float(x); }
__device__ inline float to_float(__nv_bfloat16 x) { return __bfloat162float(x); }

__device__ inline void round_to(float& to, float x) { to = x; }
__device__ inline void round_to(__half& to, float x) { to = __float2half_rn(x); }
__device__ inline void round_to(__nv_bfloat16& to, float x) { to = __float2bfloat16_rn(x); }

/// Row y of a block is a row of F, whose packs its threads share out.
template <int N, class Real, class Stored, class Rows>
__global__ void mix_rows_kernel(Real* F, Stored const* F_KF, Rows plan, std::int32_t packs) {
    auto const row = static_cast<std::int64_t>(blockIdx.x) * blockDim.y + threadIdx.y;
    if (row >= plan.rows) {
        return;
    }
    auto const [begin, end] = entries_of(plan, row);
    float const own = plan.own[row];
    if (own == 1.0f && (begin == end || plan.weights[begin] == 0.0f)) {
        return; // Not covered: F stays.
    }
    auto* const to = reinterpret_cast<pack<Real, N>*>(F) + row * packs;
    for (std::int32_t p = static_cast<std::int32_t>(threadIdx.x); p < packs;
         p += static_cast<std::int32_t>(blockDim.x)) {
        auto mine = to[p];
        float sum[N];
        for (int i = 0; i < N; ++i) {
            sum[i] = own == 0.0f ? 0.0f : own * to_float(mine.values[i]);
        }
        for (auto e = begin; e < end; ++e) {
            float const weight = plan.weights[e];
            if (weight != 0.0f) {
                auto const from =
                    reinterpret_cast<pack<Stored, N> const*>(F_KF)[std::int64_t{plan.index[e]} * packs + p];
                for (int i = 0; i < N; ++i) {
                    sum[i] = fmaf(weight, to_float(from.values[i]), sum[i]);
                }
            }
        }
        for (int i = 0; i < N; ++i) {
            round_to(mine.values[i], sum[i]);
        }
        to[p] = mine;
    }
}

template <int N, class Real, class Stored, class Rows>
cudaError_t launch(Real* F, Stored const* F_KF, Rows plan, std::int32_t channels, cudaStream_t stream) {
    auto const packs = channels / N;
    dim3 threads(8, 32);
    while (threads.x < 128 && static_cast<std::int32_t>(threads.x) * 2 <= packs) {
        threads = dim3(threads.x * 2, threads.y / 2);
    }
    auto const rows = static_cast<unsigned>(plan.rows);
    mix_rows_kernel<N><<<(rows + threads.y - 1) / threads.y, threads, 0, stream>>>(F, F_KF, plan, packs);
    return cudaGetLastError();
}

} // namespace detail

/// [GR eq. 6] Replaces F [rows, channels] by F_out = own * F_hat + sum of weights * F_KF[index] by device_rows or
/// device_row_lists, with F_KF read as [keyframes * tokens, channels]; both row-major without gaps in the device's memory, of float, __half or __nv_bfloat16 each.
/// Sums are of float and rounded once. A row without weights stays to the bit. F is read and written once, F_bar is never in
/// memory. Does not wait: the arrays must live until `stream` has come by. Returns what the launch returned, and
/// cudaErrorInvalidValue for negative extents; an index beyond F_KF is not noticed.
template <class Real, class Stored, class Rows>
cudaError_t mix_rows(Real* F, Stored const* F_KF, Rows plan, std::int32_t channels, cudaStream_t stream = nullptr) {
    if (!detail::is_valid(plan) || channels < 0) {
        return cudaErrorInvalidValue;
    }
    if (plan.rows == 0 || channels == 0) {
        return cudaSuccess;
    }
    constexpr int wide = 16 / static_cast<int>(sizeof(Real) > sizeof(Stored) ? sizeof(Real) : sizeof(Stored));
    auto const is_aligned = [](void const* pointer, std::size_t bytes) {
        return reinterpret_cast<std::uintptr_t>(pointer) % bytes == 0;
    };
    if (channels % wide == 0 && is_aligned(F, wide * sizeof(Real)) && is_aligned(F_KF, wide * sizeof(Stored))) {
        return detail::launch<wide>(F, F_KF, plan, channels, stream);
    }
    return detail::launch<1>(F, F_KF, plan, channels, stream);
}

} // namespace genrender::adapters::cuda
