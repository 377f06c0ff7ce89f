// SPDX-License-Identifier: MIT
// The example's engine as C11, under a name of its own.
#define ENGINE_FUNCTION engine_of_c11
#include "examples/engine_in_c/blur_engine.c"
