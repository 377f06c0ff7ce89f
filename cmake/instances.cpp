// SPDX-License-Identifier: MIT
// What this project's programs of many units compile once (genrender/compiled.hpp).
#include <genrender/compiled.hpp>
#include <genrender/reference.hpp>
