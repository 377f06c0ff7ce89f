// SPDX-License-Identifier: MIT
// [GR eq. 1] Attn(Q; K; V) = Softmax(Q K^T / sqrt(d)) V, over keys and values that lie in several blocks.
#pragma once

#include <genrender/attention/attention_scratch.hpp>
#include <genrender/attention/attention_tile.hpp>
#include <genrender/attention/key_value_view.hpp>
#include <genrender/core/parallel.hpp>
#include <genrender/core/stack.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <span>
#include <string>
#include <type_traits>

namespace genrender {

namespace detail {

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

/// Attention of some queries of one head, F and Q [queries, head_size]. Each key is read or copied once for all of
/// them.
template <class Real>
void attend_head(strided_view<Real, 2> F, strided_view<Real const, 2> Q, std::span<key_value_view<Real> const> blocks,
                 std::size_t head) {
    using full = query_tile<Real, tile_registers>;
    auto const queries = Q.extent(0);
    auto const head_size = Q.extent(1);
    auto const tiles = (queries + full::queries - 1) / full::queries;
    scratch_memory<Real> memory(key_tiles<Real>::scratch(head_size) + (tile_keys + 1) * full::queries +
                                tiles * full::size(head_size));
    // Few queries read each key once, or twice in narrow tiles.
    key_tiles<Real> keys(blocks, head, head_size, memory, tiles == 1);
    auto* const weights = memory.take((tile_keys + 1) * full::queries);
    auto* const tile_memory = memory.take(tiles * full::size(head_size));

    // exp(x) = 2^(x log2 e).
    auto const scale = std::numbers::log2e_v<Real> / std::sqrt(static_cast<Real>(head_size));
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
    constexpr std::size_t cached_bytes = 640 * 1024;
    constexpr std::size_t most_queries = 1024;
    auto const fitting = cached_bytes / (full::size(head_size) * sizeof(Real));
    auto const most = std::clamp<std::size_t>(fitting, 1, most_queries / full::queries);
    auto const tiles = (tokens + full::queries - 1) / full::queries;
    auto const runs = (tiles + most - 1) / most;
    return full::queries * ((tiles + runs - 1) / runs);
}

} // namespace detail

/// Writes F [tokens, channels]: multi-head attention of Q [tokens, channels] over the tokens of all `blocks` together,
/// in which head h owns channels [h d, (h + 1) d), d = channels / heads. Exact softmax, safe against overflow; blocks
/// are read where they lie, and nothing grows with their number: scratch is about 1 MB a thread of `loop`, which runs
/// over heads and parts of the queries. A row of F depends on its query and on the sequence of all keys alone, to the
/// last bit: neither on the other queries, nor on `loop`, nor on where one block ends and the next begins. F shares no
/// memory with Q, K or V. Throws shape_error if F, K, V or counts do not fit, value_error if heads do not divide the
/// channels, no block holds a token or a count is not above 0.
template <class Real, parallel_loop Loop = sequential_loop>
void scaled_dot_product(strided_view<Real, 2> F, in_view<Real, 2> Q,
                        std::type_identity_t<std::span<key_value_view<Real> const>> blocks, std::size_t heads,
                        Loop const& loop = Loop{}) {
    auto const tokens = Q.extent(0);
    auto const channels = Q.extent(1);
    require_shape("scaled_dot_product", "F", F, Q.extents());
    require_value(heads > 0 && channels % std::max<std::size_t>(heads, 1) == 0, "scaled_dot_product", "heads", heads,
                  ("a divisor of the " + std::to_string(channels) + " channels").c_str());
    std::size_t sources = 0;
    for (auto const& block : blocks) {
        std::array const expected{block.K.extent(0), channels};
        require_extents("scaled_dot_product", "K", block.K.extents(), expected);
        require_extents("scaled_dot_product", "V", block.V.extents(), expected);
        if (block.counts.extent(0) > 0) {
            require_shape("scaled_dot_product", "counts", block.counts, {expected[0]});
        }
        for (std::size_t k = 0; k < block.counts.extent(0); ++k) {
            auto const count = block.counts(k);
            require_value(count > 0 && count <= std::numeric_limits<Real>::max(), "scaled_dot_product", "counts", count,
                          "finite and above 0");
        }
        sources += expected[0];
    }
    require_value(sources > 0 || tokens == 0, "scaled_dot_product", "blocks", "empty", "at least one key");
    if (tokens == 0 || channels == 0) {
        return; // Views of nothing may have no memory to point into.
    }

    auto const head_size = channels / heads;
    auto const run = detail::queries_of_run<Real>(tokens, head_size);
    auto const runs = (tokens + run - 1) / run;
    loop(heads * runs, [&](std::size_t i) {
        auto const head = i / runs;
        auto const first = i % runs * run;
        auto const count = std::min(run, tokens - first);
        detail::attend_head<Real>(detail::head_of(F.slice(first, count), head, head_size),
                                  detail::head_of(Q.slice(first, count), head, head_size), blocks, head);
    });
}

} // namespace genrender
