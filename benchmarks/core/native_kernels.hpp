// SPDX-License-Identifier: MIT
// The hot kernels as a program has them that is compiled for this machine's processor alone.
#pragma once

#include <cstddef>

namespace genrender::benchmarks {

/// Makes the inputs of the kernel at this index of hot_kernels; those of the one before are gone.
[[gnu::visibility("default")]] void prepare_native_kernel(std::size_t index);

/// Runs it once.
[[gnu::visibility("default")]] void run_native_kernel();

} // namespace genrender::benchmarks
