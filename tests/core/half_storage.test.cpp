// SPDX-License-Identifier: MIT
// Numbers of 16 bits are read as what they are, whosever type they have.
#include <genrender/core/half_storage.hpp>

#include <genrender/core/linalg.hpp>
#include <genrender/core/stack.hpp>

#include <doctest/doctest.h>

#include <cstdint>
#include <utility>

using namespace genrender;

namespace engine {

/// A type of 16 bits that the library has never heard of.
struct half {
    unsigned short x = 0;
};

} // namespace engine

template <>
struct genrender::half_bits<engine::half> {
    using type = float16_bits;
};

TEST_SUITE("core/half_storage") {
    TEST_CASE("storage of 16 bits is one of two formats") {
        CHECK(half_storage<float16>);
        CHECK(half_storage<bfloat16>);
        CHECK(half_storage<float16 const>);
        CHECK(half_storage<float16_bits>);
        CHECK(half_storage<bfloat16_bits>);
        CHECK(half_storage<engine::half>);
        CHECK_FALSE(half_storage<float>);
        CHECK_FALSE(half_storage<std::uint16_t>);
    }

    TEST_CASE("bits stand for the number that they are") {
        CHECK(static_cast<float>(float16_bits{0x3C00}) == 1);
        CHECK(static_cast<double>(float16_bits{0xC000}) == -2);
        CHECK(static_cast<float>(bfloat16_bits{0x3F80}) == 1);
        CHECK(static_cast<double>(bfloat16_bits{0xC049}) == -3.140625);
    }

    TEST_CASE("a view of an engine's numbers is one of bits at the same place") {
        stack<engine::half, 2> numbers({2, 3});
        numbers(1, 2).x = 0x4200;
        auto const bits = to_bits_view(std::as_const(numbers).view());
        CHECK(bits.extents() == numbers.extents());
        CHECK(static_cast<void const*>(bits.data()) == numbers.data());
        CHECK(static_cast<float>(bits(1, 2)) == 3);
        auto const turned = to_bits_view(strided_view<engine::half const, 2>(numbers.data(), {3, 2}, {1, 3}));
        CHECK(static_cast<float>(turned(2, 1)) == 3);
    }
}
