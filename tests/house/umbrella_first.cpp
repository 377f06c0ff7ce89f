// SPDX-License-Identifier: MIT
// The first of two translation units that include the whole library.
#include <genrender/genrender.hpp>

bool second_throws_what_first_catches();

int main() { return second_throws_what_first_catches() ? 0 : 1; }
