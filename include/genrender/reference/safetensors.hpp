// SPDX-License-Identifier: MIT
// A checked reader and a small writer of the safetensors format: named tensors behind a JSON header.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/error.hpp>
#include <genrender/reference/checked_json.hpp>
#include <genrender/core/half_precision.hpp>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

static_assert(std::endian::native == std::endian::little, "safetensors: files are little-endian, and read as they lie");

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

/// The tensors of a safetensors file. The header is read and checked whole when the file is opened, each tensor when it
/// is asked for; an object may be read from several threads.
class safetensors_file {
public:
    /// Opens a file. Throws file_error `path: what was found, expected ...` if it cannot be read, or is not a
    /// safetensors file to the letter: lengths beyond the file, a header that is not the JSON it should be, keys that
    /// occur twice, tensors whose bytes do not fit their shape, overlap, leave holes or lie outside.
    explicit safetensors_file(std::string path) : path_(std::move(path)) {
        auto file = open();
        file.seekg(0, std::ios::end);
        auto const file_bytes = static_cast<std::uint64_t>(file.tellg());
        file.seekg(0);
        require(file_bytes >= 8, "file has " + std::to_string(file_bytes) + " bytes",
                "at least the 8 of the header's length");
        std::uint64_t header_bytes = 0;
        read_bytes(file, &header_bytes, 8);
        require(header_bytes <= most_header_bytes, "header has " + std::to_string(header_bytes) + " bytes",
                "at most " + std::to_string(most_header_bytes));
        require(header_bytes <= file_bytes - 8, "header has " + std::to_string(header_bytes) + " bytes",
                "at most the " + std::to_string(file_bytes - 8) + " that follow its length");
        std::string header(header_bytes, '\0');
        read_bytes(file, header.data(), header_bytes);
        data_begin_ = 8 + header_bytes;
        read_header(header);
        check_layout(file_bytes - data_begin_);
    }

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

private:
    static constexpr std::uint64_t most_header_bytes = 100'000'000;

    void require(bool holds, std::string const& found, std::string const& expected) const {
        if (!holds) {
            throw file_error(path_ + ": " + found + ", expected " + expected);
        }
    }

    std::ifstream open() const {
        std::ifstream file(path_, std::ios::binary);
        require(file.is_open(), "file cannot be opened", "a readable safetensors file");
        return file;
    }

    void read_bytes(std::ifstream& file, void* to, std::uint64_t count) const {
        file.read(static_cast<char*>(to), static_cast<std::streamsize>(count));
        require(static_cast<std::uint64_t>(file.gcount()) == count,
                "file ends after " + std::to_string(file.gcount()) + " bytes", std::to_string(count) + " to read");
    }

    void read_header(std::string const& text) {
        auto const header = checked_json(text, path_, "header", "an object of tensors");
        require(header.is_object(), "header is a JSON " + std::string(header.type_name()), "an object of tensors");
        for (auto const& [name, value] : header.items()) {
            if (name == "__metadata__") {
                require(value.is_object(), "__metadata__ is " + std::string(value.type_name()), "an object of strings");
                for (auto const& [key, word] : value.items()) {
                    auto const found = "__metadata__ has a " + std::string(word.type_name()) + " for " + key;
                    require(word.is_string(), found, "a string");
                    metadata_[key] = word.get<std::string>();
                }
            } else {
                entries_[name] = entry_of(name, value);
            }
        }
    }

    safetensors_entry entry_of(std::string const& name, nlohmann::json const& value) const {
        auto const field = [&](char const* key, bool (*fits)(nlohmann::json const&), char const* expected) {
            auto const found = value.is_object() ? value.find(key) : value.end();
            require(value.is_object() && found != value.end(), "tensor " + name + " has no " + key, expected);
            require(fits(*found), "tensor " + name + " has " + key + " " + found->dump().substr(0, 80), expected);
            return *found;
        };
        auto const is_text = [](nlohmann::json const& json) { return json.is_string(); };
        auto const is_counts = [](nlohmann::json const& json) {
            return json.is_array() &&
                   std::all_of(json.begin(), json.end(), [](auto const& x) { return x.is_number_unsigned(); });
        };
        safetensors_entry entry;
        entry.dtype = field("dtype", is_text, "the name of a type").get<std::string>();
        for (auto const& extent : field("shape", is_counts, "whole numbers of at least 0")) {
            entry.shape.push_back(extent.get<std::size_t>());
        }
        auto const offsets = field("data_offsets", is_counts, "two whole numbers of at least 0");
        require(offsets.size() == 2, "tensor " + name + " has " + std::to_string(offsets.size()) + " data_offsets",
                "two");
        entry.begin = offsets[0].get<std::uint64_t>();
        entry.end = offsets[1].get<std::uint64_t>();
        return entry;
    }

