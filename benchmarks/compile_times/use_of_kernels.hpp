// SPDX-License-Identifier: MIT
// The same use in both files, so that they differ in what they include.
#pragma once

#include <cstddef>
#include <span>

namespace genrender::benchmarks {

/// Attention and blending of one layer on an engine's memory. Not inline, or nobody would compile it.
void use_kernels(strided_view<float, 2> F, strided_view<float const, 2> Q,
                 std::span<key_value_view<float> const> blocks, strided_view<float const, 3> F_KF,
                 sparse_rows<float> const& rows) {
    scaled_dot_product(F, Q, blocks, 8);
    mix_rows(F, F_KF, rows, 0.7f);
}

} // namespace genrender::benchmarks
