// SPDX-License-Identifier: MIT
// Stacks filled with N(0, 1), the same for the same seed.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/random.hpp>
#include <genrender/core/stack.hpp>

#include <array>
#include <cstddef>
#include <cstdint>

namespace genrender::testing {

/// A stack of numbers of N(0, 1), the same for the same extents and seed on every machine.
template <class Real, std::size_t Rank>
stack<Real, Rank> random_stack(std::array<std::size_t, Rank> const& extents, std::uint64_t seed) {
    stack<Real, Rank> values(extents);
    for (std::size_t i = 0; i < values.size(); ++i) {
        values.data()[i] =
            static_cast<Real>(normal_value(seed, random_stream::test, {static_cast<std::uint32_t>(i), 0, 0}));
    }
    return values;
}

} // namespace genrender::testing

#include <genrender/core/end_header.inl>
