// SPDX-License-Identifier: MIT
// The names of the laws that a report says are broken.
#pragma once

#include <genrender/testing/law_report.hpp>

#include <string>
#include <vector>

namespace genrender::testing {

/// What stands before `: found` in each sentence.
inline std::vector<std::string> broken_laws(law_report const& report) {
    std::vector<std::string> laws;
    for (auto const& violation : report.violations) {
        laws.push_back(violation.substr(0, violation.find(": found ")));
    }
    return laws;
}

} // namespace genrender::testing
