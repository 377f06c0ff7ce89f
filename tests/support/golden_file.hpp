// SPDX-License-Identifier: MIT
// The files of tests/data: what other projects computed, to the last digit.
#pragma once

#include <nlohmann/json.hpp>

#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

namespace genrender::testing {

/// The content of tests/data/`name`. Throws std::runtime_error if it cannot be read, nlohmann's exceptions if it is no
/// JSON.
inline nlohmann::json golden_file(std::string const& name) {
    std::filesystem::path const path = std::filesystem::path(GENRENDER_TEST_DATA) / name;
    std::ifstream file(path);
    if (!file) {
        throw std::runtime_error(path.string() + ": cannot be read");
    }
    return nlohmann::json::parse(file);
}

} // namespace genrender::testing
