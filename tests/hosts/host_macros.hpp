// SPDX-License-Identifier: MIT
// Included before anything else of a host: the standard library, then macros that systems and old programs define.
#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <memory_resource>
#include <numeric>
#include <ranges>
#include <string>
#include <thread>
#include <variant>
#include <vector>

#define min(a, b) (((a) < (b)) ? (a) : (b))
#define max(a, b) (((a) > (b)) ? (a) : (b))
#define near
#define far
#define small char
#define I imaginary_unit()
#define EPS 1e-6
#define GENRENDER_HOST_MACROS
