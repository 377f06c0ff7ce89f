// SPDX-License-Identifier: MIT
// Counter-based random numbers: any value of any stream by its address, in any order, on any thread (Salmon et al., SC
// 2011).
#pragma once

#include <genrender/core/begin_header.inl>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>

namespace genrender {

/// Which sequence of random numbers: values of different streams are independent for the same seed and address.
enum class random_stream : std::uint32_t {
    texture_noise = 1, ///< of texels
    background_noise,  ///< one image for all frames
    frame_noise,       ///< another image for each frame
    keyframes,         ///< which frames are drawn
    weights,           ///< of seeded networks
    test,              ///< for tests
    user,              ///< for programs, which the library never draws from
    surface_noise,     ///< of the cells of surfaces
    environment_noise, ///< of the cells of directions
    consensus_sources  ///< which frames a consensus is the mean of
};

/// 128 random bits for a 128-bit counter and a 64-bit key: Philox4x32-10 (Salmon et al., 'Parallel Random Numbers: As
/// Easy as 1, 2, 3', SC 2011, sec. 4.3), whose published test vectors the tests hold.
constexpr std::array<std::uint32_t, 4> philox(std::array<std::uint32_t, 4> counter, std::array<std::uint32_t, 2> key) {
    // In numbers of their own: an element of an array is a call where nothing is optimised.
    auto [c_0, c_1, c_2, c_3] = counter;
    auto [key_0, key_1] = key;
    for (int round = 0; round < 10; ++round) {
        auto const product_0 = std::uint64_t{0xD2511F53U} * c_0;
        auto const product_1 = std::uint64_t{0xCD9E8D57U} * c_2;
        c_0 = static_cast<std::uint32_t>(product_1 >> 32) ^ c_1 ^ key_0;
        c_1 = static_cast<std::uint32_t>(product_1);
        c_2 = static_cast<std::uint32_t>(product_0 >> 32) ^ c_3 ^ key_1;
        c_3 = static_cast<std::uint32_t>(product_0);
        key_0 += 0x9E3779B9U;
        key_1 += 0xBB67AE85U;
    }
    return {c_0, c_1, c_2, c_3};
}

/// The address of one random value: three coordinates of the caller's choosing within a stream (object, texel, channel;
/// step, draw; ...).
using random_address = std::array<std::uint32_t, 3>;

/// Random bits at an address; the same for the same seed, stream and address, on every machine.
constexpr std::array<std::uint32_t, 4> random_bits(std::uint64_t seed, random_stream stream, random_address address) {
    return philox({address[0], address[1], address[2], static_cast<std::uint32_t>(stream)},
                  {static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32)});
}

/// A value uniform in [0, 1).
constexpr double uniform_value(std::uint64_t seed, random_stream stream, random_address address) {
    auto const bits = random_bits(seed, stream, address);
    return static_cast<double>((std::uint64_t{bits[0]} << 21) ^ (bits[1] >> 11)) * 0x1p-53;
}

/// A whole number uniform in [0, bound), bound > 0, with a bias below bound / 2^64.
constexpr std::uint32_t uniform_below(std::uint32_t bound, std::uint64_t seed, random_stream stream,
                                      random_address address) {
    auto const bits = random_bits(seed, stream, address);
    // Multiply a 64-bit fraction by the bound and keep the whole part, in two 32-bit halves.
    auto const low = (std::uint64_t{bits[1]} * bound) >> 32;
    return static_cast<std::uint32_t>((std::uint64_t{bits[0]} * bound + low) >> 32);
}

/// The value of N(0, 1) that 128 random bits name, by the Box-Muller transform in double precision; never infinite (at
/// most 8.66 in magnitude).
inline double normal_of(std::array<std::uint32_t, 4> const& bits) {
    auto const u = (static_cast<double>((std::uint64_t{bits[0]} << 21) ^ (bits[1] >> 11)) + 0.5) * 0x1p-53;
    auto const turn = (static_cast<double>(bits[2]) + 0.5) * 0x1p-32;
    return std::sqrt(-2 * std::log(u)) * std::cos(2 * std::numbers::pi * turn);
}

/// Four independent values of N(0, 1) that 128 random bits name, 32 a value; at most 6.7 in magnitude.
inline std::array<double, 4> four_normals_of(std::array<std::uint32_t, 4> const& bits) {
    std::array<double, 4> values{};
    for (std::size_t pair = 0; pair < 2; ++pair) {
        auto const radius = std::sqrt(-2 * std::log((static_cast<double>(bits[2 * pair]) + 0.5) * 0x1p-32));
        auto const angle = 2 * std::numbers::pi * (static_cast<double>(bits[2 * pair + 1]) + 0.5) * 0x1p-32;
        values[2 * pair] = radius * std::cos(angle);
        values[2 * pair + 1] = radius * std::sin(angle);
    }
    return values;
}

/// A value of N(0, 1) at an address.
inline double normal_value(std::uint64_t seed, random_stream stream, random_address address) {
    return normal_of(random_bits(seed, stream, address));
}

} // namespace genrender

#include <genrender/core/end_header.inl>
