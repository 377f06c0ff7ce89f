// SPDX-License-Identifier: MIT
// [GR sec. 3] Which animations of a model file play, and the times that are rendered of them.
#pragma once

#include "model_scene.hpp"

#include <genrender/core/error.hpp>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <iterator>
#include <optional>
#include <span>
#include <string>
#include <system_error>
#include <vector>

namespace genrender::examples {

/// What of a file's time is rendered.
struct model_time_options {
    /// Number of frames, taken evenly from the whole range, whose end a loop shows as its start, but for a last frame
    /// that is asked for; or, with `frames_per_second`, of that rate. 0: the whole range at `frames_per_second`, or at
    /// the file's rate and then at most `most_frames`.
    std::size_t frames = 16;
    std::size_t most_frames = 48;
    std::size_t frames_at_rest = 0; ///< instead of 0 frames where nothing moves
    /// With a value, an animation that is over starts again.
    std::optional<double> frames_per_second{};
    /// First and last frame of the range on the file's time line, whose frame f is at f / frames_per_second of the
    /// file's; without a value the first and last key.
    std::optional<long> start{};
    std::optional<long> end{};
    /// A name or a number from 0 on, or "all". Empty: all together where they move different things, else the longest.
    std::string animation{};
};

/// The times of the frames.
struct model_times {
    std::vector<double> seconds;   ///< of each frame, on the file's time line
    double frames_per_second = 24; ///< at which the frames are shown in real time
    double duration = 0;           ///< of the range, seconds
    std::string name;              ///< of what plays; empty if nothing does
    std::vector<std::string> notes;
};

namespace detail {

/// `Walk (1.25 s)`.
inline std::string text_of(model_take const& take) {
    char seconds[32];
    std::snprintf(seconds, sizeof seconds, " (%.3g s)", take.end - take.begin);
    return take.name + seconds;
}

/// `0 Walk (1.25 s), 1 Run (3 s)`, of at most twelve.
inline std::string list_of(std::span<model_take const> takes) {
    std::string text;
    auto const named = std::min<std::size_t>(takes.size(), 12);
    for (std::size_t i = 0; i < named; ++i) {
        text += (i > 0 ? ", " : "") + std::to_string(i) + " " + text_of(takes[i]);
    }
    return text + (named < takes.size() ? " and " + std::to_string(takes.size() - named) + " more" : "");
}

/// Whether no two of the takes that are `chosen` move the same thing.
inline bool are_apart(std::span<model_take const> takes, std::span<std::size_t const> chosen) {
    std::vector<std::string> moved;
    std::size_t count = 0;
    for (auto const take : chosen) {
        auto const& targets = takes[take].targets;
        std::vector<std::string> both;
        std::set_union(moved.begin(), moved.end(), targets.begin(), targets.end(), std::back_inserter(both));
        moved = std::move(both);
        count += targets.size();
    }
    return moved.size() == count;
}

} // namespace detail

/// The indices of the takes that `choice` names (see model_time_options::animation). Throws value_error with the
/// names there are if it names none.
inline std::vector<std::size_t> choose_takes(std::span<model_take const> takes, std::string const& choice) {
    std::vector<std::size_t> lasting;
    for (std::size_t i = 0; i < takes.size(); ++i) {
        if (takes[i].end > takes[i].begin || choice == "all") {
            lasting.push_back(i);
        }
    }
    if (choice == "all" || (choice.empty() && (lasting.empty() || detail::are_apart(takes, lasting)))) {
        return lasting;
    }
    if (choice.empty()) {
        return {*std::max_element(lasting.begin(), lasting.end(), [&](std::size_t a, std::size_t b) {
            return takes[a].end - takes[a].begin < takes[b].end - takes[b].begin;
        })};
    }
    auto const named = std::find_if(takes.begin(), takes.end(), [&](auto const& take) { return take.name == choice; });
    if (named != takes.end()) {
        return {static_cast<std::size_t>(named - takes.begin())};
    }
    std::size_t number = 0;
    auto const* const end = choice.data() + choice.size();
    auto const [rest, error] = std::from_chars(choice.data(), end, number);
    require_value(error == std::errc() && rest == end && number < takes.size(), "load_model", "options.time.animation",
                  choice,
                  takes.empty() ? "none, as the file holds no animation"
                                : ("the name or number of one of the file's: " + detail::list_of(takes)).c_str());
    return {number};
}

/// The times of the frames while these takes of `scene` play. Throws value_error at impossible options.
inline model_times choose_times(model_scene const& scene, std::span<std::size_t const> playing,
                                model_time_options const& options) {
    auto const fps = options.frames_per_second.value_or(0);
    require_value(!options.frames_per_second || (fps > 0 && std::isfinite(fps)), "load_model",
                  "options.time.frames_per_second", fps, "a rate above 0");
    model_times times;
    auto const rate = scene.frames_per_second();
    if (playing.empty() && !(options.start && options.end)) {
        auto const frames = options.frames > 0 ? options.frames : options.frames_at_rest;
        require_value(frames > 0, "load_model", "options.time.frames", frames,
                      "at least 1 where the file has no animation");
        times.seconds.assign(frames, 0);
        times.frames_per_second = fps > 0 ? fps : rate;
        return times;
    }

    // The range
    auto begin = 0.0;
    auto end = 0.0;
    for (auto const take : playing) {
        auto const& one = scene.takes()[take];
        auto const is_first = take == playing.front();
        begin = is_first ? one.begin : std::min(begin, one.begin);
        end = is_first ? one.end : std::max(end, one.end);
        times.name += (is_first ? "" : ", ") + one.name;
    }
    begin = options.start ? static_cast<double>(*options.start) / rate : begin;
    end = options.end ? static_cast<double>(*options.end) / rate : end;
    require_value(begin <= end, "load_model", "options.time.start", std::to_string(begin * rate),
                  ("a frame that is not after the last, " + std::to_string(end * rate)).c_str());
    times.duration = end - begin;

    // The frames
    auto const is_real_time = fps > 0 || options.frames == 0;
    auto const shown = fps > 0 ? fps : rate;
    auto const steps = times.duration * shown;
    // A range that was asked for is shown with its last frame; a loop shows its end as its start.
    auto const whole = options.end ? static_cast<std::size_t>(std::floor(steps + 1e-6)) + 1
                                   : std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(steps)));
    auto const most = fps > 0 ? whole : std::min(whole, options.most_frames);
    auto const frames = options.frames > 0 ? options.frames : most;
    auto const steps_of_all = static_cast<double>(options.end && frames > 1 ? frames - 1 : frames);
    for (std::size_t i = 0; i < frames; ++i) {
        auto const at =
            is_real_time ? static_cast<double>(i) / shown : static_cast<double>(i) * times.duration / steps_of_all;
        auto const wraps = times.duration > 0 && !(options.end && at <= times.duration + 1e-9);
        times.seconds.push_back(begin + (wraps ? std::fmod(at, times.duration) : std::min(at, times.duration)));
    }
    times.frames_per_second = is_real_time || !(times.duration > 0) ? shown : steps_of_all / times.duration;

    // What is worth saying
    if (scene.takes().size() > 1) {
        auto const all = std::to_string(scene.takes().size()) + " animations: " + detail::list_of(scene.takes());
        times.notes.push_back(playing.size() == 1
                                  ? "Plays " + scene.takes()[playing.front()].name + ", one of " + all + "."
                                  : "Plays " + std::to_string(playing.size()) + " together of " + all + ".");
    } else if (!playing.empty()) {
        times.notes.push_back("Plays " + detail::text_of(scene.takes()[0]) + ", the file's animation.");
    }
    if (options.frames == 0 && frames < whole) {
        times.notes.push_back("Shows the first " + std::to_string(frames) + " of " + std::to_string(whole) +
                              " frames; a number of frames or a rate shows the whole.");
    }
    return times;
}

} // namespace genrender::examples
