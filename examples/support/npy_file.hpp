// SPDX-License-Identifier: MIT
// Latents as a file that NumPy reads: format .npy, version 1.0.
#pragma once

#include "output_file.hpp"

#include <genrender/core/strided_view.hpp>

#include <bit>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace genrender::examples {

/// Writes z [frames, channels, height, width] as `path` in 32 bits, little-endian, the last axis running fastest; `numpy.load`
/// gives an array of the same shape. Throws file_error if it cannot be written.
inline void write_npy(std::filesystem::path const& path, strided_view<float const, 4> z) {
    auto const& extents = z.extents();
    std::string header = "{'descr': '<f4', 'fortran_order': False, 'shape': (";
    for (auto const extent : extents) {
        header += std::to_string(extent) + ", ";
    }
    header += "), }";
    // Magic word, version and length are 10 bytes; elements begin at a multiple of 64, after the header's end of line.
    header.resize((10 + header.size()) / 64 * 64 + 64 - 10 - 1, ' ');
    header += '\n';
    std::vector<std::uint8_t> bytes{0x93, 'N', 'U', 'M', 'P', 'Y', 1, 0};
    bytes.push_back(static_cast<std::uint8_t>(header.size() % 256));
    bytes.push_back(static_cast<std::uint8_t>(header.size() / 256));
    bytes.insert(bytes.end(), header.begin(), header.end());
    bytes.reserve(bytes.size() + 4 * z.size());
    for (std::size_t i = 0; i < extents[0]; ++i) {
        for (std::size_t c = 0; c < extents[1]; ++c) {
            for (std::size_t row = 0; row < extents[2]; ++row) {
                for (std::size_t column = 0; column < extents[3]; ++column) {
                    auto const bits = std::bit_cast<std::uint32_t>(z(i, c, row, column));
                    for (unsigned shift = 0; shift < 32; shift += 8) {
                        bytes.push_back(static_cast<std::uint8_t>(bits >> shift & 0xffU));
                    }
                }
            }
        }
    }
    write_bytes(path, bytes);
}

} // namespace genrender::examples
