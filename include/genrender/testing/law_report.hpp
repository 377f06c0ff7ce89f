// SPDX-License-Identifier: MIT
// What a check of a concept's laws found, for any test framework or none.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/error.hpp>
#include <genrender/core/stack.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <string>
#include <vector>

namespace genrender::testing {

/// The laws that a model breaks, all of them at once, a sentence each: `concept: law: found ..., expected ...`. Of a
/// law that is broken in many places, the first place. Empty when all laws that were checked hold.
struct law_report {
    std::vector<std::string> violations; ///< a sentence for each law that is broken

    /// Whether every law that was checked holds.
    bool empty() const { return violations.empty(); }

    /// The sentences, a line each; empty when all laws hold.
    std::string text() const {
        std::string lines;
        for (auto const& violation : violations) {
            lines += violation + "\n";
        }
        return lines;
    }

    /// Notes that a law, named as `concept: law`, is broken; does nothing if that is known already.
    void add(std::string const& law, std::string const& found, std::string const& expected) {
        auto const beginning = law + ": found ";
        auto const is_known = std::any_of(violations.begin(), violations.end(), [&](std::string const& violation) {
            return violation.compare(0, beginning.size(), beginning) == 0;
        });
        if (!is_known) {
            violations.push_back(beginning + found + ", expected " + expected);
        }
    }

    /// Notes the same unless `holds`.
    void require(bool holds, std::string const& law, std::string const& found, std::string const& expected) {
        if (!holds) {
            add(law, found, expected);
        }
    }
};

namespace detail {

/// A number with as many digits as tell two floats apart.
inline std::string number_text(double value) {
    char text[32];
    std::snprintf(text, sizeof(text), "%.9g", value);
    return text;
}

/// Whether two numbers differ by no more than rounding, relative to the greater of their size and 1; for a tolerance of
/// 0, whether they are equal.
inline bool are_close(double a, double b, double tolerance) {
    return a == b || std::abs(a - b) < tolerance * (1 + std::max(std::abs(a), std::abs(b)));
}

/// The address of an element of row-major extents as text: `[0, 2, 1]`.
template <std::size_t Rank>
std::string address_text(std::array<std::size_t, Rank> const& extents, std::size_t element) {
    std::array<std::size_t, Rank> address{};
    for (std::size_t axis = Rank; axis-- > 0;) {
        address[axis] = element % extents[axis];
        element /= extents[axis];
    }
    return extents_text(address);
}

/// Notes the first element in which `found`, called `name` in the sentence, differs from `expected` by more than
/// rounding. Both are of the same extents.
template <class Real, std::size_t Rank>
void require_same(law_report& report, std::string const& law, std::string const& name, stack<Real, Rank> const& found,
                  stack<Real, Rank> const& expected, double tolerance = 0) {
    for (std::size_t e = 0; e < expected.size(); ++e) {
        auto const a = static_cast<double>(found.data()[e]);
        auto const b = static_cast<double>(expected.data()[e]);
        if (!are_close(a, b, tolerance)) {
            report.add(law, name + address_text(expected.extents(), e) + " = " + number_text(a),
                       number_text(b) + (tolerance > 0 ? " up to rounding" : ""));
            return;
        }
    }
}

} // namespace detail

} // namespace genrender::testing

#include <genrender/core/end_header.inl>
