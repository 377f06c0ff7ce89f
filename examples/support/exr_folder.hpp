// SPDX-License-Identifier: MIT
// The EXR files of a folder, frame by frame: one a frame, or one a pass side by side.
#pragma once

#include <genrender/core/error.hpp>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

namespace genrender::examples {

/// One of the files of a frame.
struct exr_pass_file {
    std::filesystem::path path;
    std::string pass;  ///< `UV`, `Depth`, `IndexOB`, `Rest` or `Position`; empty: the file's channels say
    std::string layer; ///< what else its name says: `figure` of `figure_uv_0001.exr`
};

/// The files of one frame, at least one.
using exr_frame_files = std::vector<exr_pass_file>;

namespace detail {

inline std::string lower_case(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return text;
}

inline bool is_digit(char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; }

/// Whether `a` comes before `b` when runs of digits count as numbers: frame_9 before frame_10.
inline bool comes_before(std::string const& a, std::string const& b) {
    auto const number_at = [&](std::string const& text, std::size_t& i) {
        auto const begin = std::min(text.find_first_not_of('0', i), text.size());
        while (i < text.size() && is_digit(text[i])) {
            ++i;
        }
        return begin < i ? text.substr(begin, i - begin) : std::string{};
    };
    for (std::size_t i = 0, j = 0; i < a.size() && j < b.size();) {
        if (is_digit(a[i]) && is_digit(b[j])) {
            auto const m = number_at(a, i);
            auto const n = number_at(b, j);
            if (m != n) {
                return m.size() != n.size() ? m.size() < n.size() : m < n;
            }
        } else if (a[i] != b[j]) {
            return a[i] < b[j];
        } else {
            ++i;
            ++j;
        }
    }
    return a.size() != b.size() ? a.size() < b.size() : a < b;
}

/// The pass that a word of a file's name stands for, or nothing.
inline std::optional<std::string> pass_of_word(std::string const& word) {
    static std::array<std::pair<char const*, char const*>, 15> const words{{
        {"uv", "UV"},
        {"depth", "Depth"},
        {"z", "Depth"},
        {"zdepth", "Depth"},
        {"index", "IndexOB"},
        {"indexob", "IndexOB"},
        {"objectindex", "IndexOB"},
        {"objectid", "IndexOB"},
        {"objindex", "IndexOB"},
        {"id", "IndexOB"},
        {"rest", "Rest"},
        {"restposition", "Rest"},
        {"position", "Position"},
        {"cryptomatte", ""},
        {"cryptoobject", ""},
    }};
    for (auto const& [known, pass] : words) {
        if (word == known) {
            return pass;
        }
    }
    return std::nullopt;
}

/// What a name such as `figure_uv_0001` or `0001_uv` says: its pass, what stands beside it, its number without leading
/// zeros.
struct exr_file_name {
    std::optional<std::string> pass;
    std::string layer;
    std::string number;
};

inline exr_file_name read_file_name(std::string const& stem) {
    exr_file_name result;
    auto end = stem.size();
    while (end > 0 && is_digit(stem[end - 1])) {
        --end;
    }
    result.number = stem.substr(std::min(stem.find_first_not_of('0', end), stem.size()));
    std::vector<std::string> words(1);
    for (auto const c : stem.substr(0, end)) {
        if (std::isalnum(static_cast<unsigned char>(c)) != 0) {
            words.back() += c;
        } else if (!words.back().empty()) {
            words.emplace_back();
        }
    }
    for (auto i = words.size(); i-- > 0;) {
        auto const pass = result.pass ? std::nullopt : pass_of_word(lower_case(words[i]));
        auto const of_pass = [&](char const* word) { return i > 0 && lower_case(words[i - 1]) == word; };
        if (pass) {
            auto const is_rest = pass == "Position" && of_pass("rest");
            result.pass = is_rest ? "Rest" : pass;
            i -= is_rest || (pass == "IndexOB" && (of_pass("object") || of_pass("ob"))) ? 1U : 0U;
        } else if (end == stem.size() && std::all_of(words[i].begin(), words[i].end(), is_digit)) {
            result.number += words[i].substr(std::min(words[i].find_first_not_of('0'), words[i].size()));
        } else if (!words[i].empty()) {
            result.layer = words[i] + (result.layer.empty() ? "" : "_") + result.layer;
        }
    }
    return result;
}

/// The EXR files of a folder in order. Throws file_error if there are none, and says why 8-bit pictures are not enough.
inline std::vector<std::filesystem::path> exr_files(std::filesystem::path const& folder) {
    std::vector<std::filesystem::path> files;
    std::vector<std::filesystem::path> folders;
    std::string picture;
    std::error_code failure;
    for (std::filesystem::directory_iterator entry(folder, failure), end; !failure && entry != end;
         entry.increment(failure)) {
        auto const ending = lower_case(entry->path().extension().string());
        std::error_code ignored;
        if (ending == ".exr" && entry->path().filename().string().front() != '.') {
            files.push_back(entry->path());
        } else if (ending == ".png" || ending == ".jpg" || ending == ".jpeg") {
            picture = entry->path().filename().string();
        } else if (read_file_name(entry->path().filename().string()).pass && entry->is_directory(ignored)) {
            folders.push_back(entry->path());
        }
    }
    if (failure) {
        throw file_error(folder.string() + ": cannot be read (" + failure.message() +
                         "), expected a folder of EXR files");
    }
    for (auto const& of_pass : folders) { // uv/0001.exr, depth/0001.exr
        if (files.empty() || files.front().parent_path() != folder) {
            auto const inner = exr_files(of_pass);
            files.insert(files.end(), inner.begin(), inner.end());
        }
    }
    if (files.empty() && !picture.empty()) {
        throw file_error(
            folder.string() + ": holds 8-bit pictures (" + picture +
            ") and no EXR file, expected 32-bit float EXR (256 levels of u and v cannot address a texture)");
    }
    if (files.empty()) {
        throw file_error(folder.string() + ": holds no EXR file, expected one a frame");
    }
    std::sort(files.begin(), files.end(),
              [](auto const& a, auto const& b) { return comes_before(a.filename().string(), b.filename().string()); });
    return files;
}

} // namespace detail

/// The frames of `folder` in order, by name with digits as numbers. Where a UV and a depth file of one number stand side
/// by side (`uv_0001.exr`, `depth_0001.exr`, or in folders `uv` and `depth`), a frame is all files of its number that
/// are named after a pass; else it is one file. Opens none of them. Throws file_error as `exr_files` does.
inline std::vector<exr_frame_files> exr_frames_of(std::filesystem::path const& folder) {
    struct numbered {
        std::string number;
        exr_frame_files files;
    };
    std::vector<numbered> groups;
    std::vector<exr_frame_files> single;
    bool is_side_by_side = false;
    for (auto const& path : detail::exr_files(folder)) {
        single.push_back({{path, "", ""}});
        auto const in_folder = path.parent_path() != folder;
        auto const name = detail::read_file_name((in_folder ? path.parent_path().filename().string() + "_" : "") +
                                                 path.stem().string());
        if (!name.pass) {
            continue;
        }
        auto group = std::find_if(groups.begin(), groups.end(), [&](auto const& g) { return g.number == name.number; });
        if (group == groups.end()) {
            group = groups.insert(groups.end(), {name.number, {}});
        }
        group->files.push_back({path, *name.pass, name.layer});
        auto const holds = [&](char const* pass) {
            return std::any_of(group->files.begin(), group->files.end(), [&](auto const& f) { return f.pass == pass; });
        };
        is_side_by_side = is_side_by_side || (holds("UV") && holds("Depth"));
    }
    if (!is_side_by_side) {
        return single;
    }
    std::stable_sort(groups.begin(), groups.end(),
                     [](auto const& a, auto const& b) { return detail::comes_before(a.number, b.number); });
    std::vector<exr_frame_files> frames;
    for (auto& group : groups) {
        // Names that tell no passes of one kind apart name no layers: take3_uv, take4_depth.
        auto const is_twice = [&](auto const& f) {
            return std::count_if(group.files.begin(), group.files.end(),
                                 [&](auto const& g) { return g.pass == f.pass; }) > 1;
        };
        if (std::none_of(group.files.begin(), group.files.end(), is_twice)) {
            std::for_each(group.files.begin(), group.files.end(), [](auto& f) { f.layer.clear(); });
        }
        // The UV file stands for its frame in sentences.
        std::stable_partition(group.files.begin(), group.files.end(), [](auto const& f) { return f.pass == "UV"; });
        frames.push_back(std::move(group.files));
    }
    return frames;
}

/// The number at the end, or else in front, of a frame's file name, as renderers number frames; nothing if there is none below 10^9.
inline std::optional<long> frame_number(exr_frame_files const& frame) {
    auto const stem = frame.front().path.stem().string();
    auto const number = detail::read_file_name(stem).number;
    auto const has_number = !number.empty() || stem.ends_with('0'); // leading zeros are not kept
    return has_number && number.size() < 10 ? std::optional(number.empty() ? 0 : std::stol(number)) : std::nullopt;
}

} // namespace genrender::examples
