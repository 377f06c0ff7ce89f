// SPDX-License-Identifier: MIT
// Frames as an MP4 file, by the program ffmpeg where it is on the PATH.
#pragma once

#include "output_file.hpp"
#include "pictures.hpp"

#include <genrender/core/error.hpp>

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstddef>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

extern char** environ; // NOLINT: POSIX names it so

namespace genrender::examples {

/// The program `name` in the folders of the environment variable PATH, or none.
inline std::optional<std::filesystem::path> program_on_path(std::string const& name) {
    auto const* const path = std::getenv("PATH");
    std::string const folders = path != nullptr ? path : "";
    for (std::size_t begin = 0; begin < folders.size();) {
        auto const end = std::min(folders.find(':', begin), folders.size());
        auto candidate = std::filesystem::path(folders.substr(begin, end - begin)) / name;
        if (::access(candidate.c_str(), X_OK) == 0 && !std::filesystem::is_directory(candidate)) {
            return candidate;
        }
        begin = end + 1;
    }
    return std::nullopt;
}

/// Writes the frames, of equal extents, as MP4 by the program `ffmpeg`, whole or not at all; odd sides get a line of
/// black, which the format asks for. Throws value_error if there are no frames, file_error if the program fails.
inline void write_mp4(std::filesystem::path const& ffmpeg, std::filesystem::path const& path,
                      std::span<rgb8_image const> frames, double frames_per_second) {
    require_value(!frames.empty(), "write_mp4", "frames", "empty", "at least one frame");
    auto const refuse = [&](std::string const& reason) {
        throw file_error(path.string() + ": " + ffmpeg.string() + " cannot write it (" + reason +
                         "), expected one that encodes MP4");
    };
    output_file file(path);
    std::vector<std::string> words{ffmpeg.string(), "-y", "-loglevel", "error", "-f", "rawvideo", "-pix_fmt", "rgb24"};
    for (auto const& word :
         {std::string("-s"), std::to_string(frames[0].width) + "x" + std::to_string(frames[0].height),
          std::string("-r"), std::to_string(frames_per_second), std::string("-i"), std::string("-"), std::string("-vf"),
          std::string("pad=ceil(iw/2)*2:ceil(ih/2)*2"), std::string("-pix_fmt"), std::string("yuv420p"),
          std::string("-f"), std::string("mp4"), file.temporary().string()}) {
        words.push_back(word);
    }
    std::vector<char*> arguments;
    for (auto& word : words) {
        arguments.push_back(word.data());
    }
    arguments.push_back(nullptr);

    // Its standard input is our pipe; that it ends early must not end this program.
    std::array<int, 2> pipe{};
    if (::pipe2(pipe.data(), O_CLOEXEC) != 0) {
        refuse("no pipe");
    }
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, pipe[0], 0);
    pid_t child = 0;
    auto const failure = ::posix_spawn(&child, ffmpeg.c_str(), &actions, nullptr, arguments.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    ::close(pipe[0]);
    if (failure != 0) {
        ::close(pipe[1]);
        refuse("it does not start");
    }
    auto const former = std::signal(SIGPIPE, SIG_IGN);
    auto is_taken = true;
    for (std::size_t i = 0; i < frames.size() && is_taken; ++i) {
        for (std::size_t done = 0; done < frames[i].bytes.size() && is_taken;) {
            auto const count = ::write(pipe[1], frames[i].bytes.data() + done, frames[i].bytes.size() - done);
            is_taken = count > 0 || (count < 0 && errno == EINTR);
            done += count > 0 ? static_cast<std::size_t>(count) : 0;
        }
    }
    ::close(pipe[1]);
    std::signal(SIGPIPE, former);
    int status = 0;
    while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
    }
    if (!is_taken || !WIFEXITED(status) || WEXITSTATUS(status) != 0) {
        refuse("it failed");
    }
    file.commit();
}

} // namespace genrender::examples
