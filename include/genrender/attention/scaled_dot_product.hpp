// SPDX-License-Identifier: MIT
// [GR eq. 1] Attn(Q; K; V) = Softmax(Q K^T / sqrt(d)) V, over keys and values that lie in several blocks.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/attention/attention_scratch.hpp>
#include <genrender/attention/attention_tile.hpp>
#include <genrender/attention/key_value_view.hpp>
#include <genrender/core/finite.hpp>
#include <genrender/core/instance.hpp>
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

#define GENRENDER_KERNELS <genrender/attention/scaled_dot_product.inl>
#include <genrender/core/each_target.inl>

namespace genrender {

inline namespace GENRENDER_UNIT {

/// Writes F [tokens, channels]: multi-head attention of Q [tokens, channels] over the tokens of all `blocks` together,
/// in which head h owns channels [h d, (h + 1) d), d = channels / heads. Exact softmax, safe against overflow; blocks
/// are read where they lie, and nothing grows with their number: scratch is about 1 MB a thread of `loop`, which runs
/// over heads and parts of the queries. A row of F depends on its query and on the sequence of all keys alone, to the
/// last bit: neither on the other queries, nor on `loop`, nor on where one block ends and the next begins. F shares no
/// memory with Q, K or V. `scale` multiplies the logits beside 1 / sqrt(d), at no cost (length_correction). Throws shape_error if F, K, V or counts do not fit, value_error if heads do not divide the
/// channels, no block holds a token, a count is not above 0 or the scale is not finite.
template <class Real>
void scaled_dot_product(strided_view<Real, 2> F, in_view<Real, 2> Q,
                        std::type_identity_t<std::span<key_value_view<Real> const>> blocks, std::size_t heads,
                        any_loop const& loop = {}, std::type_identity_t<Real> scale = 1) {
    auto const tokens = Q.extent(0);
    auto const channels = Q.extent(1);
    require_shape("scaled_dot_product", "F", F, Q.extents());
    require_value(heads > 0 && channels % std::max<std::size_t>(heads, 1) == 0, "scaled_dot_product", "heads", heads,
                  ("a divisor of the " + std::to_string(channels) + " channels").c_str());
    require_value(is_finite(scale), "scaled_dot_product", "scale", scale, "a finite number");
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
    auto const run = GENRENDER_KERNEL(detail, queries_of_run<Real>)(tokens, head_size);
    auto const runs = (tokens + run - 1) / run;
    auto const attend = GENRENDER_KERNEL(detail, attend_head<Real>);
    loop(heads * runs, [&](std::size_t i) {
        auto const head = i / runs;
        auto const first = i % runs * run;
        auto const count = std::min(run, tokens - first);
        attend(detail::head_of(F.slice(first, count), head, head_size),
               detail::head_of(Q.slice(first, count), head, head_size), blocks, head, scale);
    });
}

GENRENDER_INSTANCE(scaled_dot_product<float>);
GENRENDER_INSTANCE(scaled_dot_product<double>);

} // namespace GENRENDER_UNIT

} // namespace genrender

#include <genrender/core/end_header.inl>
