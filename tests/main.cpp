// SPDX-License-Identifier: MIT
// doctest's main function, linked into the test executable of every room.
// Both names, because the precompiled header has read doctest's first half already, where the second implies the first.
#define DOCTEST_CONFIG_IMPLEMENT
#define DOCTEST_CONFIG_IMPLEMENT_WITH_MAIN
#include <doctest/doctest.h>
