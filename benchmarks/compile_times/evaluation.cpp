// SPDX-License-Identifier: MIT
// What a file costs that includes the measures of results.
#include <genrender/evaluation.hpp>
