// SPDX-License-Identifier: MIT
// How much memory of the machine the program holds, and the most that a part of it held, as Linux tells.
#pragma once

#include <cstdint>
#include <fstream>
#include <optional>
#include <string>

#if defined(__GLIBC__)
#include <malloc.h>
#endif

namespace genrender::examples {

/// A figure of /proc/self/status in bytes, say `VmRSS`; none where there is no such thing.
inline std::optional<std::int64_t> memory_status(std::string const& name) {
    std::ifstream status("/proc/self/status");
    for (std::string line; std::getline(status, line);) {
        if (line.starts_with(name + ":")) {
            return std::strtoll(line.c_str() + name.size() + 1, nullptr, 10) * 1024;
        }
    }
    return std::nullopt;
}

/// From now on memory is returned to the system as soon as it is freed, as far as whole pages go, so that what is
/// resident is what the program holds; slower, and nothing but the GNU C library does it. It else keeps some of what is
/// freed, more and more of it as larger blocks are.
inline void return_freed_memory() {
#if defined(__GLIBC__)
    mallopt(M_ARENA_MAX, 1);
    mallopt(M_MMAP_THRESHOLD, 128 << 10);
    mallopt(M_TRIM_THRESHOLD, 128 << 10);
#endif
}

/// The most resident memory that `body()` holds at once beyond what the program held before; none where the system does
/// not let its high-water mark be lowered.
template <class Body>
std::optional<std::int64_t> resident_growth(Body&& body) {
#if defined(__GLIBC__)
    malloc_trim(0); // What was freed before is not to be used again unseen.
#endif
    std::ofstream("/proc/self/clear_refs") << "5\n";
    auto const before = memory_status("VmRSS");
    auto const mark = memory_status("VmHWM");
    body();
    auto const after = memory_status("VmHWM");
    constexpr std::int64_t slack = std::int64_t{1} << 20; // a lowered mark lies about where the memory does
    if (!before || !mark || !after || *mark > *before + slack) {
        return std::nullopt;
    }
    return *after - *before;
}

} // namespace genrender::examples
