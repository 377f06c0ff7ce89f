// SPDX-License-Identifier: MIT
// What a program with LibTorch adds so that eq. 6 is one kernel on CUDA devices: this unit, compiled by nvcc.
#include <genrender/adapters/cuda/torch_mix.cuh>

static bool const is_fused = genrender::adapters::cuda::use_fused_mix();
