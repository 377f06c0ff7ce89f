// SPDX-License-Identifier: MIT
// The machine that runs this program.
#pragma once

#include <benchmarks/support/machine.hpp>

#include <genrender/core/vector_target.hpp>

#include <fstream>
#include <set>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <unistd.h>

namespace genrender::benchmarks {

/// This machine, on which `all` was measured; `flags` and `libraries` are those of the build.
inline machine this_machine(results const& all, std::string flags, std::vector<std::string> libraries) {
#ifdef __clang__
    std::string const compiler = __VERSION__;
#else
    std::string const compiler = "g++ " __VERSION__;
#endif
    std::ifstream cpuinfo("/proc/cpuinfo");
    auto processors = detail::read_processors(cpuinfo);
    machine on;
    on.processor = std::move(processors.name);
    on.threads = std::thread::hardware_concurrency();
    on.cores = processors.cores > 0 ? processors.cores : on.threads;
    on.memory_bytes = static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
    on.compiler = compiler;
    on.flags = std::move(flags);
    on.vector_target = name_of(chosen_vector_target());
    for (auto const target : available_vector_targets()) {
        on.vector_targets.emplace_back(name_of(target));
    }
    on.libraries = std::move(libraries);
    std::set<std::string> peers;
    for (auto const& time : all.peers) {
        peers.insert(time.peer.substr(0, time.peer.find(" (")));
    }
    on.peers.assign(peers.begin(), peers.end());
    on.began = all.began;
    return on;
}

} // namespace genrender::benchmarks
