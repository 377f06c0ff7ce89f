// SPDX-License-Identifier: MIT
// Between the caller's views and the tiles of attention: queries in, keys and values of all blocks in a row, results
// out.
#pragma once

#include <genrender/attention/attention_tile.hpp>
#include <genrender/attention/key_value_view.hpp>
#include <genrender/core/linalg.hpp>
#include <genrender/core/strided_view.hpp>

#include <algorithm>
#include <cstddef>
#include <memory>
#include <span>
#include <type_traits>

namespace genrender::detail {

/// Memory for `count` numbers that begins at a cache line and holds anything.
template <class Real>
class scratch_memory {
public:
    explicit scratch_memory(std::size_t count)
        : lines_(std::make_unique_for_overwrite<line[]>((count * sizeof(Real) + sizeof(line) - 1) / sizeof(line))),
          next_(reinterpret_cast<Real*>(lines_.get())) {}

    /// The next `count` of the numbers.
    Real* take(std::size_t count) {
        next_ += count;
        return next_ - count;
    }

private:
    struct alignas(64) line {
        std::byte bytes[64];
    };
    std::unique_ptr<line[]> lines_;
    Real* next_;
};

/// Columns of one head of a view [tokens, channels].
template <class T>
strided_view<T, 2> head_of(strided_view<T, 2> view, std::size_t head, std::size_t head_size) {
    return {view.data() + static_cast<std::ptrdiff_t>(head * head_size) * view.stride(1),
            {view.extent(0), head_size},
            view.strides()};
}

/// Writes rows [count, columns] of a head's view as Real, one after the other.
template <class Real, class Stored>
void read_rows(Real* to, strided_view<Stored const, 2> const& from, std::size_t first, std::size_t count) {
    auto const columns = from.extent(1);
    for (std::size_t row = 0; row < count; ++row, to += columns) {
        auto const* at = from.data() + static_cast<std::ptrdiff_t>(first + row) * from.stride(0);
        if (!from.rows_are_contiguous()) {
            for (std::size_t c = 0; c < columns; ++c) {
                to[c] = static_cast<Real>(at[static_cast<std::ptrdiff_t>(c) * from.stride(1)]);
            }
        } else if constexpr (std::is_same_v<Real, Stored>) {
            std::copy_n(at, columns, to);
        } else {
            using column = Eigen::Array<Stored, Eigen::Dynamic, 1>;
            auto const size = static_cast<Eigen::Index>(columns);
            Eigen::Map<Eigen::Array<Real, Eigen::Dynamic, 1>>(to, size) =
                Eigen::Map<column const>(at, size).template cast<Real>();
        }
    }
}

/// Keys and values of one head over all blocks as a sequence of full tiles and a last one. Where a block ends has no
/// part in where a tile ends.
template <class Real>
class key_tiles {
public:
    static std::size_t scratch(std::size_t head_size) { return tile_keys * (2 * head_size + 1); }

    key_tiles(std::span<key_value_view<Real> const> blocks, std::size_t head, std::size_t head_size,
              scratch_memory<Real>& memory)
        : blocks_(blocks), head_(head), tile_{memory.take(tile_keys * head_size), memory.take(tile_keys * head_size),
                                              memory.take(tile_keys), 0, head_size} {}

    /// Whether there was another tile; it is in tile() until the next call.
    bool next() {
        auto const d = tile_.head_size;
        std::size_t filled = 0;
        while (filled < tile_keys && block_ < blocks_.size()) {
            auto const& block = blocks_[block_];
            auto const count = std::min(tile_keys - filled, block.K.extent(0) - token_);
            auto const rows_of = [&](stored_view<Real> const& rows, Real* to) {
                rows.visit(
                    [&](auto const& view) { read_rows(to + filled * d, head_of(view, head_, d), token_, count); });
            };
            if (count > 0) {
                rows_of(block.K, tile_.K);
                rows_of(block.V, tile_.V);
                read_counts(block, filled, count);
            }
            filled += count;
            token_ += count;
            if (token_ == block.K.extent(0)) {
                ++block_;
                token_ = 0;
            }
        }
        tile_.keys = (filled + strip_rows - 1) / strip_rows * strip_rows;
        for (auto key = filled; key < tile_.keys; ++key) {
            std::copy_n(tile_.K + (filled - 1) * d, d, tile_.K + key * d);
            std::fill_n(tile_.V + key * d, d, Real{0});
            tile_.counts[key] = 0;
        }
        return filled > 0;
    }

