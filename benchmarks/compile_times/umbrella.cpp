// SPDX-License-Identifier: MIT
// What a file costs that includes the whole library.
#include <genrender/genrender.hpp>

#include "use_of_kernels.hpp"
