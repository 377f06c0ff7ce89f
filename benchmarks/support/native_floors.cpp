// SPDX-License-Identifier: MIT
// Compiled with -march=native into a library that shares none of its code: no other program part gets its instructions.
#include <benchmarks/support/native_floors.hpp>

#include <Eigen/Core>

namespace genrender::benchmarks {

void native_product(float* C, float const* A, float const* B, std::size_t rows, std::size_t inner,
                    std::size_t columns) {
    using matrix = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    auto const n = static_cast<Eigen::Index>(rows);
    auto const k = static_cast<Eigen::Index>(inner);
    auto const m = static_cast<Eigen::Index>(columns);
    Eigen::Map<matrix>(C, n, m).noalias() = Eigen::Map<matrix const>(A, n, k) * Eigen::Map<matrix const>(B, k, m);
}

void native_silu(float* out, float const* in, std::size_t count) {
    auto const n = static_cast<Eigen::Index>(count);
    Eigen::Map<Eigen::ArrayXf const> const x(in, n);
    auto const sum = x.sum();
    // Nothing becomes of the sum, and the compiler is not told so.
    asm volatile("" : : "g"(&sum) : "memory");
    Eigen::Map<Eigen::ArrayXf>(out, n) = x / (1 + (-x).exp());
}

std::string native_vectors() {
    std::string const all = Eigen::SimdInstructionSetsInUse();
    return all.substr(0, all.find(','));
}

} // namespace genrender::benchmarks
