// SPDX-License-Identifier: MIT
// The same, where one header is included by itself.
// flags: -std=c++17
// expected: genrender is C++20: compile with -std=c++20 or later
#include <genrender/attention/attention_site.hpp>
