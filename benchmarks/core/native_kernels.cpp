// SPDX-License-Identifier: MIT
// Compiled with -march=native and GENRENDER_OWN_FLAGS_ONLY into a library that shares none of its code.
#include <benchmarks/core/native_kernels.hpp>

#include <benchmarks/core/hot_kernels.hpp>

namespace genrender::benchmarks {

namespace {

kernel_run& prepared() {
    static kernel_run run;
    return run;
}

} // namespace

void prepare_native_kernel(std::size_t index) {
    prepared() = nullptr;
    prepared() = hot_kernels.at(index).make();
}

void run_native_kernel() { prepared()(); }

} // namespace genrender::benchmarks
