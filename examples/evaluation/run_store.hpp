// SPDX-License-Identifier: MIT
// What runs gave, kept in a file each: a run that was made is not made again, whoever stops the program.
#pragma once

#include "measures.hpp"

#include <examples/support/output_file.hpp>
#include <examples/support/pictures.hpp>

#include <genrender/core/error.hpp>
#include <genrender/core/strided_view.hpp>
#include <genrender/core/tensor.hpp>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace genrender::examples {

/// What one run gave.
struct kept_run {
    measures figures;
    double seconds = 0; ///< of rendering, measuring left out
};

/// A number for a text [FNV-1a, 64 bits].
inline std::uint64_t number_of(std::string_view text, std::uint64_t start = 0xcbf29ce484222325U) {
    for (auto const c : text) {
        start = (start ^ static_cast<unsigned char>(c)) * 0x100000001b3U;
    }
    return start;
}

/// 16 hexadecimal digits.
inline std::string hexadecimal(std::uint64_t number) {
    std::array<char, 17> text{};
    std::snprintf(text.data(), text.size(), "%016llx", static_cast<unsigned long long>(number));
    return text.data();
}

/// A number for names and contents of all files of a folder. Throws file_error if there are none or one cannot be read.
inline std::string digest_of(std::filesystem::path const& folder) {
    std::vector<std::filesystem::path> files;
    std::error_code failure;
    for (auto const& entry : std::filesystem::recursive_directory_iterator(folder, failure)) {
        if (entry.is_regular_file()) {
            files.push_back(entry.path());
        }
    }
    if (files.empty()) {
        throw file_error(folder.string() + ": holds no files, expected the folder of a network");
    }
    std::sort(files.begin(), files.end());
    auto number = number_of("");
    for (auto const& path : files) {
        std::ifstream file(path, std::ios::binary);
        std::string const bytes{std::istreambuf_iterator<char>(file), {}};
        if (!file) {
            throw file_error(path.string() + ": cannot be read");
        }
        number = number_of(bytes, number_of(path.lexically_relative(folder).generic_string() + '\n', number));
    }
    return hexadecimal(number);
}

/// A folder with a file for each run, named by a number of its key, and the frames of those that pictures show. A file is
/// there whole or not at all.
class run_store {
public:
    /// Makes the folder. Throws file_error if it cannot be made.
    explicit run_store(std::filesystem::path folder) : folder_(std::move(folder)) { make_folder(folder_); }

    /// What is kept under a key; none if that is nothing, or not what this program writes.
    std::optional<kept_run> find(std::string const& key) const {
        std::ifstream file(path_of(key, ".json"));
        auto const json = nlohmann::json::parse(file, nullptr, false);
        if (!file || !json.is_object() || json.value("key", "") != key || !json.contains("figures")) {
            return std::nullopt;
        }
        kept_run kept{{}, json.value("seconds", 0.0)};
        for (auto const& [name, figure] : json["figures"].items()) {
            if (!figure.is_number()) {
                return std::nullopt;
            }
            kept.figures[name] = figure.get<double>();
        }
        return kept;
    }

    /// The frames kept beside a run, one below the other; none if there are none.
    std::optional<std::vector<rgb8_image>> frames(std::string const& key, std::size_t count) const {
        auto const path = path_of(key, ".png");
        if (!std::filesystem::exists(path)) {
            return std::nullopt;
        }
        auto const column = read_png(path);
        if (count == 0 || column.height % count != 0) {
            return std::nullopt;
        }
        auto const height = column.height / count;
        std::vector<rgb8_image> frames;
        for (std::size_t i = 0; i < count; ++i) {
            rgb8_image frame({height, column.width}, {0, 0, 0});
            std::copy_n(column.bytes.begin() + static_cast<std::ptrdiff_t>(i * frame.bytes.size()), frame.bytes.size(),
                        frame.bytes.begin());
            frames.push_back(std::move(frame));
        }
        return frames;
    }

    /// Keeps frames [frames, 3, height, width] in [0, 1]. Throws file_error if they cannot be written.
    void keep_frames(std::string const& key, strided_view<float const, 4> images) const {
        rgb8_image column({images.extent(0) * images.extent(2), images.extent(3)}, {0, 0, 0});
        for (std::size_t i = 0; i < images.extent(0); ++i) {
            auto const frame = rgb_picture(images[i]);
            std::copy(frame.bytes.begin(), frame.bytes.end(),
                      column.bytes.begin() + static_cast<std::ptrdiff_t>(i * frame.bytes.size()));
        }
        write_png(path_of(key, ".png"), column);
    }

    /// Keeps a run. Throws file_error if it cannot be written.
    void keep(std::string const& key, kept_run const& run) const {
        nlohmann::json const json{{"key", key}, {"seconds", run.seconds}, {"figures", run.figures}};
        write_text(path_of(key, ".json"), json.dump(1) + '\n');
    }

private:
    std::filesystem::path path_of(std::string const& key, char const* ending) const {
        return folder_ / (hexadecimal(number_of(key)) + ending);
    }

    std::filesystem::path folder_;
};

} // namespace genrender::examples
