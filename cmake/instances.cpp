// SPDX-License-Identifier: MIT
// The library's instances, which this project's larger programs compile once.
#define GENRENDER_INSTANCES_HERE
#include <genrender/genrender.hpp>
#include <genrender/reference.hpp>
