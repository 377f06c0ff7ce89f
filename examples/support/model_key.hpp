// SPDX-License-Identifier: MIT
// What tells one model and what it was told from another: fingerprints of files, prompt and depth.
#pragma once

#include <genrender/core/error.hpp>
#include <genrender/core/fingerprint.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace genrender::examples {

/// Takes in the bytes of a file. Throws file_error if it cannot be read.
inline void add_file(fingerprint& to, std::filesystem::path const& path) {
    std::ifstream stream(path, std::ios::binary);
    std::vector<char> block(std::size_t{1} << 20);
    while (stream.read(block.data(), static_cast<std::streamsize>(block.size())) || stream.gcount() > 0) {
        to.add(std::string_view(block.data(), static_cast<std::size_t>(stream.gcount())));
    }
    if (!stream.eof()) {
        throw file_error(path.string() + ": cannot be read, expected a file");
    }
}

/// Takes in names and bytes of the settings and weights that lie in a folder itself; of weights those of the `variant`, or
/// without one the whole ones, where there are any.
inline void add_folder(fingerprint& to, std::filesystem::path const& folder, std::string const& variant) {
    std::vector<std::filesystem::path> files;
    for (auto const& entry : std::filesystem::directory_iterator(folder)) {
        auto const ending = entry.path().extension();
        if (entry.is_regular_file() && (ending == ".json" || ending == ".txt" || ending == ".safetensors")) {
            files.push_back(entry.path());
        }
    }
    std::sort(files.begin(), files.end());
    auto const is_weights = [](auto const& file) { return file.extension() == ".safetensors"; };
    auto const has = [](auto const& file, std::string const& name) {
        return file.filename().string().find("." + name) != std::string::npos;
    };
    auto const is_whole = [&](auto const& file) {
        return !has(file, "fp16") && !has(file, "bf16") && !has(file, "non_ema");
    };
    auto const has_whole =
        std::any_of(files.begin(), files.end(), [&](auto const& file) { return is_weights(file) && is_whole(file); });
    for (auto const& file : files) {
        if (!is_weights(file) || (!variant.empty() ? has(file, variant) : is_whole(file) || !has_whole)) {
            to.add(std::string_view(file.filename().string()));
            add_file(to, file);
        }
    }
}

/// Takes in what lies at a path, if it is not empty: a file, the folder of one network, or the folders of a pipeline.
inline void add_model(fingerprint& to, std::filesystem::path const& path, std::string const& variant = {}) {
    to.add(!path.empty());
    if (!std::filesystem::is_directory(path)) {
        if (!path.empty()) {
            add_file(to, path);
        }
        return;
    }
    constexpr std::array<char const*, 6> parts{"controlnet", "scheduler", "text_encoder", "tokenizer", "unet", "vae"};
    auto const is_pipeline = std::filesystem::is_directory(path / "unet");
    if (!is_pipeline) {
        add_folder(to, path, variant);
    }
    for (auto const* const part : parts) {
        if (is_pipeline && std::filesystem::is_directory(path / part)) {
            to.add(std::string_view(part));
            add_folder(to, path / part, variant);
        }
    }
}

} // namespace genrender::examples
