// SPDX-License-Identifier: MIT
// What a file costs that includes the reference network.
#include <genrender/reference.hpp>
