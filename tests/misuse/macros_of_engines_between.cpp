// SPDX-License-Identifier: MIT
// Macros of an engine's headers between two of ours, and nanoflann before and after them.
#include <genrender/core/strided_view.hpp>

#include <nanoflann.hpp>

#define EPS 1e-5f
#define N 1e-5f
#define K 1e-5f
#define Q 1e-5f
#define V 1e-5f
#define F 1e-5f
#define D 1e-5f
#define M 1e-5f
#define T 1e-5f
#define PI 1e-5f
#define check 1e-5f

#include <genrender/attention/scaled_dot_product.hpp>
#include <genrender/correspondence/nearest_samples.hpp>

#undef EPS
#include <nanoflann.hpp>
#define EPS 1e-5f

#include <genrender/correspondence/footprint_map.hpp>

int main() { return EPS < N ? 0 : 1; }
