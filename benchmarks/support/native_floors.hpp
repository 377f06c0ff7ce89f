// SPDX-License-Identifier: MIT
// Floors of arithmetic by Eigen, compiled for this machine's processor whatever the flags of the benchmarks are.
#pragma once

#include <cstddef>
#include <string>

namespace genrender::benchmarks {

/// Writes C = A B of row-major matrices A [rows, inner] and B [inner, columns], on one thread.
[[gnu::visibility("default")]] void native_product(float* C, float const* A, float const* B, std::size_t rows,
                                                   std::size_t inner, std::size_t columns);

/// Writes x / (1 + exp(-x)) for each number of `in`, after all have been read once.
[[gnu::visibility("default")]] void native_silu(float* out, float const* in, std::size_t count);

/// The widest instruction set that they use.
[[gnu::visibility("default")]] std::string native_vectors();

} // namespace genrender::benchmarks
