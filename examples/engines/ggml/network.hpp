// SPDX-License-Identifier: MIT
// The small network in ggml: its weights on a backend, and its operations as nodes of a graph; features are ne = {channels,
// tokens, frames}.
#pragma once

#include "../static_graph/network.hpp"

#include <genrender/adapters/ggml.hpp>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>

namespace genrender::examples {

/// The tensors of a network's weights, by layer; the network and the backend outlive them.
struct ggml_weights {
    adapters::ggml_fixed_tensors memory{20};
    std::map<layer_weights const*, ggml_tensor*> of;

    ggml_weights(ggml_backend_t backend, small_unet const& net) {
        for (auto const* const w : net.layers()) {
            of[w] = memory.add(GGML_TYPE_F32, {w->inputs, w->outputs, 1, 1});
        }
        memory.allocate(backend);
        for (auto const& [w, tensor] : of) {
            ggml_backend_tensor_set(tensor, w->values.data(), 0, ggml_nbytes(tensor));
        }
    }
};

/// Appends nodes to a graph.
struct ggml_operations {
    adapters::ggml_graph& graph;
    ggml_weights const& weights;
    ggml_context* ctx = graph.context();

    ggml_tensor* linear(layer_weights const& w, ggml_tensor* x) const {
        return ggml_mul_mat(ctx, weights.of.at(&w), x);
    }
    ggml_tensor* add(ggml_tensor* a, ggml_tensor* b) const { return ggml_add(ctx, a, b); }
    ggml_tensor* silu(ggml_tensor* x) const { return ggml_silu(ctx, x); }
    ggml_tensor* normalized(ggml_tensor* x) const { return ggml_norm(ctx, x, small_unet::epsilon); }

    ggml_tensor* pooled(ggml_tensor* x, grid_extents from) const {
        auto const width = static_cast<std::int64_t>(from.width);
        auto const rows = static_cast<std::int64_t>(from.height) * x->ne[2];
        auto const token = x->nb[1];
        auto const quarter = [&](std::size_t row, std::size_t column) {
            auto* const part = ggml_view_3d(ctx, x, x->ne[0], width / 2, rows / 2, 2 * token, 2 * from.width * token,
                                            (row * from.width + column) * token);
            return ggml_cont(ctx, part);
        };
        auto* const sum = add(add(quarter(0, 0), quarter(0, 1)), add(quarter(1, 0), quarter(1, 1)));
        return ggml_reshape_3d(ctx, ggml_scale(ctx, sum, 0.25f), x->ne[0], x->ne[1] / 4, x->ne[2]);
    }

    ggml_tensor* enlarged(ggml_tensor* x, grid_extents from) const {
        auto const width = static_cast<std::int64_t>(from.width);
        auto const channels = x->ne[0];
        auto const rows = static_cast<std::int64_t>(from.height) * x->ne[2];
        auto* const wide =
            ggml_repeat_4d(ctx, ggml_reshape_4d(ctx, x, channels, 1, width, rows), channels, 2, width, rows);
        auto* const tall =
            ggml_repeat_4d(ctx, ggml_reshape_4d(ctx, wide, channels, 2 * width, 1, rows), channels, 2 * width, 2, rows);
        return ggml_reshape_3d(ctx, tall, channels, 4 * x->ne[1], x->ne[2]);
    }

    ggml_tensor* attention(site_index index, small_unet::block const& block, ggml_tensor* f) const {
        auto const module = graph.site(index);
        auto* const sources = module.sources(ctx, f);
        auto* const Q = by_head(module.scaled(ctx, linear(block.query, module.queries(ctx, f))));
        auto* const K = by_head(linear(block.key, sources));
        auto* const V = ggml_cont(ctx, ggml_transpose(ctx, by_head(linear(block.value, sources))));
        auto* products = ggml_scale(ctx, ggml_mul_mat(ctx, K, Q), 1 / std::sqrt(static_cast<float>(Q->ne[0])));
        if (module.mask() != nullptr) {
            products = add(products, module.mask());
        }
        auto* const heads =
            ggml_mul_mat(ctx, V, ggml_soft_max(ctx, products)); // {channels of a head, tokens, heads, frames}
        auto* const F = ggml_cont(ctx, ggml_permute(ctx, heads, 0, 2, 1, 3));
        return module.output(ctx, graph.graph(), f, ggml_reshape_3d(ctx, F, f->ne[0], F->ne[2], F->ne[3]));
    }

    /// {channels, tokens, frames} as {channels of a head, tokens, heads, frames}.
    ggml_tensor* by_head(ggml_tensor* x) const {
        constexpr auto heads = static_cast<std::int64_t>(small_unet::heads);
        auto* const split = ggml_reshape_4d(ctx, x, x->ne[0] / heads, heads, x->ne[1], x->ne[2]);
        return ggml_cont(ctx, ggml_permute(ctx, split, 0, 2, 1, 3));
    }
};

} // namespace genrender::examples
