// SPDX-License-Identifier: MIT
// What the figures of a run are true of: the processor, its threads, the compiler and its flags.
#pragma once

#include <genrender/core/linalg.hpp>

#include <fstream>
#include <string>
#include <thread>
#include <utility>

namespace genrender::benchmarks {

/// The machine that runs this program and what compiled it.
struct machine {
    std::string processor;
    unsigned threads = 0;
    std::string compiler;
    std::string flags;
    std::string vectors; ///< the widest instruction set that Eigen uses
};

namespace detail {

/// The processor's name as Linux tells it.
inline std::string processor_name() {
    std::ifstream stream("/proc/cpuinfo");
    for (std::string line; std::getline(stream, line);) {
        if (line.starts_with("model name") && line.find(": ") != std::string::npos) {
            return line.substr(line.find(": ") + 2);
        }
    }
    return "unknown processor";
}

} // namespace detail

/// This machine; `flags` are those of the build.
inline machine this_machine(std::string flags) {
#ifdef __clang__
    std::string const compiler = __VERSION__;
#else
    std::string const compiler = "g++ " __VERSION__;
#endif
    std::string const vectors = Eigen::SimdInstructionSetsInUse();
    return {detail::processor_name(), std::thread::hardware_concurrency(), compiler, std::move(flags),
            vectors.substr(0, vectors.find(','))};
}

} // namespace genrender::benchmarks
