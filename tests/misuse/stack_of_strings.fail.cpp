// SPDX-License-Identifier: MIT
// A stack of elements that own memory of their own.
// expected: stack: elements are copied as bytes, so they must be trivially copyable
#include <genrender/core/stack.hpp>

#include <string>

void run() { genrender::stack<std::string, 1> names({3}); }
