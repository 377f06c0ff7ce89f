// SPDX-License-Identifier: MIT
// Progress of a run as a line on the error stream.
#pragma once

#include "interruption.hpp"

#include <genrender/pipeline/progress.hpp>

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iostream>
#include <string>

namespace genrender::examples {

/// `75 s` or `2 min 05 s`
inline std::string duration_text(double seconds) {
    auto const whole = static_cast<long>(std::lround(seconds));
    if (whole < 120) {
        return std::to_string(whole) + " s";
    }
    auto const rest = std::to_string(whole % 60);
    return std::to_string(whole / 60) + " min " + (rest.size() < 2 ? "0" : "") + rest + " s";
}

/// An observer that keeps one line up to date on a terminal, prints a line a step elsewhere and nothing if `is_quiet`.
/// Ctrl-C ends the run in good order, a second one at once.
inline progress_observer progress_line(bool is_quiet) {
    note_interruptions();
    auto const is_terminal = isatty(STDERR_FILENO) != 0;
    return [is_quiet, is_terminal](progress const& state) {
        auto const is_step_done = state.pass == render_pass::frames && state.frames_done == state.frames;
        if (!is_quiet && (is_terminal || is_step_done)) {
            std::string line = "step " + std::to_string(state.step + 1) + " of " + std::to_string(state.steps) + ", " +
                               (state.pass == render_pass::keyframes ? "keyframes " : "frames ") +
                               std::to_string(state.frames_done) + " of " + std::to_string(state.frames) + ", " +
                               duration_text(state.elapsed_seconds) + " so far, about " +
                               duration_text(state.remaining_seconds) + " left";
            line.resize(std::max<std::size_t>(line.size(), 78), ' ');
            auto const is_last = is_step_done && state.step + 1 == state.steps;
            std::cerr << (is_terminal ? "\r" : "") << line << (is_terminal && !is_last ? "" : "\n") << std::flush;
        }
        return !was_interrupted();
    };
}

} // namespace genrender::examples
