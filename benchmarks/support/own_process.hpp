// SPDX-License-Identifier: MIT
// A measurement in a process of its own, so that memory which earlier ones left to the allocator does not hide its own.
#pragma once

#include <optional>
#include <type_traits>

#include <sys/wait.h>
#include <unistd.h>

namespace genrender::benchmarks {

/// What `body()` returns when a copy of this process runs it, which then ends; none if there is no such copy, or `body`
/// throws or does not come to an end. The copy has the caller's thread and no other: `body` must not wait for one that
/// is running already.
template <class Body>
auto in_own_process(Body&& body) -> std::optional<std::invoke_result_t<Body>> {
    using value_type = std::invoke_result_t<Body>;
    static_assert(std::is_trivially_copyable_v<value_type>, "what a process says to another is bytes");
    int ends[2];
    if (pipe(ends) != 0) {
        return std::nullopt;
    }
    auto const child = fork();
    if (child == 0) {
        close(ends[0]);
        auto is_told = false;
        try {
            value_type const value = body();
            is_told = write(ends[1], &value, sizeof value) == static_cast<ssize_t>(sizeof value);
        } catch (...) {
            // The exit code tells.
        }
        _exit(is_told ? 0 : 1); // What the caller has open is not the copy's to flush.
    }
    close(ends[1]);
    value_type value{};
    auto const is_heard = child > 0 && read(ends[0], &value, sizeof value) == static_cast<ssize_t>(sizeof value);
    close(ends[0]);
    int status = 1;
    auto const has_ended = child > 0 && waitpid(child, &status, 0) == child && status == 0;
    return is_heard && has_ended ? std::optional(value) : std::nullopt;
}

} // namespace genrender::benchmarks
