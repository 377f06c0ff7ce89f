// SPDX-License-Identifier: MIT
// A checked reader of a config.json: an object of options, each of which somebody must know.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/error.hpp>
#include <genrender/reference/checked_json.hpp>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <initializer_list>
#include <iterator>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace genrender::reference {

/// The options of a config.json. It remembers which were taken, so that one that nobody knows is found too. An option
/// that the file does not hold has the value that its writer would have given it, which each reader brings.
class config_file {
public:
    /// Reads a file. Throws file_error if it cannot be read or is not a JSON object, each key once.
    explicit config_file(std::filesystem::path const& path) : path_(path.string()) {
        std::ifstream file(path, std::ios::binary);
        // A folder opens too, but has no first byte.
        if (!file.is_open() || (file.peek() == std::ifstream::traits_type::eof() && file.bad())) {
            throw file_error(path_ + ": file cannot be opened, expected a readable JSON file");
        }
        std::string const text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
        options_ = checked_json(text, path_, "file", "an object of options");
        require_object();
    }

    /// Options that are known without a config.json, `path` being the file to blame for them. Throws file_error if they
    /// are no JSON object.
    config_file(std::string path, nlohmann::json options) : path_(std::move(path)), options_(std::move(options)) {
        require_object();
    }

    /// Path of the file that it was read from.
    std::string const& path() const { return path_; }

    /// The value of an option as it stands there, null if it does not.
    nlohmann::json const& operator[](std::string const& option) const {
        static nlohmann::json const null;
        auto const found = options_.find(option);
        return found == options_.end() ? null : *found;
    }

    /// Throws file_error `path: option NAME is FOUND, expected EXPECTED` unless `holds`.
    void require(bool holds, std::string const& option, std::string const& expected) const {
        if (!holds) {
            auto const found = options_.contains(option) ? shortened((*this)[option].dump()) : std::string("absent");
            throw file_error(path_ + ": option " + option + " is " + found + ", expected " + expected);
        }
    }

    /// A whole number from 1 to 1000000.
    std::size_t count(std::string const& option, std::size_t absent) {
        auto const& value = take(option);
        require(is_absent(option) || is_count(value), option, "a whole number from 1 to 1000000");
        return is_absent(option) ? absent : value.get<std::size_t>();
    }

    /// A number.
    double number(std::string const& option, double absent) {
        auto const& value = take(option);
        require(is_absent(option) || value.is_number(), option, "a number");
        return is_absent(option) ? absent : value.get<double>();
    }

    /// True or false.
    bool flag(std::string const& option, bool absent) {
        auto const& value = take(option);
        require(is_absent(option) || value.is_boolean(), option, "true or false");
        return is_absent(option) ? absent : value.get<bool>();
    }

    /// A text.
    std::string text(std::string const& option, std::string const& absent) {
        auto const& value = take(option);
        require(is_absent(option) || value.is_string(), option, "a text");
        return is_absent(option) ? absent : value.get<std::string>();
    }

    /// Texts.
    std::vector<std::string> texts(std::string const& option, std::vector<std::string> const& absent) {
        auto const& value = take(option);
        auto const is_text = [](nlohmann::json const& entry) { return entry.is_string(); };
        require(is_absent(option) || (value.is_array() && std::all_of(value.begin(), value.end(), is_text)), option,
                "a list of texts");
        return is_absent(option) ? absent : value.get<std::vector<std::string>>();
    }

    /// Whole numbers from 1 to 1000000, at least one.
    std::vector<std::size_t> counts(std::string const& option, std::vector<std::size_t> const& absent) {
        auto const& value = take(option);
        require(is_absent(option) ||
                    (value.is_array() && !value.empty() && std::all_of(value.begin(), value.end(), is_count)),
                option, "a list of whole numbers from 1 to 1000000");
        return is_absent(option) ? absent : value.get<std::vector<std::size_t>>();
    }

    /// A whole number that counts for each of `levels`, or a list of one for each.
    std::vector<std::size_t> count_a_level(std::string const& option, std::size_t levels, std::size_t absent) {
        if (is_absent(option) || !(*this)[option].is_array()) {
            return std::vector<std::size_t>(levels, count(option, absent));
        }
        auto values = counts(option, {});
        require(values.size() == levels, option, "one number or " + std::to_string(levels));
        return values;
    }

    /// A whole number, or a list that says the same for each of `levels`.
    std::size_t same_count(std::string const& option, std::size_t levels, std::size_t absent) {
        auto const values = count_a_level(option, levels, absent);
        auto const is_same = [&](std::size_t value) { return value == values.front(); };
        require(std::all_of(values.begin(), values.end(), is_same), option, "the same number for each level");
        return values.front();
    }

    /// Takes an option that must have one of these values if it is there.
    void expect(std::string const& option, std::initializer_list<nlohmann::json> supported) {
        auto const& value = take(option);
        std::string expected;
        for (auto const& entry : supported) {
            expected += (expected.empty() ? "" : " or ") + entry.dump();
        }
        auto const holds = std::find(supported.begin(), supported.end(), value) != supported.end();
        require(is_absent(option) || holds, option, expected);
    }

    /// Takes options that change nothing here.
    void ignore(std::initializer_list<char const*> options) { taken_.insert(options.begin(), options.end()); }

    /// Throws file_error naming the options that nobody took.
    void require_all_taken() const {
        std::string unknown;
        std::size_t count = 0;
        for (auto const& [option, value] : options_.items()) {
            if (!taken_.contains(option) && ++count <= 5) {
                unknown += (count > 1 ? ", " : "") + option;
            }
        }
        if (count > 0) {
            throw file_error(path_ + ": " + std::to_string(count) + " options are unknown: " + unknown +
                             (count > 5 ? ", ..." : "") + ", expected none");
        }
    }

private:
    void require_object() const {
        if (!options_.is_object()) {
            throw file_error(path_ + ": file is a JSON " + options_.type_name() + ", expected an object of options");
        }
    }

    bool is_absent(std::string const& option) const { return !options_.contains(option); }

    static bool is_count(nlohmann::json const& value) {
        return value.is_number_integer() && value > 0 && value <= 1000000;
    }

    static std::string shortened(std::string const& text) {
        return text.size() <= 80 ? text : text.substr(0, 77) + "...";
    }

    nlohmann::json const& take(std::string const& option) {
        taken_.insert(option);
        return (*this)[option];
    }

    std::string path_;
    nlohmann::json options_;
    std::set<std::string> taken_;
};

} // namespace genrender::reference

#include <genrender/core/end_header.inl>
