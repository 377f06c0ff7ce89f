// SPDX-License-Identifier: MIT
// [GR eq. 1] Softmax attention of a tile of queries over a tile of keys, with the vectors of one target.
//
// With Q^T, P^T and F^T, the maximum, the sum and the rescaling of a query's softmax are those of a lane: nothing is
// ever reduced across a register. Both products multiply registers of Q^T and P^T by single numbers of K and V, so
// neither K nor V is transposed. What a query gets depends on its keys alone, neither on its lane nor on its
// neighbours.

namespace genrender::detail::GENRENDER_TARGET {
/// Registers a row of queries in a full tile: with strip_rows rows of sums, they fill the register file.
inline constexpr std::size_t tile_registers = many_vector_registers ? 4 : 2;

/// A tile of queries of one head, a column each, and its online softmax so far; before the first tile of keys, F holds
/// anything.
template <class Real, std::size_t Registers>
struct query_tile {
    static constexpr std::size_t queries = Registers * lane_count<Real>;
    Real* Q;     ///< [head_size, queries], times the scale of the logits
    Real* F;     ///< [head_size, queries], sums of weight times value
    Real* shift; ///< [queries], less what is subtracted from the logits
    Real* sum;   ///< [queries], sums of weights

    static constexpr std::size_t size(std::size_t head_size) { return (2 * head_size + 2) * queries; }
    query_tile(Real* memory, std::size_t head_size)
        : Q(memory), F(Q + head_size * queries), shift(F + head_size * queries), sum(shift + queries) {}
};

/// Subtracts more from the logits of those queries that have outgrown their headroom (all of them when `fresh`, before
/// which there is nothing to rescale): from `strip`, and from all there is: the rows of weights before the strip, their
/// sums `part`, and the tile, of which F has `channels` so far.
template <class Real, std::size_t Registers>
[[gnu::noinline]] void shift_logits(query_tile<Real, Registers> const& tile, std::size_t channels, Real* weights,
                                    Real* strip, Real* part, bool fresh) {
    constexpr auto queries = query_tile<Real, Registers>::queries;
    for (std::size_t q = 0; q < queries; q += lane_count<Real>) {
        auto greatest = load(strip + q);
        for (std::size_t row = 1; row < strip_rows; ++row) {
            greatest = greater<Real>(greatest, load(strip + row * queries + q));
        }
        lanes<Real> const none{};
        auto const step = fresh ? greatest : (greatest > spread(Real{headroom}) ? greatest : none);
        for (std::size_t row = 0; row < strip_rows; ++row) {
            store(strip + row * queries + q, load(strip + row * queries + q) - step);
        }
        store(tile.shift + q, load(tile.shift + q) - step);
        if (fresh) {
            continue;
        }
        // A query that keeps its maximum keeps its sums, to the last bit.
        auto const factor = step > none ? exponential_2<Real>(-step) : spread(Real{1});
        auto const rescale = [&](Real* at) { store(at + q, load(at + q) * factor); };
        for (auto* row = weights; row != strip; row += queries) {
            rescale(row);
        }
        for (std::size_t c = 0; c < channels; ++c) {
            rescale(tile.F + c * queries);
        }
        rescale(part);
        rescale(tile.sum);
    }
}

/// Writes the weights [strip_rows, queries] of the keys from `key` on and adds them to `part`. `fresh` is whether there
/// was no tile of keys before.
template <class Real, std::size_t Registers>
void weigh_strip(query_tile<Real, Registers> const& tile, key_tile<Real> const& keys, std::size_t key, Real* weights,
                 Real* part, bool fresh) {
    constexpr auto queries = query_tile<Real, Registers>::queries;
    constexpr auto n = lane_count<Real>;
    auto const head_size = keys.head_size;
    auto* const strip = weights + key * queries;

    // Logits, less what is subtracted.
    lanes<Real> logits[strip_rows][Registers];
    unrolled<Registers>([&](auto v) GENRENDER_ALWAYS_INLINE {
        auto const shift = load(tile.shift + v * n);
        unrolled<strip_rows>([&](auto row) GENRENDER_ALWAYS_INLINE { logits[row][v] = shift; });
    });

    // What comes from memory is asked for in good time: the next strip of keys, and all values before their product.
    auto const* Q = tile.Q;
    auto const* const K = &keys.K[key];
    auto const* const V = &keys.V[key];
    auto const step = keys.is_far ? cache_line_bytes / sizeof(Real) : head_size;
    for (std::size_t c = 0; c < head_size;) {
        if (keys.is_far) {
            unrolled<strip_rows>([&](auto row) GENRENDER_ALWAYS_INLINE {
                prefetch_to_read(K[strip_rows + row] + c);
                prefetch_to_read(V[row] + c);
            });
        }
        for (auto const end = std::min(c + step, head_size); c < end; ++c, Q += queries) {
            lanes<Real> q[Registers];
            unrolled<Registers>([&](auto v) GENRENDER_ALWAYS_INLINE { q[v] = load(Q + v * n); });
            unrolled<strip_rows>([&](auto row) GENRENDER_ALWAYS_INLINE {
                auto const k = K[row][c];
                unrolled<Registers>([&](auto v) GENRENDER_ALWAYS_INLINE { logits[row][v] += q[v] * k; });
            });
        }
    }

    // Stay within the headroom.
    auto greatest = logits[0][0];
    unrolled<strip_rows * Registers>([&](auto i) GENRENDER_ALWAYS_INLINE {
        greatest = greater<Real>(greatest, logits[i / Registers][i % Registers]);
    });
    auto const first = fresh && key == 0;
    if (first || any_greater<Real>(greatest, spread(Real{headroom}))) [[unlikely]] {
        unrolled<strip_rows * Registers>(
            [&](auto i) GENRENDER_ALWAYS_INLINE { store(strip + i * n, logits[i / Registers][i % Registers]); });
        shift_logits(tile, fresh ? 0 : head_size, weights, strip, part, first);
        unrolled<strip_rows * Registers>(
            [&](auto i) GENRENDER_ALWAYS_INLINE { logits[i / Registers][i % Registers] = load(strip + i * n); });
    }

    // Weights and their sums.
    unrolled<Registers>([&](auto v) GENRENDER_ALWAYS_INLINE {
        auto sum = load(part + v * n);
        unrolled<strip_rows>([&](auto row) GENRENDER_ALWAYS_INLINE {
            auto const weight = exponential_2<Real>(logits[row][v]);
            store(strip + row * queries + v * n, weight);
            sum += weight * keys.counts[key + row];
        });
        store(part + v * n, sum);
    });
}

/// Adds weights [keys, queries] times `Rows` columns of V to as many rows of F, or writes them if F is `fresh`. Sums of
/// a tile of keys start from 0, so that rounding grows with the number of tiles and not with that of keys.
template <std::size_t Rows, class Real, std::size_t Registers>
void add_values(query_tile<Real, Registers> const& tile, key_tile<Real> const& keys, std::size_t channel,
                Real const* weights, bool fresh) {
    constexpr auto queries = query_tile<Real, Registers>::queries;
    constexpr auto n = lane_count<Real>;
    lanes<Real> sums[Rows][Registers]{};
    auto const add_key = [&](Real const* V) GENRENDER_ALWAYS_INLINE {
        lanes<Real> w[Registers];
        unrolled<Registers>([&](auto v) GENRENDER_ALWAYS_INLINE { w[v] = load(weights + v * n); });
        unrolled<Rows>([&](auto row) GENRENDER_ALWAYS_INLINE {
            auto const value = V[row];
            unrolled<Registers>([&](auto v) GENRENDER_ALWAYS_INLINE { sums[row][v] += w[v] * value; });
        });
        weights += queries;
    };
    if (keys.is_far) {
        for (std::size_t k = 0; k < keys.keys; ++k) {
            add_key(keys.V[k] + channel);
        }
    } else {
        auto const* V = keys.V[0] + channel;
        for (std::size_t k = 0; k < keys.keys; ++k, V += keys.head_size) {
            add_key(V);
        }
    }
    auto* const F = tile.F + channel * queries;
    unrolled<Rows * Registers>([&](auto i) GENRENDER_ALWAYS_INLINE {
        auto const sum = sums[i / Registers][i % Registers];
        store(F + i * n, fresh ? sum : load(F + i * n) + sum);
    });
}

/// Adds a tile of keys to the online softmax of a tile of queries, the first one if `fresh`. `weights` is scratch of
/// tile_keys + 1 rows. Rows of `ahead` are about to be written and asked for meanwhile.
template <class Real, std::size_t Registers>
void attend_to_tile(query_tile<Real, Registers> const& tile, key_tile<Real> const& keys, Real* weights, bool fresh,
                    strided_view<Real, 2> const& ahead = {}) {
    constexpr auto queries = query_tile<Real, Registers>::queries;
    auto* const part = weights + tile_keys * queries;
    for (std::size_t q = 0; q < queries; q += lane_count<Real>) {
        store(part + q, lanes<Real>{});
    }
    for (std::size_t key = 0; key < keys.keys; key += strip_rows) {
        weigh_strip(tile, keys, key, weights, part, fresh);
    }
    for (std::size_t q = 0; q < queries; q += lane_count<Real>) {
        store(tile.sum + q, load(tile.sum + q) + load(part + q));
    }

    // Share the channels out evenly, so that no strip is so short as to wait for its own sums.
    auto const strips = (keys.head_size + strip_rows - 1) / strip_rows;
    auto const rows_ahead = (ahead.extent(0) + strips - 1) / strips;
    std::size_t asked = 0;
    for (std::size_t strip = 0; strip < strips; ++strip) {
        for (auto const end = std::min(asked + rows_ahead, ahead.extent(0)); asked < end; ++asked) {
            for (std::size_t c = 0; c < ahead.extent(1); c += cache_line_bytes / sizeof(Real)) {
                prefetch_to_write(&ahead(asked, c));
            }
        }
        auto const channel = strip * keys.head_size / strips;
        auto const rows = (strip + 1) * keys.head_size / strips - channel;
        unrolled<strip_rows>([&](auto less_one) GENRENDER_ALWAYS_INLINE {
            if (rows == less_one + 1) {
                add_values<less_one + 1>(tile, keys, channel, weights, fresh);
            }
        });
    }
}

} // namespace genrender::detail::GENRENDER_TARGET
