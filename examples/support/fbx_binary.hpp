// SPDX-License-Identifier: MIT
// A binary FBX file with its animation curves replaced by ones of straight lines.
#pragma once

#include "fbx_curve.hpp"

#include <zlib.h>

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace genrender::examples {

namespace detail {

/// The binary form: records of an end, properties, a name and records within.
class fbx_binary {
public:
    static constexpr std::string_view magic{"Kaydara FBX Binary  \0\x1a\0", 23};

    explicit fbx_binary(std::string_view bytes) : bytes_(bytes) {
        require_understood(std::endian::native == std::endian::little);
        is_wide_ = number_at<std::uint32_t>(magic.size()) >= 7500;
    }

    std::optional<std::string> straightened_bytes() {
        auto at = magic.size() + sizeof(std::uint32_t);
        result_ = bytes_.substr(0, at);
        while (!is_end(at)) {
            at = copy(at, bytes_.size(), 0);
        }
        result_ += bytes_.substr(at);
        return has_changed_ ? std::optional(std::move(result_)) : std::nullopt;
    }

private:
    struct record {
        std::size_t end = 0;
        std::string_view name;
        std::size_t properties = 0; ///< where they begin
        std::size_t within = 0;     ///< where the records within begin
    };

    template <class Number>
    Number number_at(std::size_t at) const {
        require_understood(at <= bytes_.size() && bytes_.size() - at >= sizeof(Number));
        Number value;
        std::memcpy(&value, bytes_.data() + at, sizeof value);
        return value;
    }

    std::size_t width() const { return is_wide_ ? 8 : 4; }
    std::size_t word(std::size_t at) const {
        return is_wide_ ? static_cast<std::size_t>(number_at<std::uint64_t>(at)) : number_at<std::uint32_t>(at);
    }
    bool is_end(std::size_t at) const { return word(at) == 0; }

    record record_at(std::size_t at) const {
        record one;
        one.end = word(at);
        auto const length = word(at + 2 * width());
        auto const name = number_at<std::uint8_t>(at + 3 * width());
        one.properties = at + 3 * width() + 1 + name;
        require_understood(one.end <= bytes_.size() && one.properties <= one.end && length <= one.end - one.properties);
        one.name = bytes_.substr(one.properties - name, name);
        one.within = one.properties + length;
        return one;
    }

    void append(void const* data, std::size_t size) { result_.append(static_cast<char const*>(data), size); }
    void append_word(std::uint64_t value) { append(&value, width()); } // the lower half comes first
    void put_word(std::size_t at, std::uint64_t value) { std::memcpy(result_.data() + at, &value, width()); }

    /// Copies a record with all within, which must end before `limit`, and returns where it ends in the file.
    std::size_t copy(std::size_t at, std::size_t limit, int depth) {
        auto const one = record_at(at);
        require_understood(depth < 64 && one.end <= limit);
        auto const begin = result_.size();
        result_ += bytes_.substr(at, one.within - at);
        auto const curve = one.name == "AnimationCurve" ? straightened(curve_in(one)) : std::nullopt;
        if (curve) {
            has_changed_ = true;
            append_list("KeyTime", 'l', curve->times);
            append_list("KeyValueFloat", 'f', curve->values);
            result_.append(3 * width() + 1, '\0');
        } else if (one.within < one.end) {
            for (auto inner = one.within; inner < one.end;) {
                if (is_end(inner)) {
                    result_ += bytes_.substr(inner, one.end - inner);
                    break;
                }
                inner = copy(inner, one.end, depth + 1);
            }
        }
        put_word(begin, result_.size());
        return one.end;
    }

    template <class Number>
    void append_list(std::string_view name, char type, std::vector<Number> const& values) {
        auto const begin = result_.size();
        auto const size = static_cast<std::uint32_t>(values.size() * sizeof(Number));
        append_word(0);
        append_word(1);
        append_word(1 + 3 * sizeof(std::uint32_t) + size);
        result_ += static_cast<char>(name.size());
        result_ += name;
        result_ += type;
        std::uint32_t const head[3]{static_cast<std::uint32_t>(values.size()), 0, size}; // 0: as it is
        append(head, sizeof head);
        append(values.data(), size);
        put_word(begin, result_.size());
    }

    /// The numbers of the record within `parent` that is called so; none if there is none.
    template <class Number>
    std::vector<Number> numbers(record const& parent, std::string_view name) const {
        for (auto at = parent.within; at < parent.end && !is_end(at);) {
            auto const one = record_at(at);
            if (one.name == name) {
                return numbers_at<Number>(one.properties);
            }
            require_understood(one.end > at);
            at = one.end;
        }
        return {};
    }

    template <class Number>
    std::vector<Number> numbers_at(std::size_t at) const {
        auto const type = number_at<char>(at);
        auto const count = number_at<std::uint32_t>(at + 1);
        auto const packing = number_at<std::uint32_t>(at + 5);
        auto const size = number_at<std::uint32_t>(at + 9);
        auto const expected = std::is_same_v<Number, std::int64_t> ? "l" : std::is_same_v<Number, float> ? "f" : "i";
        require_understood(type == *expected && at + 13 <= bytes_.size() && size <= bytes_.size() - at - 13 &&
                           count / 1100 <= size); // zlib packs 1032 bytes into one at best
        std::vector<Number> values(count);
        auto const wanted = count * sizeof(Number);
        if (packing == 0) {
            require_understood(size == wanted);
            std::memcpy(values.data(), bytes_.data() + at + 13, wanted);
        } else {
            auto got = static_cast<uLongf>(wanted);
            auto const* const packed = reinterpret_cast<Bytef const*>(bytes_.data() + at + 13);
            require_understood(uncompress(reinterpret_cast<Bytef*>(values.data()), &got, packed, size) == Z_OK &&
                               got == wanted);
        }
        return values;
    }

    fbx_curve curve_in(record const& one) const {
        fbx_curve curve{numbers<std::int64_t>(one, "KeyTime"), numbers<float>(one, "KeyValueFloat"), {}};
        auto const flags = numbers<std::int32_t>(one, "KeyAttrFlags");
        auto const data = numbers<float>(one, "KeyAttrDataFloat");
        require_understood(data.size() == 4 * flags.size());
        std::vector<fbx_key_attributes> runs;
        for (std::size_t i = 0; i < flags.size(); ++i) {
            runs.push_back({flags[i], data[4 * i], data[4 * i + 1], std::bit_cast<std::uint32_t>(data[4 * i + 2])});
        }
        curve.attributes = attributes_of_keys(runs, numbers<std::int32_t>(one, "KeyAttrRefCount"), curve.times.size());
        return curve;
    }

    std::string_view bytes_;
    bool is_wide_ = false; ///< records of 64 bits
    bool has_changed_ = false;
    std::string result_;
};

} // namespace detail

} // namespace genrender::examples
