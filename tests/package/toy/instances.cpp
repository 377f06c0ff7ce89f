// SPDX-License-Identifier: MIT
// The one unit of a program that has the library's instances.
// docs:begin instances
#define GENRENDER_INSTANCES_HERE
#include <genrender/genrender.hpp>
// docs:end
