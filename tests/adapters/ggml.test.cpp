// SPDX-License-Identifier: MIT
// Graphs of ggml are built once and run often; a denoiser of them gives the clean estimate.
#include <genrender/adapters/ggml.hpp>

#include "one_module.hpp"

#include <doctest/doctest.h>
#include <ggml-cpu.h>

#include <cstddef>
#include <vector>

using namespace genrender;
using namespace genrender::testing;

TEST_SUITE("adapters/ggml") {
    using adapters::ggml_graph;

    TEST_CASE("inputs and output of a ggml graph go by name and must fit") {
        ggml_backend_ptr const backend(ggml_backend_cpu_init());
        check_inputs_and_output<ggml_graph>(
            {backend.get()}, [](ggml_graph& graph, ggml_tensor* x) { return ggml_scale(graph.context(), x, 2); });
    }

    TEST_CASE("an output that is not contiguous, or of 16 bits, is read as rows of floats") {
        ggml_backend_ptr const backend(ggml_backend_cpu_init());
        check_inputs_and_output<ggml_graph>({backend.get()}, [](ggml_graph& graph, ggml_tensor* x) {
            auto* const ctx = graph.context();
            auto* const turned = ggml_cont(ctx, ggml_transpose(ctx, ggml_scale(ctx, x, 2)));
            return ggml_transpose(ctx, ggml_cast(ctx, turned, GGML_TYPE_F32));
        });
        check_inputs_and_output<ggml_graph>({backend.get()}, [](ggml_graph& graph, ggml_tensor* x) {
            return ggml_cast(graph.context(), ggml_scale(graph.context(), x, 2), GGML_TYPE_F16);
        });
    }

    TEST_CASE("an input of more axes than ggml has is refused") {
        ggml_backend_ptr const backend(ggml_backend_cpu_init());
        run_shapes shapes;
        shapes.lists_sources = false;
        auto const io = ggml_graph::make_feature_io({backend.get()}, shapes, {});
        ggml_graph graph({backend.get()}, *io, {});
        CHECK_THROWS_WITH_AS(graph.add_input("x", {1, 2, 3, 4, 5}), doctest::Contains("shape.size() is 5"),
                             value_error);
    }

    TEST_CASE("[EDM eq. 7] a denoiser of ggml graphs gives the guided estimate in either layout") {
        ggml_backend_ptr const backend(ggml_backend_cpu_init());
        check_denoiser<ggml_graph>({backend.get()}, [](ggml_graph& graph, ggml_tensor* a, ggml_tensor* b) {
            return ggml_add(graph.context(), a, b);
        });
    }

    TEST_CASE("runs that ggml graphs cannot do are refused before they begin") {
        ggml_backend_ptr const backend(ggml_backend_cpu_init());
        check_refused_runs<ggml_graph>({backend.get()});
    }

    static_assert(preparable_denoiser<adapters::ggml_denoiser>);
}
