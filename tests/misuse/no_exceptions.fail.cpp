// SPDX-License-Identifier: MIT
// A compiler that is told not to know exceptions.
// flags: -std=c++20 -fno-exceptions
// expected: genrender tells errors by exceptions: compile without -fno-exceptions
#include <genrender/genrender.hpp>
