// SPDX-License-Identifier: MIT
// A function tried in a process of its own, where it may crash, spin or abort without taking this one down.
#pragma once

#include <cstdint>
#include <cstdio>
#include <optional>
#include <string>
#include <utility>

#if defined(__unix__) || defined(__APPLE__)
#include <fcntl.h>
#include <sys/resource.h>
#include <sys/types.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <fstream>
#include <new>
#endif

namespace genrender::examples {

/// What work in a child process may take.
struct trial_limits {
    unsigned processor_seconds = 60;
    std::uint64_t bytes = std::uint64_t(1) << 30; ///< besides what the caller has; where the system tells that (Linux)
};

#if defined(__unix__) || defined(__APPLE__)

namespace detail {

/// The status of a child that had not enough memory.
inline constexpr int out_of_memory = 77;

/// Lets this process ask for `bytes` more than it has; without a word if the system does not tell what it has.
inline void limit_memory(std::uint64_t bytes) {
    std::ifstream sizes("/proc/self/statm");
    std::uint64_t pages[6]{}; // of all, and sixth of data
    for (auto& size : pages) {
        sizes >> size;
    }
    if (sizes) {
        auto const most = static_cast<rlim_t>(pages[5] * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE)) + bytes);
        rlimit const memory{most, most};
        ::setrlimit(RLIMIT_DATA, &memory);
        std::set_new_handler([] { ::_exit(out_of_memory); }); // an exception would be met by who knows whom
    }
}

/// Runs `work` and ends this process, silently: 0 if `work` returned or threw an exception.
template <class Work>
[[noreturn]] void end_after(Work&& work, trial_limits const& limits) {
    // Nothing of a debugger's or sanitizer's report, no core file, no handlers of crashes
    auto const nowhere = ::open("/dev/null", O_WRONLY);
    ::dup2(nowhere, STDOUT_FILENO);
    ::dup2(nowhere, STDERR_FILENO);
    rlimit const no_core{0, 0};
    ::setrlimit(RLIMIT_CORE, &no_core);
    rlimit const time{limits.processor_seconds, limits.processor_seconds + 1};
    ::setrlimit(RLIMIT_CPU, &time);
    ::alarm(2 * limits.processor_seconds + 10); // who waits for ever uses no processor
    limit_memory(limits.bytes);
    for (int const signal : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGTRAP, SIGXCPU, SIGALRM}) {
        std::signal(signal, SIG_DFL);
    }
    try {
        std::forward<Work>(work)();
    } catch (...) { // the caller does the work again, and meets the exception there
    }
    ::_exit(0);
}

} // namespace detail

/// How `work` fails in a child process: by a signal, an exit of its own or by more than the limits allow, as words that
/// follow "it": "crashed (Segmentation fault)". Nothing if it returns or throws an exception, and where no
/// child can be had. What it changes in memory stays in the child. It must not start threads, nor need those of the
/// caller. Elsewhere than on Unix nothing is tried.
template <class Work>
std::optional<std::string> failure_in_child(Work&& work, trial_limits const& limits = {}) {
    auto const child = ::fork();
    if (child == 0) {
        detail::end_after(std::forward<Work>(work), limits);
    }
    int status = 0;
    auto ended = child;
    while (child > 0 && (ended = ::waitpid(child, &status, 0)) < 0 && errno == EINTR) {
    }
    if (child < 0 || ended < 0 || (WIFEXITED(status) && WEXITSTATUS(status) == 0)) {
        return std::nullopt;
    }
    if (WIFSIGNALED(status) && (WTERMSIG(status) == SIGXCPU || WTERMSIG(status) == SIGALRM)) {
        return "takes more than " + std::to_string(limits.processor_seconds) + " s";
    }
    if (WIFEXITED(status) && WEXITSTATUS(status) == detail::out_of_memory) {
        char text[64];
        std::snprintf(text, sizeof text, "needs more than %.3g GB of memory", static_cast<double>(limits.bytes) * 1e-9);
        return text;
    }
    return WIFSIGNALED(status) ? std::string("crashed (") + ::strsignal(WTERMSIG(status)) + ")"
                               : "ended with status " + std::to_string(WEXITSTATUS(status));
}

#else

/// Nothing: there are no child processes of this kind here.
template <class Work>
std::optional<std::string> failure_in_child(Work&&, trial_limits const& = {}) {
    return std::nullopt;
}

#endif

} // namespace genrender::examples
