// SPDX-License-Identifier: MIT
// What a program that defines GENRENDER_COMPILED includes in one of its units, before any other header of genrender: the
// instances for float and double of what does not know its denoiser, compiled there once.
#pragma once

#define GENRENDER_HAS_INSTANCES
#include <genrender/genrender.hpp>
