// SPDX-License-Identifier: MIT
// A compiler that is told of an older C++.
// flags: -std=c++17
// expected: genrender is C++20: compile with -std=c++20 or later
#include <genrender/genrender.hpp>
