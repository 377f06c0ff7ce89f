// SPDX-License-Identifier: MIT
// A test at each vector target of this processor in turn.
#pragma once

#include <genrender/core/vector_target.hpp>

#include <doctest/doctest.h>

#include <optional>

namespace genrender::testing {

/// Calls `body()` with each of available_vector_targets() forced, and forces none in the end.
template <class Body>
void at_each_vector_target(Body&& body) {
    struct restore {
        ~restore() { force_vector_target(std::nullopt); }
    } const restored;
    for (auto const target : available_vector_targets()) {
        force_vector_target(target);
        CAPTURE(name_of(target));
        body();
    }
}

} // namespace genrender::testing
