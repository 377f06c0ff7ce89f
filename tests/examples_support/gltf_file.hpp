// SPDX-License-Identifier: MIT
// glTF 2.0 files made by tests: a triangle or two, with nodes, skins, morph targets and animations to order.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <initializer_list>
#include <string>
#include <vector>

namespace genrender::tests {

/// Collects numbers into one buffer and writes the file's text.
class gltf_file {
public:
    std::string nodes;      ///< the elements of "nodes"; the scene's root is node 0
    std::string meshes;     ///< the elements of "meshes"
    std::string skins;      ///< the elements of "skins"
    std::string animations; ///< the elements of "animations"
    std::string cameras;    ///< the elements of "cameras"
    std::string more;       ///< further members of the file, each with a comma before it

    /// Adds floats as an accessor of `type` (SCALAR, VEC2, VEC3, VEC4, MAT4) and returns its number as text.
    std::string add(char const* type, std::initializer_list<float> values) {
        auto const width = std::strcmp(type, "SCALAR") == 0 ? 1u
                           : std::strcmp(type, "MAT4") == 0 ? 16u
                                                            : unsigned(type[3] - '0');
        std::string bounds;
        if (width == 1 || width == 3) {
            bounds = range_text(values, width);
        }
        return add_bytes(type, 5126, values.size() / width, values.begin(), values.size() * sizeof(float), bounds);
    }

    /// Adds 16-bit integers.
    std::string add_integers(char const* type, std::initializer_list<std::uint16_t> values) {
        auto const width = std::strcmp(type, "SCALAR") == 0 ? 1u : unsigned(type[3] - '0');
        return add_bytes(type, 5123, values.size() / width, values.begin(), values.size() * sizeof(std::uint16_t), "");
    }

    /// Adds integers of any type of at most 16 bits that stand for [0, 1] or [-1, 1].
    template <class Integer>
    std::string add_normalized(char const* type, std::initializer_list<Integer> values) {
        auto const component = 5120 + (sizeof(Integer) == 2 ? 2 : 0) + (Integer(-1) > Integer(0) ? 1 : 0);
        auto const width = std::strcmp(type, "SCALAR") == 0 ? 1u : unsigned(type[3] - '0');
        return add_bytes(type, component, values.size() / width, values.begin(), values.size() * sizeof(Integer),
                         ", \"normalized\": true");
    }

    /// Adds an accessor by its text, and returns its number as text.
    std::string add_accessor(std::string const& text) {
        accessors_ += (accessor_count_ == 0 ? "" : ",\n") + text;
        return std::to_string(accessor_count_++);
    }

    std::string text() const {
        auto const list = [](char const* name, std::string const& elements) {
            return elements.empty() ? std::string{} : std::string(",\n\"") + name + "\": [" + elements + "]";
        };
        return "{\"asset\": {\"version\": \"2.0\"}, \"scene\": 0, \"scenes\": [{\"nodes\": [0]}]" +
               list("nodes", nodes) + list("meshes", meshes) + list("skins", skins) + list("animations", animations) +
               list("cameras", cameras) + more + list("accessors", accessors_) + list("bufferViews", views_) +
               ",\n\"buffers\": [{\"byteLength\": " + std::to_string(bytes_.size()) +
               ", \"uri\": \"data:application/octet-stream;base64," + base64() + "\"}]}\n";
    }

private:
    static std::string range_text(std::initializer_list<float> values, std::size_t width) {
        std::string lower, upper;
        for (std::size_t axis = 0; axis < width; ++axis) {
            auto low = values.begin()[axis], high = low;
            for (auto i = axis; i < values.size(); i += width) {
                low = low < values.begin()[i] ? low : values.begin()[i];
                high = high > values.begin()[i] ? high : values.begin()[i];
            }
            auto const* const comma = axis > 0 ? ", " : "";
            lower.append(comma).append(std::to_string(low));
            upper.append(comma).append(std::to_string(high));
        }
        return ", \"min\": [" + lower + "], \"max\": [" + upper + "]";
    }

    std::string add_bytes(char const* type, int component, std::size_t count, void const* data, std::size_t size,
                          std::string const& bounds) {
        auto const view = std::to_string(view_count_++);
        views_ += (view == "0" ? "" : ",\n") + std::string("{\"buffer\": 0, \"byteOffset\": ") +
                  std::to_string(bytes_.size()) + ", \"byteLength\": " + std::to_string(size) + "}";
        auto const number =
            add_accessor("{\"bufferView\": " + view + ", \"componentType\": " + std::to_string(component) +
                         ", \"count\": " + std::to_string(count) + ", \"type\": \"" + type + "\"" + bounds + "}");
        auto const* const first = static_cast<unsigned char const*>(data);
        bytes_.insert(bytes_.end(), first, first + size);
        bytes_.resize((bytes_.size() + 3) / 4 * 4);
        return number;
    }

    std::string base64() const {
        static constexpr char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
        std::string text;
        for (std::size_t i = 0; i < bytes_.size(); i += 3) {
            std::uint32_t group = 0;
            auto const present = bytes_.size() - i < 3 ? bytes_.size() - i : 3;
            for (std::size_t k = 0; k < 3; ++k) {
                group = group << 8 | (k < present ? bytes_[i + k] : 0u);
            }
            for (std::size_t k = 0; k < 4; ++k) {
                text += k <= present ? digits[group >> (18 - 6 * k) & 63] : '=';
            }
        }
        return text;
    }

    std::string accessors_;
    std::string views_;
    std::size_t accessor_count_ = 0;
    std::size_t view_count_ = 0;
    std::vector<unsigned char> bytes_;
};

} // namespace genrender::tests
