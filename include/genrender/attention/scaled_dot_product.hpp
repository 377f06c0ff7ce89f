// SPDX-License-Identifier: MIT
// [GR eq. 1] Attn(Q; K; V) = Softmax(Q K^T / sqrt(d)) V, over keys and values that lie in several blocks.
#pragma once

#include <genrender/core/linalg.hpp>
#include <genrender/core/stack.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

namespace genrender {

/// Keys and values of some tokens, each [tokens, channels].
template <class Real>
struct key_value_view {
    strided_view<Real const, 2> K;
    strided_view<Real const, 2> V;
};

namespace detail {

/// The view itself if its rows are contiguous, else a copy of it in `storage`.
template <class Real>
strided_view<Real const, 2> with_contiguous_rows(strided_view<Real const, 2> view, stack<Real, 2>& storage) {
    if (view.rows_are_contiguous()) {
        return view;
    }
    storage = stack<Real, 2>(view.extents());
    copy(storage.view(), view);
    return storage.view();
}

/// Columns of one head of a view [tokens, channels].
template <class Real>
strided_view<Real, 2> head_of(strided_view<Real, 2> view, std::size_t head, std::size_t head_size) {
    return {view.data() + static_cast<std::ptrdiff_t>(head * head_size), {view.extent(0), head_size}, view.strides()};
}

/// Scratch of one tile of queries: its logits, running maxima and sums.
template <class Real>
struct attention_tile {
    static constexpr std::size_t queries = 64;
    static constexpr std::size_t keys = 256;
    matrix<Real> logits{Eigen::Index{queries}, Eigen::Index{keys}};
    Eigen::Array<Real, Eigen::Dynamic, 1> maximum{Eigen::Index{queries}};
    Eigen::Array<Real, Eigen::Dynamic, 1> sum{Eigen::Index{queries}};
};

/// Adds one run of keys to a tile of the online softmax (Milakov and Gimelshein 2018): everything summed so far is
/// rescaled whenever a larger logit appears, so the matrix of all logits is never in memory.
template <class Real, class Output>
void attend_to_run(Output F, matrix_map<Real const> Q, matrix_map<Real const> K, matrix_map<Real const> V, Real scale,
                   attention_tile<Real>& tile) {
    auto const rows = Q.rows();
    auto logits = tile.logits.topLeftCorner(rows, K.rows());
    logits.noalias() = Q * K.transpose();
    logits *= scale;
    for (Eigen::Index r = 0; r < rows; ++r) {
        auto const maximum = std::max(tile.maximum(r), logits.row(r).maxCoeff());
        auto const rescale = std::exp(tile.maximum(r) - maximum);
        logits.row(r).array() = (logits.row(r).array() - maximum).exp();
        tile.sum(r) = tile.sum(r) * rescale + logits.row(r).sum();
        tile.maximum(r) = maximum;
        F.row(r) *= rescale;
    }
    F.noalias() += logits * V;
}

} // namespace detail

/// Writes F [tokens, channels]: multi-head attention of Q [tokens, channels] over the tokens of all `blocks` together,
/// in which head h owns channels [h d, (h + 1) d), d = channels / heads. Exact softmax, safe against overflow; blocks
/// are read where they lie. F shares no memory with Q, K or V. Throws shape_error if F, K or V do not fit Q,
/// value_error if heads do not divide the channels or no block holds a token.
template <class Real>
void scaled_dot_product(strided_view<Real, 2> F, in_view<Real, 2> Q,
                        std::type_identity_t<std::span<key_value_view<Real> const>> blocks, std::size_t heads) {
    auto const tokens = Q.extent(0);
    auto const channels = Q.extent(1);
    require_shape("scaled_dot_product", "F", F, Q.extents());
    require_value(heads > 0 && channels % std::max<std::size_t>(heads, 1) == 0, "scaled_dot_product", "heads", heads,
                  ("a divisor of the " + std::to_string(channels) + " channels").c_str());
    std::size_t sources = 0;
    for (auto const& block : blocks) {
        require_shape("scaled_dot_product", "K", block.K, {block.K.extent(0), channels});
        require_shape("scaled_dot_product", "V", block.V, block.K.extents());
        sources += block.K.extent(0);
    }
    require_value(sources > 0 || tokens == 0, "scaled_dot_product", "blocks", "empty", "at least one key");
    if (tokens == 0) {
        return; // Views of nothing may have no memory to point into.
    }

    // Make rows contiguous where an engine's strides do not.
    stack<Real, 2> F_storage;
    stack<Real, 2> Q_storage;
    auto const Q_rows = detail::with_contiguous_rows<Real>(Q, Q_storage);
    auto F_rows = F;
    if (!F.rows_are_contiguous()) {
        F_storage = stack<Real, 2>(F.extents());
        F_rows = F_storage.view();
    }
    std::vector<stack<Real, 2>> storage(2 * blocks.size());
    std::vector<key_value_view<Real>> rows(blocks.begin(), blocks.end());
    for (std::size_t b = 0; b < rows.size(); ++b) {
        rows[b].K = detail::with_contiguous_rows<Real>(rows[b].K, storage[2 * b]);
        rows[b].V = detail::with_contiguous_rows<Real>(rows[b].V, storage[2 * b + 1]);
    }

    using tile_type = detail::attention_tile<Real>;
    tile_type tile;
    auto const head_size = channels / heads;
    auto const scale = 1 / std::sqrt(static_cast<Real>(head_size));
    for (std::size_t head = 0; head < heads; ++head) {
        auto const F_head = detail::head_of(F_rows, head, head_size);
        auto const Q_head = detail::head_of(Q_rows, head, head_size);
        for (std::size_t q = 0; q < tokens; q += tile_type::queries) {
            auto const q_count = std::min(tile_type::queries, tokens - q);
            auto F_tile = to_matrix(F_head.slice(q, q_count));
            F_tile.setZero();
            tile.maximum.setConstant(-std::numeric_limits<Real>::infinity());
            tile.sum.setZero();
            for (auto const& block : rows) {
                auto const K_head = detail::head_of(block.K, head, head_size);
                auto const V_head = detail::head_of(block.V, head, head_size);
                for (std::size_t k = 0; k < block.K.extent(0); k += tile_type::keys) {
                    auto const k_count = std::min(tile_type::keys, block.K.extent(0) - k);
                    detail::attend_to_run<Real>(F_tile, to_matrix(Q_head.slice(q, q_count)),
                                                to_matrix(K_head.slice(k, k_count)),
                                                to_matrix(V_head.slice(k, k_count)), scale, tile);
                }
            }
            F_tile.array().colwise() /= tile.sum.head(static_cast<Eigen::Index>(q_count));
        }
    }
    if (F_rows.data() != F.data()) {
        copy(F, in_view<Real, 2>(F_rows));
    }
}

} // namespace genrender
