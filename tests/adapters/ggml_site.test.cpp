// SPDX-License-Identifier: MIT
// [GR eq. 3, 5, 6 as a static graph] A module of ggml graphs gives what the library's own call gives.
#include <genrender/adapters/ggml_site.hpp>

#include "one_module.hpp"

#include <genrender/adapters/ggml.hpp>

#include <doctest/doctest.h>
#include <ggml-cpu.h>

#include <cmath>
#include <cstddef>
#include <cstdint>

using namespace genrender;
using namespace genrender::testing;

TEST_SUITE("adapters/ggml_site") {
    namespace {

    /// A self-attention module of matrices in ggml.
    struct ggml_module {
        using graph_type = adapters::ggml_graph;

        explicit ggml_module(matrix_module<float> const& m) : module(m) {
            ggml_backend_cpu_set_n_threads(backend.get(), 1);
            for (auto* const W : {&Q, &K, &V}) {
                *W = weights.add(GGML_TYPE_F32, {m.W_Q.extent(1), m.W_Q.extent(0), 1, 1});
            }
            weights.allocate(backend.get());
            ggml_backend_tensor_set(Q, m.W_Q.data(), 0, ggml_nbytes(Q));
            ggml_backend_tensor_set(K, m.W_K.data(), 0, ggml_nbytes(K));
            ggml_backend_tensor_set(V, m.W_V.data(), 0, ggml_nbytes(V));
        }

        adapters::ggml_device device() const { return {backend.get()}; }

        ggml_tensor* build(adapters::ggml_graph& graph, ggml_tensor* f) const {
            auto* const ctx = graph.context();
            // docs:begin ggml_graph
            auto const site = graph.site({1});
            auto* const queries = site.queries(ctx, f);
            // Keys are projected of joined tokens, values of keyframes apart and joined then: both are allowed.
            auto* const k = by_head(ctx, ggml_mul_mat(ctx, K, site.sources(ctx, f)));
            auto* const of_keyframes = site.keyframes(ctx, GGML_TYPE_F32);
            auto* const own = ggml_mul_mat(ctx, V, queries);
            auto* const joined =
                site.join(ctx, own, of_keyframes == nullptr ? nullptr : ggml_mul_mat(ctx, V, of_keyframes));
            auto* const v = ggml_cont(ctx, ggml_transpose(ctx, by_head(ctx, joined)));
            auto* const q = by_head(ctx, site.scaled(ctx, ggml_mul_mat(ctx, Q, queries)));
            auto* products = ggml_scale(ctx, ggml_mul_mat(ctx, k, q), 1 / std::sqrt(static_cast<float>(q->ne[0])));
            if (site.mask() != nullptr) {
                products = ggml_add(ctx, products, site.mask());
            }
            auto* const heads = ggml_mul_mat(ctx, v, ggml_soft_max(ctx, products));
            auto* const by_token = ggml_cont(ctx, ggml_permute(ctx, heads, 0, 2, 1, 3));
            return site.output(ctx, graph.graph(), f,
                               ggml_reshape_3d(ctx, by_token, f->ne[0], by_token->ne[2], by_token->ne[3]));
            // docs:end
        }

        ggml_tensor* by_head(ggml_context* ctx, ggml_tensor* x) const {
            auto const heads = static_cast<std::int64_t>(module.heads());
            auto* const split = ggml_reshape_4d(ctx, x, x->ne[0] / heads, heads, x->ne[1], x->ne[2]);
            return ggml_cont(ctx, ggml_permute(ctx, split, 0, 2, 1, 3));
        }

        matrix_module<float> const& module;
        ggml_backend_ptr backend{ggml_backend_cpu_init()};
        adapters::ggml_fixed_tensors weights{3};
        ggml_tensor* Q = nullptr;
        ggml_tensor* K = nullptr;
        ggml_tensor* V = nullptr;
    };

    } // namespace

    TEST_CASE("[GR eq. 3, 5, 6] a module of ggml graphs equals the library's call in every pass") {
        check_every_pass<ggml_module>();
    }

    TEST_CASE("features of ggml in 16 bits differ from the library's by their rounding alone") {
        check_half_precision<ggml_module>();
    }

    TEST_CASE("queries are left as they are where nothing is scaled: a ggml graph has no node for it") {
        adapters::ggml_site const site(graph_pass::injected, {}, nullptr, nullptr, nullptr);
        ggml_tensor Q{};
        CHECK(site.scaled(nullptr, &Q) == &Q);
    }
}
