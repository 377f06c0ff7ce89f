// SPDX-License-Identifier: MIT
// Tests of the 16-bit storage formats.
#include <genrender/core/half_precision.hpp>

#include <doctest/doctest.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

using namespace genrender;

TEST_SUITE("core/half_precision") {
    TEST_CASE("worked examples") {
        CHECK(float_of_half(0x3C00) == 1.0f);
        CHECK(float_of_half(0xC000) == -2.0f);
        CHECK(float_of_half(0x7BFF) == 65504.0f);
        CHECK(float_of_half(0x0400) == 0x1p-14f);
        CHECK(float_of_half(0x0001) == 0x1p-24f);
        CHECK(float_of_half(0x7C00) == std::numeric_limits<float>::infinity());
        CHECK(std::isnan(float_of_half(0x7E00)));
        CHECK(std::signbit(float_of_half(0x8000)));
        CHECK(float_of_bfloat16(0x3F80) == 1.0f);
        CHECK(float_of_bfloat16(0xC049) == -3.140625f);
    }

    TEST_CASE("every half survives the way through float") {
        int wrong = 0;
        for (std::uint32_t bits = 0; bits < 0x10000; ++bits) {
            auto const half = static_cast<std::uint16_t>(bits);
            auto const value = float_of_half(half);
            auto const back = half_of_float(value);
            wrong += std::isnan(value) ? !std::isnan(float_of_half(back)) : back != half;
        }
        CHECK(wrong == 0);
    }

    TEST_CASE("floats go to the nearest half and ties to even") {
        for (auto const half :
             std::array<std::uint16_t, 8>{0x0000, 0x0001, 0x0002, 0x03FF, 0x0400, 0x3C00, 0x3C01, 0x7BFE}) {
            auto const low = float_of_half(half);
            auto const high = float_of_half(static_cast<std::uint16_t>(half + 1));
            auto const middle = (low + high) / 2;
            CHECK(half_of_float(middle) == (half % 2 == 0 ? half : half + 1));
            CHECK(half_of_float(std::nextafter(middle, low)) == half);
            CHECK(half_of_float(std::nextafter(middle, high)) == half + 1);
            CHECK(half_of_float(-std::nextafter(middle, low)) == (half | 0x8000));
        }
        CHECK(half_of_float(65519.996f) == 0x7BFF);
        CHECK(half_of_float(65520.0f) == 0x7C00);
        CHECK(half_of_float(1e30f) == 0x7C00);
        CHECK(half_of_float(1e-30f) == 0);
    }

    TEST_CASE("every bfloat16 survives the way through float") {
        int wrong = 0;
        for (std::uint32_t bits = 0; bits < 0x10000; ++bits) {
            auto const value = float_of_bfloat16(static_cast<std::uint16_t>(bits));
            auto const back = bfloat16_of_float(value);
            wrong += std::isnan(value) ? !std::isnan(float_of_bfloat16(back)) : back != bits;
        }
        CHECK(wrong == 0);
    }

    TEST_CASE("floats go to the nearest bfloat16 and ties to even") {
        for (auto const bits : std::array<std::uint16_t, 6>{0x0000, 0x0001, 0x007F, 0x3F80, 0x3F81, 0x7F7E}) {
            auto const low = float_of_bfloat16(bits);
            auto const high = float_of_bfloat16(static_cast<std::uint16_t>(bits + 1));
            auto const middle = low + (high - low) / 2;
            CHECK(bfloat16_of_float(middle) == (bits % 2 == 0 ? bits : bits + 1));
            CHECK(bfloat16_of_float(std::nextafter(middle, low)) == bits);
            CHECK(bfloat16_of_float(std::nextafter(middle, high)) == bits + 1);
            CHECK(bfloat16_of_float(-std::nextafter(middle, low)) == (bits | 0x8000));
        }
        CHECK(bfloat16_of_float(std::numeric_limits<float>::max()) == 0x7F80);
        CHECK(std::isnan(float_of_bfloat16(bfloat16_of_float(std::bit_cast<float>(0x7F800001U)))));
    }
}
