// SPDX-License-Identifier: MIT
// Registers hold whole elements, and loading them changes no bit.
#include <genrender/core/register_vector.hpp>

#include <doctest/doctest.h>

#include <array>
#include <cstdint>

using namespace genrender;

TEST_SUITE("core/register_vector") {
    TEST_CASE("a register holds twice as many floats as doubles") {
        CHECK(detail::register_lanes<float> >= 1);
        if (detail::register_bytes > 0) {
            CHECK(detail::register_lanes<float> == 2 * detail::register_lanes<double>);
            CHECK(detail::register_lanes<double> * sizeof(double) == detail::register_bytes);
        }
    }

#if defined(__GNUC__)
    TEST_CASE("all elements are folded into one") {
        auto const lanes = detail::lane_numbers();
        auto const last = static_cast<std::int32_t>(detail::register_lanes<std::int32_t>) - 1;
        CHECK(lanes[0] == 0);
        CHECK(lanes[static_cast<std::size_t>(last)] == last);
        CHECK(detail::folded(lanes, [](auto a, auto b) { return a + b; }) == last * (last + 1) / 2);
        CHECK(detail::folded(lanes, [](auto a, auto b) { return a > b ? a : b; }) == last);
    }
#endif

    TEST_CASE("elements are loaded from any address and bits stay what they are") {
        std::array<std::uint8_t, 9> const bytes{0, 1, 2, 3, 4, 5, 6, 7, 8};
        auto const number = detail::load_as<std::uint64_t>(bytes.data() + 1);
        auto const back = detail::bits_as<std::array<std::uint8_t, 8>>(number);
        CHECK(back == std::array<std::uint8_t, 8>{1, 2, 3, 4, 5, 6, 7, 8});
        CHECK(detail::bits_as<std::uint32_t>(1.0F) == 0x3F800000U);
    }
}
