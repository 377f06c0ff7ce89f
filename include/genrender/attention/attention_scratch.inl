// SPDX-License-Identifier: MIT
// What goes into tiles of attention and what comes out of them, with the vectors of one target.

namespace genrender::detail::GENRENDER_TARGET {

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
            std::size_t c = 0;
            for (; c + lane_count<Real> <= columns; c += lane_count<Real>) {
                store(to + c, load_widened<Real>(at + c));
            }
            for (; c < columns; ++c) {
                to[c] = static_cast<Real>(at[c]);
            }
        }
    }
}

/// Keys and values of one head over all blocks as a sequence of full tiles and a last one. Where a block ends has no
/// part in where a tile ends.
template <class Real>
class key_tiles {
public:
    /// Numbers of room for copies of a tile.
    static std::size_t scratch(std::size_t head_size) { return 2 * tile_keys * head_size; }

    /// With `in_place`, rows of neighbouring numbers of type Real are read where they lie; else all are copied, which
    /// is worth it when they are read several times: copies lie close together.
    key_tiles(std::span<key_value_view<Real> const> blocks, std::size_t head, std::size_t head_size, Real* copies,
              bool in_place)
        : blocks_(blocks), head_(head), in_place_(in_place), K_(copies), V_(copies + tile_keys * head_size) {
        tile_.head_size = head_size;
        tile_.is_far = in_place;
        skip_empty();
    }

    /// Whether there was another tile; it is in tile() until the next call.
    bool next() {
        tile_.keys = 0;
        while (tile_.keys < tile_keys && !is_last()) {
            auto const& block = blocks_[block_];
            auto const count = std::min(tile_keys - tile_.keys, block.K.extent(0) - token_);
            auto const has_counts = block.counts.extent(0) > 0;
            take_rows(tile_.K, K_, block.K, count, in_place_);
            take_rows(tile_.V, V_, block.V, count, in_place_ && !has_counts);
            take_counts(block, count);
            tile_.keys += count;
            token_ += count;
            skip_empty();
        }
        if (tile_.keys == 0) {
            return false;
        }
        tile_.repeat_last();
        return true;
    }

    key_tile<Real> const& tile() const { return tile_; }

    /// Whether no keys come after those of tile().
    bool is_last() const { return block_ == blocks_.size(); }

private:
    void skip_empty() {
        while (!is_last() && token_ == blocks_[block_].K.extent(0)) {
            ++block_;
            token_ = 0;
        }
    }

    /// Points the next `count` of `rows` to where their numbers are, `scratch` or not.
    template <class Rows>
    void take_rows(Rows& rows, Real* scratch, stored_view<Real> const& stored, std::size_t count, bool in_place) {
        auto const d = tile_.head_size;
        auto const point_to = [&](Real const* first, std::ptrdiff_t stride) {
            for (std::size_t key = 0; key < count; ++key) {
                rows[tile_.keys + key] = first + static_cast<std::ptrdiff_t>(key) * stride;
            }
        };
        stored.visit([&]<class Stored>(strided_view<Stored const, 2> const& all) {
            auto const view = head_of(all, head_, d).slice(token_, count);
            if constexpr (std::is_same_v<Stored, Real>) {
                if (in_place && view.rows_are_contiguous()) {
                    point_to(view.data(), view.stride(0));
                    return;
                }
            }
            auto* const copies = scratch + tile_.keys * d;
            read_rows(copies, view, 0, count);
            point_to(copies, static_cast<std::ptrdiff_t>(d));
        });
    }

    /// Equal tokens add up: their values are taken so often, and so are their weights in the sum.
    void take_counts(key_value_view<Real> const& block, std::size_t count) {
        auto* const counts = tile_.counts.data() + tile_.keys;
        if (block.counts.extent(0) == 0) {
            std::fill_n(counts, count, Real{1});
            return;
        }
        auto const d = tile_.head_size;
        for (std::size_t key = 0; key < count; ++key) {
            auto const equal_tokens = block.counts(token_ + key);
            counts[key] = equal_tokens;
            auto* const V = V_ + (tile_.keys + key) * d;
            std::transform(V, V + d, V, [&](Real value) { return value * equal_tokens; });
        }
    }

    std::span<key_value_view<Real> const> blocks_;
    std::size_t head_;
    bool in_place_;
    Real* K_; ///< [tile_keys, head_size] copies
    Real* V_; ///< [tile_keys, head_size] copies
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

/// Calls body(i, row) for rows begin + i of a view, i < N, that it has.
template <std::size_t N, class T, class Body>
GENRENDER_ALWAYS_INLINE inline void for_each_row(strided_view<T, 2> const& view, std::size_t begin, Body&& body) {
    auto const stride = view.stride(0);
    auto const first = std::min(begin, view.extent(0));
    auto const count = view.extent(0) - first;
    if (count == 0) {
        return;
    }
    auto* const rows = view.data() + static_cast<std::ptrdiff_t>(first) * stride;
    auto const visit = [&](auto i)
                           GENRENDER_ALWAYS_INLINE { body(i, rows + static_cast<std::ptrdiff_t>(i()) * stride); };
    // Nearly always there are all of them, and then nothing stands between one and the next.
    if (count >= N) {
        unrolled<N>(visit);
    } else {
        unrolled<N>([&](auto i) GENRENDER_ALWAYS_INLINE {
            if (i < count) {
                visit(i);
            }
        });
    }
}

/// Puts queries [count, head_size] into the columns of a tile, times `scale`, and empties it but for F; columns left
/// over are 0.
template <class Real, std::size_t Registers>
void read_queries(query_tile<Real, Registers> const& tile, strided_view<Real const, 2> const& Q, Real scale) {
    constexpr auto queries = query_tile<Real, Registers>::queries;
    constexpr auto n = lane_count<Real>;
    auto const count = Q.extent(0);
    auto const channels = Q.extent(1);
    if (channels >= n && Q.rows_are_contiguous()) {
        each_square<Real>(queries, channels, [&](std::size_t q, std::size_t c) {
            lanes<Real> square[n]{};
            for_each_row<n>(
                Q, q, [&](auto i, Real const* row) GENRENDER_ALWAYS_INLINE { square[i] = load(row + c) * scale; });
            transpose<Real>(square);
            auto* const to = tile.Q + c * queries + q;
            unrolled<n>([&](auto i) GENRENDER_ALWAYS_INLINE { store(to + i * queries, square[i]); });
        });
    } else {
        for (std::size_t c = 0; c < channels; ++c) {
            for (std::size_t q = 0; q < queries; ++q) {
                tile.Q[c * queries + q] = q < count ? Q(q, c) * scale : Real{0};
            }
        }
    }
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
            auto const* const from = tile.F + c * queries + q;
            unrolled<n>([&](auto i) GENRENDER_ALWAYS_INLINE { square[i] = load(from + i * queries) * share; });
            transpose<Real>(square);
            for_each_row<n>(F, q, [&](auto i, Real* row) GENRENDER_ALWAYS_INLINE { store(row + c, square[i]); });
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

} // namespace genrender::detail::GENRENDER_TARGET
