// SPDX-License-Identifier: MIT
// Every number of 16 bits widens to what Eigen says it is.
#include <genrender/blending/channel_lanes.hpp>

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <utility>

using namespace genrender;

namespace {

/// How many of all 65536 numbers do not come out as they should.
template <class Real, class Stored>
std::size_t differences() {
    using lanes = detail::channel_lanes<Real>;
    std::size_t differing = 0;
    for (std::uint32_t first = 0; first < 65536; first += static_cast<std::uint32_t>(lanes::count)) {
        std::array<Stored, lanes::count> stored;
        for (std::size_t n = 0; n < lanes::count; ++n) {
            auto const bits = static_cast<std::uint16_t>(first + n);
            std::memcpy(static_cast<void*>(&stored[n]), &bits, sizeof(bits));
        }
        std::array<Real, lanes::count> wide;
        lanes::store(wide.data(), lanes::load(stored.data()));
        for (std::size_t n = 0; n < lanes::count; ++n) {
            auto const expected = static_cast<Real>(static_cast<float>(stored[n]));
            auto const is_same = std::isnan(expected)
                                     ? std::isnan(wide[n])
                                     : wide[n] == expected && std::signbit(wide[n]) == std::signbit(expected);
            differing += is_same ? 0U : 1U;
        }
    }
    return differing;
}

} // namespace

TEST_SUITE("blending/channel_lanes") {
    TEST_CASE_TEMPLATE("all numbers of 16 bits are exact in float and double", Real, float, double) {
        CHECK(differences<Real, float16>() == 0);
        CHECK(differences<Real, bfloat16>() == 0);
    }

    TEST_CASE("storage of 16 bits is one of two formats") {
        CHECK(half_storage<float16>);
        CHECK(half_storage<bfloat16>);
        CHECK_FALSE(half_storage<float>);
        CHECK_FALSE(half_storage<std::uint16_t>);
    }
}
