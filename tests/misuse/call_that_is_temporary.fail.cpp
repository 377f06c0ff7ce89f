// SPDX-License-Identifier: MIT
// A call that ends before the processor does.
// expected (g++): cannot bind non-const lvalue reference
// expected (clang++): expects an lvalue for 1st argument
#include "right_models.hpp"

#include <genrender/attention/plain_attention.hpp>

void run() { genrender::plain_attention{}(right_call{}); }
