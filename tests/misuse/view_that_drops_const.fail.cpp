// SPDX-License-Identifier: MIT
// A view that would change what its owner holds constant.
// expected: conversion from 'const genrender::stack<float, 2>' to
#include <genrender/core/stack.hpp>

void run(genrender::stack<float, 2> const& owner) { genrender::strided_view<float, 2> view = owner; }
