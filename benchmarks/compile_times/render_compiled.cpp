// SPDX-License-Identifier: MIT
// The same where the library's instances are compiled in another file (core/instance.hpp).
#define GENRENDER_COMPILED
#include "use_of_render.hpp"
