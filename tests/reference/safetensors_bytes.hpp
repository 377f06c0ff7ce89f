// SPDX-License-Identifier: MIT
// Safetensors files byte by byte.
#pragma once

#include <cstdint>
#include <fstream>
#include <string>
#include <vector>

namespace genrender::testing {

/// A file of this header and this data.
inline std::string safetensors_bytes(std::string const& header, std::string const& data = "") {
    auto const length = std::uint64_t{header.size()};
    return std::string(reinterpret_cast<char const*>(&length), 8) + header + data;
}

/// A file of these bytes.
inline void write_bytes(std::string const& path, std::string const& bytes) {
    std::ofstream(path, std::ios::binary) << bytes;
}

/// Numbers as they lie.
inline std::string bytes_of(std::vector<float> const& values) {
    return {reinterpret_cast<char const*>(values.data()), values.size() * sizeof(float)};
}

} // namespace genrender::testing
