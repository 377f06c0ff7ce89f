// SPDX-License-Identifier: MIT
// What the figures of a run are true of: the processor, its memory, the compiler, the vectors and the packages.
#pragma once

#include <benchmarks/support/benchmark_results.hpp>

#include <cstddef>
#include <istream>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace genrender::benchmarks {

/// The machine of a run and what compiled its programs.
struct machine {
    std::string processor;
    std::size_t cores = 0;   ///< that have registers of their own
    std::size_t threads = 0; ///< that run at once, and that loops use unless told otherwise
    double memory_bytes = 0;
    std::string compiler;
    std::string flags;                       ///< of the build
    std::string vector_target;               ///< the kernels' own choice
    std::vector<std::string> vector_targets; ///< among which they choose, rising
    std::vector<std::string> libraries;      ///< with their versions
    std::vector<std::string> peers;          ///< with their versions
    std::optional<run_start> began;
};

namespace detail {

/// What Linux tells of the processors: the name, and the number of cores.
struct processors {
    std::string name = "unknown processor";
    std::size_t cores = 0;
};

inline processors read_processors(std::istream& cpuinfo) {
    processors found;
    std::set<std::string> cores;
    std::string package;
    for (std::string line; std::getline(cpuinfo, line);) {
        auto const colon = line.find(": ");
        auto const value = colon == std::string::npos ? "" : line.substr(colon + 2);
        if (line.starts_with("model name")) {
            found.name = value;
        } else if (line.starts_with("physical id")) {
            package = value;
        } else if (line.starts_with("core id")) {
            cores.insert(package + " " + value);
        }
    }
    found.cores = cores.size();
    return found;
}

} // namespace detail

} // namespace genrender::benchmarks
