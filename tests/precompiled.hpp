// SPDX-License-Identifier: MIT
// The slow headers of other projects, compiled once for all test executables.
#pragma once

#include <Eigen/Core>
#include <doctest/doctest.h>
#include <glm/glm.hpp>
#if __has_include(<xtensor/containers/xtensor.hpp>)
#include <xtensor/containers/xtensor.hpp>
#else
#include <xtensor/xtensor.hpp>
#endif

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <functional>
#include <limits>
#include <mutex>
#include <optional>
#include <span>
#include <sstream>
#include <string>
#include <thread>
#include <vector>
