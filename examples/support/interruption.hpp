// SPDX-License-Identifier: MIT
// Ctrl-C: a run ends in good order and says how it goes on.
#pragma once

#include <unistd.h>

#include <atomic>
#include <csignal>
#include <cstddef>
#include <string>
#include <string_view>

namespace genrender::examples {

/// The exit code of a program that Ctrl-C has ended.
inline constexpr int interrupted_code = 130;

namespace detail {

inline std::atomic<bool>& interruption_flag() {
    static std::atomic<bool> flag{false};
    return flag;
}
/// What leave_when_interrupted says; written before its handler is set.
inline std::string& last_words() {
    static std::string words;
    return words;
}

} // namespace detail

/// From now on Ctrl-C sets was_interrupted(), and a second one ends the program at once.
inline void note_interruptions() {
    std::signal(SIGINT, [](int) {
        detail::interruption_flag() = true;
        std::signal(SIGINT, SIG_DFL);
    });
}
/// Whether Ctrl-C was pressed since.
inline bool was_interrupted() { return detail::interruption_flag(); }

/// From now on Ctrl-C ends the program at once, with these words on the error stream. For stretches that write no file.
inline void leave_when_interrupted(std::string const& words) {
    std::signal(SIGINT, SIG_IGN);
    detail::last_words() = words;
    std::signal(SIGINT, [](int) {
        auto const& last = detail::last_words();
        auto const written = ::write(STDERR_FILENO, last.data(), last.size());
        ::_exit(written < 0 ? 1 : interrupted_code);
    });
}

/// A command line as a shell takes it, with `option` at its end unless it is there.
inline std::string command_text(int argc, char const* const* argv, std::string_view option) {
    std::string text;
    bool has_option = false;
    for (int i = 0; i < argc; ++i) {
        std::string_view const word(argv[i]);
        has_option = has_option || word == option;
        constexpr std::string_view plain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_./:=+,-@%";
        std::string quoted(word);
        if (word.empty() || word.find_first_not_of(plain) != std::string_view::npos) {
            quoted = "'";
            for (char const letter : word) {
                quoted += letter == '\'' ? std::string("'\\''") : std::string(1, letter);
            }
            quoted += "'";
        }
        text += (i > 0 ? " " : "") + quoted;
    }
    return has_option ? text : text + " " + std::string(option);
}

} // namespace genrender::examples
