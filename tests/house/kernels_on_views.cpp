// SPDX-License-Identifier: MIT
// The kernels on an engine's own arrays: whoever needs no more than them gets neither xtensor nor Eigen nor GLM nor
// nanoflann.
#include <genrender/attention/scaled_dot_product.hpp>
#include <genrender/blending/mix_rows.hpp>
#include <genrender/core/linear_combination.hpp>
#include <genrender/normalization/adain.hpp>

#if defined(XTENSOR_VERSION_MAJOR) || defined(EIGEN_WORLD_VERSION) || defined(GLM_VERSION_MAJOR) ||                    \
    defined(NANOFLANN_VERSION)
#error "the kernels include what only owners of stacks and scenes may"
#endif

#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>

/// One token attends to itself and becomes half of its keyframe's.
int main() {
    using namespace genrender;
    std::array<float, 2> F{};
    std::array<float, 2> const Q{1, 2};
    std::array<float, 2> const F_KF{3, 4};
    strided_view<float, 2> const out(F.data(), {1, 2});
    strided_view<float const, 2> const own(Q.data(), {1, 2});
    std::array<key_value_view<float>, 1> const blocks{key_value_view<float>{own, own}};
    scaled_dot_product(out, own, blocks, 1);
    std::array<std::uint32_t, 2> const offsets{0, 1};
    std::array<std::uint32_t, 1> const sources{0};
    std::array<float, 1> const weights{1};
    mix_rows(out, strided_view<float const, 3>(F_KF.data(), {1, 1, 2}), {offsets, sources, weights}, 0.5F);
    return std::abs(F[0] - 2) < 1e-6F && std::abs(F[1] - 3) < 1e-6F ? EXIT_SUCCESS : EXIT_FAILURE;
}
