// SPDX-License-Identifier: MIT
// [GR sec. 3.3] z_UV ~ N(0, I): Gaussian noise that lives on the objects' textures, computed where it is looked at.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/index.hpp>
#include <genrender/core/random.hpp>

#include <cstdint>

namespace genrender {

/// Noise of every texel of every object's texture, for any number of channels. Nothing is stored: a value is a function
/// of its address, so any frame can be made in any order.
struct noise_texture {
    std::uint64_t seed = 0; ///< textures of different seeds are independent

    /// The value of N(0, 1) at a texel and channel, for rows and columns below 2^20 and channels below 2^24.
    double operator()(texel const& t, std::uint32_t channel) const {
        // Rows and columns stay below 2^20 and channels below 2^24: the object's 32 bits fill the rest of the address.
        auto const object = t.object.value;
        return normal_value(seed, random_stream::texture_noise,
                            {t.row | object << 20, t.column | (object >> 12) << 20, channel | (object >> 24) << 24});
    }
};

} // namespace genrender

#include <genrender/core/end_header.inl>
