// SPDX-License-Identifier: MIT
// What a file costs that includes only kernels on raw views, whose instances are compiled in another file.
#define GENRENDER_COMPILED
#include <genrender/attention/scaled_dot_product.hpp>
#include <genrender/blending/mix_rows.hpp>

#include "use_of_kernels.hpp"