    key_tile<Real> const& tile() const { return tile_; }

private:
    /// Equal tokens add up: their values are taken so often, and so are their weights in the sum.
    void read_counts(key_value_view<Real> const& block, std::size_t filled, std::size_t count) {
        if (block.counts.extent(0) == 0) {
            std::fill_n(tile_.counts + filled, count, Real{1});
            return;
        }
        auto const d = tile_.head_size;
        for (std::size_t key = 0; key < count; ++key) {
            auto const equal_tokens = block.counts(token_ + key);
            tile_.counts[filled + key] = equal_tokens;
            auto* const V = tile_.V + (filled + key) * d;
            std::transform(V, V + d, V, [&](Real value) { return value * equal_tokens; });
        }
    }

    std::span<key_value_view<Real> const> blocks_;
    std::size_t head_;
    std::size_t block_ = 0;
    std::size_t token_ = 0;
    key_tile<Real> tile_;
};

/// Calls body(lane, channel, square) for the squares of lane_count channels by lane_count queries of a tile, the last
/// of which may overlap the one before. Needs at least lane_count channels.
template <class Real, class Body>
void each_square(std::size_t queries, std::size_t channels, Body&& body) {
    constexpr auto n = lane_count<Real>;
    for (std::size_t q = 0; q < queries; q += n) {
        for (std::size_t c = 0; c < channels; c += n) {
            body(q, std::min(c, channels - n));
        }
    }
}

/// Puts queries [count, head_size] into the columns of an empty tile, times `scale`; columns left over are 0.
template <class Real, std::size_t Registers>
void read_queries(query_tile<Real, Registers> const& tile, strided_view<Real const, 2> const& Q, Real scale) {
    constexpr auto queries = query_tile<Real, Registers>::queries;
    constexpr auto n = lane_count<Real>;
    auto const count = Q.extent(0);
    auto const channels = Q.extent(1);
    if (channels >= n && Q.rows_are_contiguous()) {
        each_square<Real>(queries, channels, [&](std::size_t q, std::size_t c) {
            lanes<Real> square[n];
            unrolled<n>([&](auto i) GENRENDER_ALWAYS_INLINE {
                square[i] = q + i < count ? load(&Q(q + i, c)) * scale : lanes<Real>{};
            });
            transpose<Real>(square);
            unrolled<n>([&](auto i) GENRENDER_ALWAYS_INLINE { store(tile.Q + (c + i) * queries + q, square[i]); });
        });
    } else {
        for (std::size_t c = 0; c < channels; ++c) {
            for (std::size_t q = 0; q < queries; ++q) {
                tile.Q[c * queries + q] = q < count ? Q(q, c) * scale : Real{0};
            }
        }
    }
    std::fill_n(tile.F, channels * queries, Real{0});
    std::fill_n(tile.shift, queries, Real{0});
    std::fill_n(tile.sum, queries, Real{0});
}

/// Writes F [count, head_size]: the sums of a tile over the sums of weights.
template <class Real, std::size_t Registers>
void write_results(strided_view<Real, 2> const& F, query_tile<Real, Registers> const& tile) {
    constexpr auto queries = query_tile<Real, Registers>::queries;
    constexpr auto n = lane_count<Real>;
    auto const count = F.extent(0);
    auto const channels = F.extent(1);
    if (channels >= n && F.rows_are_contiguous()) {
        each_square<Real>(std::min(count, queries), channels, [&](std::size_t q, std::size_t c) {
            auto const share = Real{1} / load(tile.sum + q);
            lanes<Real> square[n];
            unrolled<n>([&](auto i)
                            GENRENDER_ALWAYS_INLINE { square[i] = load(tile.F + (c + i) * queries + q) * share; });
            transpose<Real>(square);
            unrolled<n>([&](auto i) GENRENDER_ALWAYS_INLINE {
                if (q + i < count) {
                    store(&F(q + i, c), square[i]);
                }
            });
        });
    } else {
        for (std::size_t q = 0; q < count; ++q) {
            auto const share = Real{1} / tile.sum[q];
            for (std::size_t c = 0; c < channels; ++c) {
                F(q, c) = tile.F[c * queries + q] * share;
            }
        }
    }
}

} // namespace genrender::detail
