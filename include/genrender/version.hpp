// SPDX-License-Identifier: MIT
// The version of the library as macros. CMakeLists.txt reads it from here, and the packages from there.
#pragma once

#include <genrender/core/begin_header.inl>

/// Grows when the interface breaks. Before 1.0 the minor version does that.
#define GENRENDER_VERSION_MAJOR 0
/// Grows when the interface grows; while the major version is 0, also when it breaks.
#define GENRENDER_VERSION_MINOR 2
/// Grows when nothing but faults is mended.
#define GENRENDER_VERSION_PATCH 0

/// One number that grows with the version, for the preprocessor to compare: 10000 major + 100 minor + patch.
#define GENRENDER_VERSION (10000 * GENRENDER_VERSION_MAJOR + 100 * GENRENDER_VERSION_MINOR + GENRENDER_VERSION_PATCH)
/// The version as text: `0.2.0`.
#define GENRENDER_VERSION_STRING "0.2.0"

#include <genrender/core/end_header.inl>
