// SPDX-License-Identifier: MIT
// [GR sec. 3] Which parts of a texture are used in several of its repetitions.
#pragma once

#include <genrender/core/begin_header.inl>

#include <algorithm>
#include <array>
#include <cmath>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <map>
#include <utility>

namespace genrender {

/// Counts texture coordinates by their place on the texture, on a board of 32 x 32 squares, and by the repetition, or
/// tile, that they lie in. Where a square is used in two tiles, distinct surface points become one once the texture
/// repeats.
class texture_tiles {
public:
    texture_tiles() = default;
    texture_tiles(texture_tiles const&) = delete; // remembers a place within itself
    texture_tiles& operator=(texture_tiles const&) = delete;

    /// Finite coordinates of one pixel.
    void add(std::array<float, 2> const& uv) {
        key k{};
        for (std::size_t d = 0; d < 2; ++d) {
            // The right border of the texture is its own, not the beginning of the next tile.
            auto const tile = uv[d] == 1 ? 0.0 : std::floor(double{uv[d]});
            auto const square = std::floor((double{uv[d]} - tile) * squares);
            k.square = k.square * squares + static_cast<std::int32_t>(std::min(square, squares - 1.0));
            // Further tiles than floats can tell apart are one.
            k.tile[d] = static_cast<std::int32_t>(std::clamp(tile, -1e6, 1e6));
        }
        // Neighbouring pixels mostly fall into one square.
        if (last_ == nullptr || last_->first != k) {
            last_ = &*pixels_.try_emplace(k, 0).first;
        }
        ++last_->second;
    }

    /// Adds all that `other` counted.
    void add(texture_tiles const& other) {
        for (auto const& [k, count] : other.pixels_) {
            pixels_[k] += count;
        }
    }

    /// Pixels in squares that another tile uses too.
    std::size_t repeated() const {
        std::size_t count = 0;
        for (auto first = pixels_.begin(); first != pixels_.end();) {
            auto const end = std::find_if(first, pixels_.end(),
                                          [&](auto const& e) { return e.first.square != first->first.square; });
            auto const is_repeated = std::next(first) != end;
            for (; first != end; ++first) {
                count += is_repeated ? first->second : 0;
            }
        }
        return count;
    }

private:
    static constexpr std::int32_t squares = 32;

    struct key {
        std::int32_t square = 0;
        std::array<std::int32_t, 2> tile{};
        friend auto operator<=>(key const&, key const&) = default;
    };

    std::map<key, std::size_t> pixels_;
    std::pair<key const, std::size_t>* last_ = nullptr;
};

} // namespace genrender

#include <genrender/core/end_header.inl>
