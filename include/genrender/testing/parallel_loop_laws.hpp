// SPDX-License-Identifier: MIT
// The laws of parallel_loop, as a check of a model.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/parallel.hpp>
#include <genrender/testing/law_report.hpp>

#include <atomic>
#include <cstddef>
#include <stdexcept>
#include <string>
#include <vector>

namespace genrender::testing {

namespace detail {

/// Notes indices of a loop of `count` that were not visited once before the loop returned.
template <parallel_loop Loop>
void require_visits(law_report& report, Loop const& loop, std::size_t count) {
    std::vector<std::atomic<std::size_t>> visits(count);
    std::atomic<std::size_t> outside{0};
    loop(count, [&](std::size_t i) { ++(i < count ? visits[i] : outside); });
    for (std::size_t i = 0; i < count; ++i) {
        auto const found = visits[i].load();
        report.require(found == 1, "parallel_loop: every index is visited once before the loop returns",
                       std::to_string(found) + " visits of index " + std::to_string(i) + " of " + std::to_string(count),
                       "1");
    }
    report.require(outside == 0, "parallel_loop: no other index is visited",
                   std::to_string(outside.load()) + " visits of indices beyond " + std::to_string(count), "none");
}

} // namespace detail

/// Checks the laws of parallel_loop on loops of 0, 1 and 1000 indices, one inside the other too.
template <parallel_loop Loop>
law_report check_parallel_loop_laws(Loop const& loop) {
    law_report report;
    for (auto const count : {std::size_t{0}, std::size_t{1}, std::size_t{1000}}) {
        detail::require_visits(report, loop, count);
    }
    std::vector<std::atomic<std::size_t>> inner(12);
    loop(3, [&](std::size_t i) { loop(4, [&](std::size_t j) { ++inner[4 * i + j]; }); });
    for (std::size_t n = 0; n < inner.size(); ++n) {
        auto const found = inner[n].load();
        report.require(found == 1, "parallel_loop: a body may run the loop",
                       std::to_string(found) + " visits of index " + std::to_string(n % 4) + " inside index " +
                           std::to_string(n / 4),
                       "1");
    }
    std::string message = "no exception";
    try {
        loop(8, [](std::size_t i) {
            if (i == 5) {
                throw std::runtime_error("of the body");
            }
        });
    } catch (std::exception const& error) {
        message = error.what();
    }
    report.require(message == "of the body", "parallel_loop: an exception of the body reaches the caller", message,
                   "that of the body");
    return report;
}

} // namespace genrender::testing

#include <genrender/core/end_header.inl>
