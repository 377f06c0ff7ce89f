// SPDX-License-Identifier: MIT
// Macros of an engine's headers before ours, Eigen's and nanoflann's, with what those include included before.
#include <algorithm>
#include <array>
#include <atomic>
#include <cassert>
#include <chrono>
#include <cmath>
#include <complex>
#include <condition_variable>
#include <deque>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iostream>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <numeric>
#include <optional>
#include <ranges>
#include <set>
#include <span>
#include <sstream>
#include <string>
#include <thread>
#include <tuple>
#include <unordered_map>
#include <variant>
#include <vector>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

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
#define Success 0

#include <genrender/genrender.hpp>

#if !defined(EPS) || !defined(K) || !defined(Success) || !defined(check)
#error "the engine has lost its macros"
#endif

int main() { return EPS < 1 ? Success : 1; }
