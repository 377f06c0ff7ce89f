// SPDX-License-Identifier: MIT
// A checked reader and a small writer of the safetensors format: named tensors behind a JSON header.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/error.hpp>
#include <genrender/core/half_precision.hpp>
#include <genrender/reference/checked_json.hpp>
#include <genrender/reference/tensor_file.hpp>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <fstream>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace genrender::reference {

/// The tensors of a safetensors file. The header is read and checked whole when the file is opened.
class safetensors_file : public tensor_file {
public:
    /// Opens a file. Throws file_error `path: what was found, expected ...` if it cannot be read, or is not a
    /// safetensors file to the letter: lengths beyond the file, a header that is not the JSON it should be, keys that
    /// occur twice, tensors whose bytes do not fit their shape, overlap, leave holes or lie outside.
    explicit safetensors_file(std::string path) : tensor_file(std::move(path)) {
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

private:
    static constexpr std::uint64_t most_header_bytes = 100'000'000;

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
        auto const* const values = source.values.data();
        auto const count = source.values.size();
        if (halves) {
            std::vector<std::uint16_t> rounded(count);
            std::transform(values, values + count, rounded.data(), half_of_float);
            data.append(reinterpret_cast<char const*>(rounded.data()), count * sizeof(std::uint16_t));
        } else {
            data.append(reinterpret_cast<char const*>(values), count * sizeof(float));
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
