// SPDX-License-Identifier: MIT
// Named tensors in a file: what they are, where they lie, and their elements when they are asked for.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/error.hpp>
#include <genrender/core/half_precision.hpp>

#include <algorithm>
#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

static_assert(std::endian::native == std::endian::little, "tensor_file: files are little-endian, and read as they lie");

namespace genrender::reference {

/// Where and what one tensor of a safetensors file is.
struct safetensors_entry {
    std::string dtype;              ///< as the file writes it, say `F16`
    std::vector<std::size_t> shape; ///< empty for a single value
    std::uint64_t begin = 0;        ///< first byte, counted from the end of the header
    std::uint64_t end = 0;          ///< one past the last byte
};

namespace internal {

/// Bytes of one element, or nothing for a dtype this reader does not know.
inline std::optional<std::uint64_t> element_bytes(std::string const& dtype) {
    static std::map<std::string, std::uint64_t> const sizes{
        {"F64", 8}, {"F32", 4}, {"F16", 2}, {"BF16", 2}, {"F8_E4M3", 1}, {"F8_E5M2", 1}, {"I64", 8}, {"I32", 4},
        {"I16", 2}, {"I8", 1},  {"U64", 8}, {"U32", 4},  {"U16", 2},     {"U8", 1},      {"BOOL", 1}};
    auto const found = sizes.find(dtype);
    return found == sizes.end() ? std::nullopt : std::optional(found->second);
}

/// The product of the extents, or nothing if it does not fit 64 bits.
inline std::optional<std::uint64_t> checked_product(std::vector<std::size_t> const& shape) {
    if (std::find(shape.begin(), shape.end(), 0U) != shape.end()) {
        return 0;
    }
    std::uint64_t product = 1;
    for (auto const extent : shape) {
        if (product > std::numeric_limits<std::uint64_t>::max() / extent) {
            return std::nullopt;
        }
        product *= extent;
    }
    return product;
}

} // namespace internal

/// The tensors of a safetensors file whose header was read (see safetensors_file). Each tensor is read when it is asked
/// for; an object may be read from several threads.
class tensor_file {
public:
    /// Path of the file that it was read from.
    std::string const& path() const { return path_; }
    /// All tensors by name, those of types that cannot be read included.
    std::map<std::string, safetensors_entry> const& entries() const { return entries_; }
    /// The texts under `__metadata__`.
    std::map<std::string, std::string> const& metadata() const { return metadata_; }

    /// What a tensor is and where it lies. Throws file_error if there is no such tensor.
    safetensors_entry const& entry(std::string const& name) const {
        auto const found = entries_.find(name);
        require(found != entries_.end(), "there is no tensor " + name,
                "one among the " + std::to_string(entries_.size()) + " of the file");
        return found->second;
    }

    /// The elements of a tensor, row-major, converted to Real from F64, F32, F16 or BF16. Throws file_error if there is
    /// no such tensor or it is of another type.
    template <std::floating_point Real>
    std::vector<Real> read(std::string const& name) const {
        return read<Real>(name, 0, static_cast<std::size_t>(internal::checked_product(entry(name).shape).value_or(0)));
    }

    /// The same of `count` elements from element `first` on, and no more of the file. Throws file_error if the tensor
    /// has fewer.
    template <std::floating_point Real>
    std::vector<Real> read(std::string const& name, std::size_t first, std::size_t count) const {
        auto const& entry = this->entry(name);
        auto const is_number =
            entry.dtype == "F64" || entry.dtype == "F32" || entry.dtype == "F16" || entry.dtype == "BF16";
        require(is_number, "tensor " + name + " has dtype " + entry.dtype, "F64, F32, F16 or BF16");
        auto const width = *internal::element_bytes(entry.dtype);
        auto const stored = (entry.end - entry.begin) / width;
        require(first <= stored && count <= stored - first,
                "tensor " + name + " has " + std::to_string(stored) + " elements",
                std::to_string(count) + " from element " + std::to_string(first) + " on");
        std::vector<char> bytes(count * width);
        auto file = open();
        file.seekg(static_cast<std::streamoff>(data_begin_ + entry.begin + first * width));
        read_bytes(file, bytes.data(), bytes.size());
        if (entry.dtype == "F64") {
            return converted<Real, double>(bytes, [](double value) { return value; });
        }
        if (entry.dtype == "F32") {
            return converted<Real, float>(bytes, [](float value) { return value; });
        }
        return converted<Real, std::uint16_t>(bytes, entry.dtype == "F16" ? float_of_half : float_of_bfloat16);
    }

protected:
    /// A file of which nothing is known yet.
    explicit tensor_file(std::string path) : path_(std::move(path)) {}

    /// Throws file_error `path: found, expected ...` unless it holds.
    void require(bool holds, std::string const& found, std::string const& expected) const {
        if (!holds) {
            throw file_error(path_ + ": " + found + ", expected " + expected);
        }
    }

    /// The file, to be read. Throws file_error if it cannot be opened.
    std::ifstream open() const {
        std::ifstream file(path_, std::ios::binary);
        require(file.is_open(), "file cannot be opened", "a readable safetensors file");
        return file;
    }

    /// Reads bytes where the file stands. Throws file_error if it ends before.
    void read_bytes(std::ifstream& file, void* to, std::uint64_t count) const {
        file.read(static_cast<char*>(to), static_cast<std::streamsize>(count));
        require(static_cast<std::uint64_t>(file.gcount()) == count,
                "file ends after " + std::to_string(file.gcount()) + " bytes", std::to_string(count) + " to read");
    }

    std::string path_;                                 ///< of the file
    std::uint64_t data_begin_ = 0;                     ///< first byte after the header
    std::map<std::string, safetensors_entry> entries_; ///< by name
    std::map<std::string, std::string> metadata_;      ///< texts under `__metadata__`

private:
    template <class Real, class Stored, class Convert>
    static std::vector<Real> converted(std::vector<char> const& bytes, Convert const& convert) {
        std::vector<Real> values(bytes.size() / sizeof(Stored));
        for (std::size_t i = 0; i < values.size(); ++i) {
            Stored stored;
            std::memcpy(&stored, bytes.data() + i * sizeof(Stored), sizeof(Stored));
            values[i] = static_cast<Real>(convert(stored));
        }
        return values;
    }
};

} // namespace genrender::reference

#include <genrender/core/end_header.inl>
