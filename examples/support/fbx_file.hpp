// SPDX-License-Identifier: MIT
// The bytes of an FBX file, text or binary, with its animation curves replaced by ones of straight lines.
#pragma once

#include "fbx_binary.hpp"
#include "fbx_curve.hpp"

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

namespace genrender::examples {

namespace detail {

/// The text form.
class fbx_text {
public:
    explicit fbx_text(std::string_view text) : text_(text) {}

    std::optional<std::string> straightened_text() const {
        std::string result;
        std::size_t copied = 0;
        constexpr std::string_view opening = "AnimationCurve:";
        for (auto at = text_.find(opening); at != text_.npos; at = text_.find(opening, at + 1)) {
            auto const begin = text_.find('{', at);
            require_understood(begin != text_.npos);
            auto const end = end_of_block(begin);
            if (auto const curve = straightened(curve_in(text_.substr(begin, end - begin)))) {
                result += text_.substr(copied, begin + 1 - copied);
                result += "\nKeyTime: *" + list(curve->times) + "KeyValueFloat: *" + list(curve->values);
                copied = end;
            }
            at = end;
        }
        if (copied == 0) {
            return std::nullopt;
        }
        return result += text_.substr(copied);
    }

private:
    /// Where the brace stands that closes the one at `begin`.
    std::size_t end_of_block(std::size_t begin) const {
        std::size_t depth = 0;
        for (auto at = begin; at < text_.size(); ++at) {
            if (text_[at] == '"' || text_[at] == ';') {
                at = text_.find(text_[at] == '"' ? '"' : '\n', at + 1);
                require_understood(at != text_.npos);
            }
            depth += text_[at] == '{';
            if (text_[at] == '}' && --depth == 0) {
                return at;
            }
        }
        throw not_understood();
    }

    template <class Number>
    static std::vector<Number> numbers(std::string_view block, std::string_view name) {
        std::vector<Number> result;
        auto at = block.find(std::string(name) + ": *");
        if (at == block.npos) {
            return result;
        }
        at = block.find("a:", at);
        auto const end = block.find('}', at);
        require_understood(at != block.npos && end != block.npos);
        auto const* now = block.data() + at + 2;
        auto const* const last = block.data() + end;
        while ((now = std::find_if(now, last, [](char c) {
                    return c != ',' && c != ' ' && c != '\t' && c != '\r' && c != '\n';
                })) != last) {
            Number value{};
            auto const [rest, error] = std::from_chars(now, last, value);
            require_understood(error == std::errc());
            result.push_back(value);
            now = rest;
        }
        return result;
    }

    static fbx_curve curve_in(std::string_view block) {
        fbx_curve curve{numbers<std::int64_t>(block, "KeyTime"), numbers<float>(block, "KeyValueFloat"), {}};
        auto const flags = numbers<std::int32_t>(block, "KeyAttrFlags");
        auto const data =
            numbers<double>(block, "KeyAttrDataFloat"); // the bits of the third of four are a whole number
        require_understood(data.size() == 4 * flags.size());
        std::vector<fbx_key_attributes> runs;
        for (std::size_t i = 0; i < flags.size(); ++i) {
            auto const bits = std::clamp(data[4 * i + 2], 0.0, 4294967295.0);
            runs.push_back({flags[i], static_cast<float>(data[4 * i]), static_cast<float>(data[4 * i + 1]),
                            static_cast<std::uint32_t>(bits)});
        }
        curve.attributes =
            attributes_of_keys(runs, numbers<std::int32_t>(block, "KeyAttrRefCount"), curve.times.size());
        return curve;
    }

    template <class Number>
    static std::string list(std::vector<Number> const& values) {
        std::string text = std::to_string(values.size()) + " {\na: ";
        for (std::size_t i = 0; i < values.size(); ++i) {
            char number[32];
            text.append(i > 0 ? "," : "").append(number, std::to_chars(number, number + sizeof number, values[i]).ptr);
        }
        return text + "\n}\n";
    }

    std::string_view text_;
};

} // namespace detail

/// The file with denser keys (see straightened), for readers that know nothing but straight lines between keys.
/// Nothing if it has no other curves, or is none that is understood.
inline std::optional<std::string> with_straight_curves(std::string_view file) {
    try {
        return file.substr(0, detail::fbx_binary::magic.size()) == detail::fbx_binary::magic
                   ? detail::fbx_binary(file).straightened_bytes()
                   : detail::fbx_text(file).straightened_text();
    } catch (detail::not_understood const&) {
        return std::nullopt;
    }
}

} // namespace genrender::examples
