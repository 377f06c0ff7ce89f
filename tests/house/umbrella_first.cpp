// SPDX-License-Identifier: MIT
// The first of two translation units that include the whole library.
#include <genrender/evaluation.hpp>
#include <genrender/genrender.hpp>
#include <genrender/inspection.hpp>
#include <genrender/reference.hpp>
#include <genrender/scene.hpp>

// kernels_on_views.cpp knows these packages by their macros, which have to be theirs.
#if !defined(XTENSOR_VERSION_MAJOR) || !defined(GLM_VERSION_MAJOR)
#error "the whole library includes xtensor and GLM, and one of them does not say so any more"
#endif

bool second_throws_what_first_catches();

int main() { return second_throws_what_first_catches() ? 0 : 1; }