    void check_layout(std::uint64_t data_bytes) const {
        std::vector<std::map<std::string, safetensors_entry>::const_pointer> in_order;
        for (auto const& item : entries_) {
            auto const& [name, entry] = item;
            auto const place = "tensor " + name + " has data_offsets " + extents_text({entry.begin, entry.end});
            require(entry.begin <= entry.end, place, "begin <= end");
            require(entry.end <= data_bytes, place,
                    "an end within the " + std::to_string(data_bytes) + " bytes of data");
            if (auto const bytes = internal::element_bytes(entry.dtype)) {
                auto shape = entry.shape;
                shape.push_back(*bytes);
                auto const expected = internal::checked_product(shape);
                auto const size = entry.dtype + " " + extents_text(entry.shape);
                require(expected.has_value(), "tensor " + name + " is " + size, "a size that fits 64 bits");
                require(entry.end - entry.begin == *expected, place, std::to_string(*expected) + " bytes for " + size);
            }
            in_order.push_back(&item);
        }
        std::sort(in_order.begin(), in_order.end(), [](auto const* a, auto const* b) {
            return std::pair(a->second.begin, a->second.end) < std::pair(b->second.begin, b->second.end);
        });
        std::uint64_t end = 0;
        std::string before = "the header";
        for (auto const* item : in_order) {
            auto const place = "tensor " + item->first + " begins at byte " + std::to_string(item->second.begin);
            require(item->second.begin >= end, place,
                    std::to_string(end) + " where " + before + " ends (they overlap)");
            require(item->second.begin <= end, place,
                    std::to_string(end) + " where " + before + " ends (there is a hole)");
            end = item->second.end;
            before = "tensor " + item->first;
        }
        require(end == data_bytes, "data has " + std::to_string(data_bytes) + " bytes",
                std::to_string(end) + " where " + before + " ends");
    }

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

    std::string path_;
    std::uint64_t data_begin_ = 0;
    std::map<std::string, safetensors_entry> entries_;
    std::map<std::string, std::string> metadata_;
};

/// A tensor to be written: row-major elements of the given shape.
struct safetensors_source {
    std::vector<std::size_t> shape; ///< extents of its axes
    std::span<float const> values;  ///< its elements; not owned
};

/// How a tensor's elements are stored.
enum class safetensors_storage {
    f32, ///< as they are
    f16  ///< rounded to the nearest of IEEE binary16
};

/// Writes the tensors in the order of their names, data aligned to 8 bytes. Throws shape_error if values do not fill
/// their shape, file_error if the file cannot be written.
inline void write_safetensors(std::string const& path, std::map<std::string, safetensors_source> const& tensors,
                              safetensors_storage storage = safetensors_storage::f32) {
    auto const halves = storage == safetensors_storage::f16;
    auto header = nlohmann::json::object();
    std::string data;
    for (auto const& [name, source] : tensors) {
        require_extents("write_safetensors", name.c_str(), std::array{source.values.size()},
                        std::array{internal::checked_product(source.shape).value_or(0)});
        auto const begin = data.size();
        for (auto const value : source.values) {
            auto const half = half_of_float(value);
            data.append(halves ? reinterpret_cast<char const*>(&half) : reinterpret_cast<char const*>(&value),
                        halves ? sizeof half : sizeof value);
        }
        header[name] = {
            {"dtype", halves ? "F16" : "F32"}, {"shape", source.shape}, {"data_offsets", {begin, data.size()}}};
    }
    auto text = header.dump();
    text.append((8 - text.size() % 8) % 8, ' ');
    auto const text_bytes = std::uint64_t{text.size()};
    std::ofstream file(path, std::ios::binary);
    file.write(reinterpret_cast<char const*>(&text_bytes), 8) << text << data << std::flush;
    if (!file) {
        throw file_error(path + ": file cannot be written, expected a writable place");
    }
}

} // namespace genrender::reference

#include <genrender/core/end_header.inl>
