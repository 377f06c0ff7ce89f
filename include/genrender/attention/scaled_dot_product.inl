// SPDX-License-Identifier: MIT
// [GR eq. 1] Attention of some queries of one head over all keys, with the vectors of one target.

namespace genrender::detail::GENRENDER_TARGET {

/// Calls body(tile, first, count) for tiles that cover `queries`, one memory after the other: full ones, and at the end
/// narrow ones where they are less work.
template <class Real, class Body>
void each_query_tile(Real* memory, std::size_t queries, std::size_t head_size, Body&& body) {
    using full = query_tile<Real, tile_registers>;
    using narrow = query_tile<Real, 1>;
    std::size_t first = 0;
    while (first < queries) {
        auto const rest = queries - first;
        auto const visit = [&]<class Tile>(std::type_identity<Tile>) {
            auto const count = std::min(rest, Tile::queries);
            body(Tile(memory, head_size), first, count);
            memory += Tile::size(head_size);
            first += count;
        };
        if (2 * rest > full::queries) {
            visit(std::type_identity<full>{});
        } else {
            visit(std::type_identity<narrow>{});
        }
    }
}

/// Attention of some queries of one head, F and Q [queries, head_size], with logits times `by`. Each key is read or copied once for all of
/// them.
template <class Real>
void attend_head(strided_view<Real, 2> F, strided_view<Real const, 2> Q, std::span<key_value_view<Real> const> blocks,
                 std::size_t head, Real by) {
    using full = query_tile<Real, tile_registers>;
    auto const queries = Q.extent(0);
    auto const head_size = Q.extent(1);
    auto const tiles = (queries + full::queries - 1) / full::queries;
    auto const of_keys = key_tiles<Real>::scratch(head_size);
    auto const of_weights = (tile_keys + 1) * full::queries;
    auto memory = stack<Real, 1>::uninitialized({of_keys + of_weights + tiles * full::size(head_size)});
    // Few queries read each key once, or twice in narrow tiles.
    key_tiles<Real> keys(blocks, head, head_size, memory.data(), tiles == 1);
    auto* const weights = memory.data() + of_keys;
    auto* const tile_memory = weights + of_weights;

    // exp(x) = 2^(x log2 e).
    auto const scale = std::numbers::log2e_v<Real> / std::sqrt(static_cast<Real>(head_size)) * by;
    each_query_tile(tile_memory, queries, head_size, [&](auto const& tile, std::size_t first, std::size_t count) {
        read_queries(tile, Q.slice(first, count), scale);
    });
    for (bool fresh = true; keys.next(); fresh = false) {
        each_query_tile(tile_memory, queries, head_size, [&](auto const& tile, std::size_t first, std::size_t count) {
            auto const ahead = F.slice(first, keys.is_last() ? count : 0);
            attend_to_tile(tile, keys.tile(), weights, fresh, ahead);
        });
    }
    each_query_tile(tile_memory, queries, head_size, [&](auto const& tile, std::size_t first, std::size_t count) {
        write_results(F.slice(first, count), tile);
    });
}

/// How many queries one run over the keys takes, all runs alike: as many as fit the second cache, and so few that there
/// are runs for several threads. The result does not depend on it.
template <class Real>
std::size_t queries_of_run(std::size_t tokens, std::size_t head_size) {
    using full = query_tile<Real, tile_registers>;
    constexpr std::size_t cached_bytes = std::size_t{640} * 1024;
    constexpr std::size_t most_queries = 1024;
    auto const fitting = cached_bytes / (full::size(head_size) * sizeof(Real));
    auto const most = std::clamp<std::size_t>(fitting, 1, most_queries / full::queries);
    auto const tiles = (tokens + full::queries - 1) / full::queries;
    auto const runs = (tiles + most - 1) / most;
    return full::queries * ((tiles + runs - 1) / runs);
}

} // namespace genrender::detail::GENRENDER_TARGET
