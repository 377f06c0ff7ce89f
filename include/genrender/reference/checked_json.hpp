// SPDX-License-Identifier: MIT
// JSON texts in which no key of an object occurs twice.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/error.hpp>

#include <nlohmann/json.hpp>

#include <set>
#include <string>
#include <vector>

namespace genrender::reference {

/// The value of a JSON text, `what` of the file `path`. JSON itself lets the last of equal keys win; here they are an
/// error, because readers differ. Throws file_error `path: what ...` for them and for a text that is not JSON.
inline nlohmann::json checked_json(std::string const& text, std::string const& path, std::string const& what,
                                   std::string const& expected) {
    std::vector<std::set<std::string>> keys;
    auto const watch = [&](int, nlohmann::json::parse_event_t event, nlohmann::json& parsed) {
        if (event == nlohmann::json::parse_event_t::object_start) {
            keys.emplace_back();
        } else if (event == nlohmann::json::parse_event_t::object_end) {
            keys.pop_back();
        } else if (event == nlohmann::json::parse_event_t::key) {
            auto const& key = parsed.get_ref<std::string const&>();
            if (!keys.back().insert(key).second) {
                throw file_error(path + ": " + what + " has the key " + key + " twice, expected each key once");
            }
        }
        return true;
    };
    try {
        return nlohmann::json::parse(text, watch);
    } catch (nlohmann::json::exception const& error) {
        throw file_error(path + ": " + what + " is not JSON (" + error.what() + "), expected " + expected);
    }
}

} // namespace genrender::reference

#include <genrender/core/end_header.inl>
