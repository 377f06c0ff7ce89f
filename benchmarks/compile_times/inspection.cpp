// SPDX-License-Identifier: MIT
// What a file costs that includes what is worth knowing before a run.
#include <genrender/inspection.hpp>
