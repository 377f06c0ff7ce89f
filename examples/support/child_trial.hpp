// SPDX-License-Identifier: MIT
// A function tried in a process of its own, where it may crash, spin or abort without taking this one down.
#pragma once

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
#endif

namespace genrender::examples {

#if defined(__unix__) || defined(__APPLE__)

namespace detail {

/// Runs `work` and ends this process, silently: 0 if `work` returned or threw an exception.
template <class Work>
[[noreturn]] void end_after(Work&& work, unsigned processor_seconds) {
    // Nothing of a debugger's or sanitizer's report, no core file, no handlers of the program that forked
    auto const nowhere = ::open("/dev/null", O_WRONLY);
    ::dup2(nowhere, STDOUT_FILENO);
    ::dup2(nowhere, STDERR_FILENO);
    rlimit const no_core{0, 0};
    ::setrlimit(RLIMIT_CORE, &no_core);
    rlimit const time{processor_seconds, processor_seconds + 1};
    ::setrlimit(RLIMIT_CPU, &time);
    for (int const signal : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGTRAP, SIGXCPU, SIGINT, SIGTERM}) {
        std::signal(signal, SIG_DFL);
    }
    try {
        std::forward<Work>(work)();
    } catch (...) { // the caller does the work again, and meets the exception there
    }
    ::_exit(0);
}

} // namespace detail

/// How `work` fails in a child process: by a signal, an exit of its own or more than `processor_seconds` of work, as
/// words that follow "it": "crashed (Segmentation fault)". Nothing if it returns or throws an exception, and where no
/// child can be had. What it changes in memory stays in the child. It must not start threads, nor need those of the
/// caller. Elsewhere than on Unix nothing is tried.
template <class Work>
std::optional<std::string> failure_in_child(Work&& work, unsigned processor_seconds) {
    auto const child = ::fork();
    if (child == 0) {
        detail::end_after(std::forward<Work>(work), processor_seconds);
    }
    int status = 0;
    auto ended = child;
    while (child > 0 && (ended = ::waitpid(child, &status, 0)) < 0 && errno == EINTR) {
    }
    if (child < 0 || ended < 0 || (WIFEXITED(status) && WEXITSTATUS(status) == 0)) {
        return std::nullopt;
    }
    if (WIFSIGNALED(status) && WTERMSIG(status) == SIGXCPU) {
        return "takes more than " + std::to_string(processor_seconds) + " s";
    }
    return WIFSIGNALED(status) ? std::string("crashed (") + ::strsignal(WTERMSIG(status)) + ")"
                               : "ended with status " + std::to_string(WEXITSTATUS(status));
}

#else

/// Nothing: there are no child processes of this kind here.
template <class Work>
std::optional<std::string> failure_in_child(Work&&, unsigned) {
    return std::nullopt;
}

#endif

} // namespace genrender::examples
