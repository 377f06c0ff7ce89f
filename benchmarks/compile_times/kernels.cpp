// SPDX-License-Identifier: MIT
// What a file costs that includes only kernels on raw views.
#include <genrender/attention/scaled_dot_product.hpp>
#include <genrender/blending/mix_rows.hpp>

#include "use_of_kernels.hpp"

#ifdef XTENSOR_VERSION_MAJOR
#error "the kernels on raw views include xtensor"
#endif
