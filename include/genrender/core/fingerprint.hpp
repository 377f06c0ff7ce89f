// SPDX-License-Identifier: MIT
// A number of 64 bits that stands for much data: equal data have equal ones, others almost never.
#pragma once

#include <genrender/core/begin_header.inl>

#include <array>
#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <string_view>
#include <type_traits>

namespace genrender {

/// Takes in data piece by piece. The same pieces in the same order give the same value, on every machine; data that
/// differ in one word always give different ones, others do but for about one in 2^64. It tells what was changed by
/// accident, and is no signature: who wants to can make data of any value.
class fingerprint {
    // Stands first because compilers compute with what they have read.
    /// One to one, and every bit of x changes about half of those of the result.
    static constexpr std::uint64_t mixed(std::uint64_t x) {
        x ^= x >> 32;
        x *= 0xD6E8FEB86659FD93U;
        x ^= x >> 32;
        x *= 0xD6E8FEB86659FD93U;
        return x ^ x >> 32;
    }

    /// The 64 bits of up to eight bytes, lowest first.
    template <class Byte>
    static constexpr std::uint64_t word_of(Byte const* bytes, std::size_t count) {
        std::uint64_t word = 0;
        if (!std::is_constant_evaluated() && count == 8 && std::endian::native == std::endian::little) {
            std::memcpy(&word, bytes, 8);
            return word;
        }
        for (std::size_t i = 0; i < count; ++i) {
            word |= std::uint64_t{static_cast<std::uint8_t>(bytes[i])} << (8 * i);
        }
        return word;
    }

    /// Four words at a time, each lane for itself, so that a processor mixes them side by side.
    template <class Byte>
    constexpr void add_all(Byte const* bytes, std::size_t count) {
        std::size_t begin = 0;
        if (count >= 32) {
            std::array<std::uint64_t, 4> lanes{state_, state_ + 1, state_ + 2, state_ + 3};
            for (; begin + 32 <= count; begin += 32) {
                for (std::size_t lane = 0; lane < 4; ++lane) {
                    lanes[lane] = mixed(lanes[lane] ^ word_of(bytes + begin + 8 * lane, 8));
                }
            }
            for (auto const lane : lanes) {
                add(lane);
            }
        }
        for (; begin + 8 <= count; begin += 8) {
            add(word_of(bytes + begin, 8));
        }
        if (begin < count) {
            add(word_of(bytes + begin, count - begin));
        }
    }

public:
    /// Takes in 64 bits.
    constexpr void add(std::uint64_t word) { state_ = mixed(state_ ^ word); }
    /// Takes in any other whole number, a bool or an enumerator.
    template <class T>
        requires((std::integral<T> || std::is_enum_v<T>)&&!std::same_as<T, std::uint64_t>)
    constexpr void add(T value) { add(static_cast<std::uint64_t>(value)); }
    /// Takes in the bits of a number: 0 and -0 differ.
    constexpr void add(float value) { add(std::uint64_t{std::bit_cast<std::uint32_t>(value)}); }
    /// The same.
    constexpr void add(double value) { add(std::bit_cast<std::uint64_t>(value)); }
    /// Takes in whether there is a value, and which.
    template <class T>
    constexpr void add(std::optional<T> const& value) {
        add(value.has_value());
        if (value) {
            add(*value);
        }
    }
    /// Takes in how many bytes there are, and all of them.
    constexpr void add(std::string_view text) {
        add(text.size());
        add_all(text.data(), text.size());
    }
    /// The same.
    constexpr void add(std::span<std::uint8_t const> bytes) {
        add(bytes.size());
        add_all(bytes.data(), bytes.size());
    }

    /// Of all that was taken in so far.
    constexpr std::uint64_t value() const { return state_; }

private:
    std::uint64_t state_ = 0x67656E72656E6465U;
};

} // namespace genrender

#include <genrender/core/end_header.inl>
