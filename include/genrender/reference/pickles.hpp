// SPDX-License-Identifier: MIT
// Checkpoints that are Python pickles, which are programs: told from safetensors, and refused with the way out.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/error.hpp>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <string>
#include <system_error>
#include <vector>

namespace genrender::reference {

/// Whether a file is named as PyTorch's pickles are: `.bin`, `.ckpt`, `.pt` or `.pth`.
inline bool is_pickle_name(std::filesystem::path const& path) {
    auto const extension = path.extension().string();
    return extension == ".bin" || extension == ".ckpt" || extension == ".pt" || extension == ".pth";
}

/// Whether a file begins as PyTorch's pickles do: with a ZIP archive or a pickle of protocol 2 and later. False for one
/// that cannot be read.
inline bool is_pickle_content(std::filesystem::path const& path) {
    std::ifstream file(path, std::ios::binary);
    std::array<char, 8> begin{};
    file.read(begin.data(), begin.size());
    auto const count = file.gcount();
    auto const is_archive = begin[0] == 'P' && begin[1] == 'K' && begin[2] == 3 && begin[3] == 4;
    // A safetensors file may begin with these two bytes of its header's length too, but has a brace behind all eight.
    auto const is_bare = begin[0] == '\x80' && begin[1] >= 2 && begin[1] <= 5 && file.peek() != '{';
    return count >= 4 && (is_archive || is_bare);
}

/// Why a pickle is not read, and a command that makes a safetensors file of it.
inline std::string pickle_refusal(std::filesystem::path const& path) {
    auto safe = path;
    safe.replace_extension(".safetensors");
    return path.string() +
           ": file is a Python pickle, and to read one is to run the code in it, expected a safetensors file; if you "
           "trust where it is from, convert it with: python3 -c \"import sys, torch; from safetensors.torch import "
           "save_file; s = torch.load(sys.argv[1], map_location='cpu', weights_only=True); s = s.get('state_dict', s); "
           "save_file({k: v.clone().contiguous() for k, v in s.items() if torch.is_tensor(v)}, sys.argv[2])\" '" +
           path.string() + "' '" + safe.string() + "'";
}

/// Throws file_error with pickle_refusal if the name or the content of a file is a pickle's.
inline void refuse_pickle(std::filesystem::path const& path) {
    if (is_pickle_name(path) || is_pickle_content(path)) {
        throw file_error(pickle_refusal(path));
    }
}

/// The pickles right in a folder, by name; none if it cannot be read.
inline std::vector<std::filesystem::path> pickles_in(std::filesystem::path const& folder) {
    std::vector<std::filesystem::path> found;
    std::error_code ignored;
    for (auto const& entry : std::filesystem::directory_iterator(folder, ignored)) {
        if (is_pickle_name(entry.path())) {
            found.push_back(entry.path());
        }
    }
    std::sort(found.begin(), found.end());
    return found;
}

} // namespace genrender::reference

#include <genrender/core/end_header.inl>
