// SPDX-License-Identifier: MIT
// What a file costs that renders with a denoiser of its own.
#include "use_of_render.hpp"
