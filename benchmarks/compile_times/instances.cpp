// SPDX-License-Identifier: MIT
// What the file costs that has the instances.
#define GENRENDER_INSTANCES_HERE
#include <genrender/genrender.hpp>
