// SPDX-License-Identifier: MIT
// [GR eq. 3, 5, 6 as a static graph] A module of ggml graphs gives what the library's own call gives.
#include <genrender/adapters/ggml.hpp>

#include "one_module.hpp"

#include <doctest/doctest.h>
#include <ggml-alloc.h>
#include <ggml-cpu.h>

#include <cmath>
#include <cstddef>
#include <map>
#include <utility>

using namespace genrender;
using namespace genrender::testing;

TEST_SUITE("adapters/ggml") {
    namespace {

    /// Graphs of one module, one for each pass and number of frames.
    struct ggml_module {
        using features_type = adapters::ggml_features;

        ggml_module(run_shapes const& shapes, std::span<attention_site const> sites, matrix_module<float> const& m)
            : module(m), io(backend.get(), shapes, sites) {
            ggml_backend_cpu_set_n_threads(backend.get(), 1);
            for (auto* const W : {&Q, &K, &V}) {
                *W = weights.add(GGML_TYPE_F32, {m.W_Q.extent(1), m.W_Q.extent(0), 1, 1});
            }
            weights.allocate(backend.get());
            ggml_backend_tensor_set(Q, m.W_Q.data(), 0, ggml_nbytes(Q));
            ggml_backend_tensor_set(K, m.W_K.data(), 0, ggml_nbytes(K));
            ggml_backend_tensor_set(V, m.W_V.data(), 0, ggml_nbytes(V));
        }

        // docs:begin ggml_call
        template <class Processor>
        stack<float, 3> operator()(Processor const& processor, attention_place place,
                                   std::span<frame_index const> frames, stack<float, 3> const& f) {
            auto const pass = io.pass_of(processor, frames);
            auto& g = graphs[{pass, frames.size()}];
            if (g.graph == nullptr) {
                build(g, place, pass, f);
            }
            ggml_backend_tensor_set(g.f, f.data(), 0, ggml_nbytes(g.f));
            io.write(processor, pass, place.branch, frames);
            REQUIRE(ggml_backend_graph_compute(backend.get(), g.graph) == GGML_STATUS_SUCCESS);
            io.record(processor, place.branch, frames);
            stack<float, 3> F(f.extents());
            ggml_backend_tensor_get(g.F, F.data(), 0, ggml_nbytes(g.F));
            return F;
        }
        // docs:end

        struct built {
            ggml_context_ptr ctx;
            ggml_gallocr_ptr memory;
            ggml_cgraph* graph = nullptr;
            ggml_tensor* f = nullptr;
            ggml_tensor* F = nullptr;
        };

        void build(built& g, attention_place place, graph_pass pass, stack<float, 3> const& f) {
            g.ctx.reset(ggml_init({1024 * ggml_tensor_overhead() + ggml_graph_overhead(), nullptr, true}));
            auto* const ctx = g.ctx.get();
            g.graph = ggml_new_graph(ctx);
            g.f = ggml_new_tensor_3d(ctx, GGML_TYPE_F32, static_cast<std::int64_t>(f.extent(2)),
                                     static_cast<std::int64_t>(f.extent(1)), static_cast<std::int64_t>(f.extent(0)));
            ggml_set_input(g.f);
            // docs:begin ggml_graph
            auto const site = io.site(place, pass, f.extent(0));
            auto* const queries = site.queries(ctx, g.f);
            // Keys are projected of joined tokens, values of keyframes apart and joined then: both are allowed.
            auto* const k = by_head(ctx, ggml_mul_mat(ctx, K, site.sources(ctx, g.f)));
            auto* const of_keyframes = site.keyframes(ctx, GGML_TYPE_F32);
            auto* const own = ggml_mul_mat(ctx, V, queries);
            auto* const joined =
                site.join(ctx, own, of_keyframes == nullptr ? nullptr : ggml_mul_mat(ctx, V, of_keyframes));
            auto* const v = ggml_cont(ctx, ggml_transpose(ctx, by_head(ctx, joined)));
            auto* const q = by_head(ctx, ggml_mul_mat(ctx, Q, queries));
            auto* products = ggml_scale(ctx, ggml_mul_mat(ctx, k, q), 1 / std::sqrt(static_cast<float>(q->ne[0])));
            if (site.mask() != nullptr) {
                products = ggml_add(ctx, products, site.mask());
            }
            auto* const heads = ggml_mul_mat(ctx, v, ggml_soft_max(ctx, products));
            auto* const by_token = ggml_cont(ctx, ggml_permute(ctx, heads, 0, 2, 1, 3));
            g.F = site.output(ctx, g.graph, g.f,
                              ggml_reshape_3d(ctx, by_token, g.f->ne[0], by_token->ne[2], by_token->ne[3]));
            // docs:end
            adapters::keep_output(g.F);
            ggml_build_forward_expand(g.graph, g.F);
            g.memory.reset(ggml_gallocr_new(ggml_backend_get_default_buffer_type(backend.get())));
            REQUIRE(ggml_gallocr_alloc_graph(g.memory.get(), g.graph));
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
        adapters::ggml_feature_io io;
        std::map<std::pair<graph_pass, std::size_t>, built> graphs;
    };

    } // namespace

    TEST_CASE("[GR eq. 3, 5, 6] a module of ggml graphs equals the library's call in every pass") {
        for (auto const pre : {true, false}) {
            for (auto const post : {true, false}) {
                for (auto const keeps : {true, false}) {
                    auto const apart = compare_module<ggml_module>({pre, post, keeps});
                    CHECK(apart.plain <= 1e-6);
                    CHECK(apart.keyframe <= 1e-6);
                    CHECK(apart.injected <= 1e-6);
                    CHECK(apart.second_step <= 1e-6);
                }
            }
        }
    }

    TEST_CASE("features in 16 bits differ from the library's by their rounding alone") {
        for (auto const storage : {feature_storage::f16, feature_storage::bf16}) {
            auto const apart = compare_module<ggml_module>({true, true, false, storage});
            CHECK(apart.keyframe <= 1e-6);
            CHECK(apart.injected > 0);
            CHECK(apart.injected <= (storage == feature_storage::f16 ? 2e-3 : 2e-2));
        }
    }

    TEST_CASE("runs that static graphs cannot do are refused before they begin") {
        ggml_backend_ptr const backend(ggml_backend_cpu_init());
        run_shapes shapes;
        CHECK_THROWS_WITH_AS(adapters::ggml_feature_io(backend.get(), shapes, {}),
                             doctest::Contains("shapes.lists_sources"), value_error);
        shapes.lists_sources = false;
        shapes.banks = 2;
        CHECK_THROWS_WITH_AS(adapters::ggml_feature_io(backend.get(), shapes, {}), doctest::Contains("one bank"),
                             value_error);
    }
}
