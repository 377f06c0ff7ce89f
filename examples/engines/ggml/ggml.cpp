// SPDX-License-Identifier: MIT
// ggml behind genrender: the small network as static graphs, one for each pass, stack and prompt, built once.
#include "network.hpp"

#include "../static_graph/comparison.hpp"

#include <genrender/pipeline/render.hpp>
#include <genrender/sampling/preconditioning.hpp>

#include <ggml-alloc.h>
#include <ggml-cpu.h>

#include <algorithm>
#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

namespace genrender::examples {
namespace {

/// A graph that is built once and run often; its allocator's memory lasts from one run to the next, its values do not.
struct built_graph {
    ggml_context_ptr ctx;
    ggml_gallocr_ptr memory;
    ggml_cgraph* graph = nullptr;
    ggml_tensor* z = nullptr;
    ggml_tensor* shift = nullptr;
    ggml_tensor* v = nullptr;
};

class ggml_denoiser {
public:
    using real_type = float;
    using features_type = adapters::ggml_features;
    std::size_t latent_channels() const { return small_unet::latent_channels; }
    grid_extents latent_grid() const { return small_unet::grid; }
    auto const& sites() const { return engine_->net.sites; }
    std::size_t branches() const { return small_unet::prompts; }

    void prepare(run_shapes const& shapes) const {
        auto& e = *engine_;
        e.graphs.clear();
        e.io.emplace(e.backend.get(), shapes, e.net.sites);
    }

    template <feature_io_processor<features_type, float> Processor>
    void operator()(strided_view<float, 4> x0, strided_view<float const, 4> z, float sigma,
                    std::span<frame_index const> frames, Processor& processor) const {
        auto& e = *engine_;
        auto const lock = e.io->lock();
        auto const pass = e.io->pass_of(processor, frames);
        auto const c_in = scalings_of(prediction::velocity, sigma).c_in;
        std::vector<float> tokens(z.size());
        std::vector<float> v(z.size());
        auto const in = channels_first(tokens.data(), frames.size());
        linear_combination<float, 4, 1>(in, {c_in}, {z});
        for (std::uint32_t prompt = 0; prompt < branches(); ++prompt) {
            auto& g = e.graph(pass, frames.size(), prompt);
            auto const shift = small_unet::shift(sigma, prompt);
            ggml_backend_tensor_set(g.z, tokens.data(), 0, ggml_nbytes(g.z)); // before every run
            ggml_backend_tensor_set(g.shift, shift.data(), 0, ggml_nbytes(g.shift));
            e.io->write(processor, pass, prompt, frames);
            require_value(ggml_backend_graph_compute(e.backend.get(), g.graph) == GGML_STATUS_SUCCESS, "ggml_denoiser",
                          "graph", "not computed", "a status of success");
            e.io->record(processor, prompt, frames);
            std::vector<float> out(z.size());
            ggml_backend_tensor_get(g.v, out.data(), 0, ggml_nbytes(g.v));
            std::transform(out.begin(), out.end(), v.begin(), v.begin(), [](float a, float b) { return a / 2 + b; });
        }
        to_clean(x0, prediction::velocity, z, channels_first(v.data(), frames.size()), sigma);
    }

private:
    struct engine {
        small_unet net;
        ggml_backend_ptr backend{ggml_backend_cpu_init()};
        adapters::ggml_fixed_tensors weights{20};
        std::map<layer_weights const*, ggml_tensor*> tensor_of;
        std::optional<adapters::ggml_feature_io> io;
        std::map<std::tuple<graph_pass, std::size_t, std::uint32_t>, built_graph> graphs;

        engine() {
            ggml_backend_cpu_set_n_threads(backend.get(), 1);
            std::vector<layer_weights const*> layers{&net.first, &net.last};
            for (auto const& b : net.blocks) {
                layers.insert(layers.end(), {&b.query, &b.key, &b.value, &b.out, &b.widen, &b.narrow});
            }
            for (auto const* const w : layers) {
                tensor_of[w] = weights.add(GGML_TYPE_F32, {w->inputs, w->outputs, 1, 1});
            }
            weights.allocate(backend.get());
            for (auto const& [w, tensor] : tensor_of) {
                ggml_backend_tensor_set(tensor, w->values.data(), 0, ggml_nbytes(tensor));
            }
        }

        built_graph& graph(graph_pass pass, std::size_t frames, std::uint32_t prompt) {
            auto& g = graphs[{pass, frames, prompt}];
            if (g.graph != nullptr) {
                return g;
            }
            constexpr std::size_t nodes = 1024;
            g.ctx.reset(ggml_init({nodes * ggml_tensor_overhead() + ggml_graph_overhead(), nullptr, true}));
            g.graph = ggml_new_graph(g.ctx.get());
            g.z = ggml_new_tensor_3d(g.ctx.get(), GGML_TYPE_F32, std::int64_t{small_unet::latent_channels},
                                     static_cast<std::int64_t>(small_unet::grid.size()),
                                     static_cast<std::int64_t>(frames));
            g.shift = ggml_new_tensor_1d(g.ctx.get(), GGML_TYPE_F32, std::int64_t{small_unet::channels});
            ggml_set_input(g.z);
            ggml_set_input(g.shift);
            ggml_operations ops{g.ctx.get(), g.graph, [this](layer_weights const& w) { return tensor_of.at(&w); },
                                [&](site_index s) {
                                    return io->site({s, prompt}, pass, frames);
                                }};
            g.v = net(ops, g.z, g.shift);
            adapters::keep_output(g.v);
            ggml_build_forward_expand(g.graph, g.v);
            g.memory.reset(ggml_gallocr_new(ggml_backend_get_default_buffer_type(backend.get())));
            require_value(ggml_gallocr_alloc_graph(g.memory.get(), g.graph), "ggml_denoiser", "graph", "without memory",
                          "enough for its nodes");
            return g;
        }
    };
    std::shared_ptr<engine> engine_ = std::make_shared<engine>();
};

static_assert(preparable_denoiser<ggml_denoiser>);

} // namespace
} // namespace genrender::examples

int main() {
    using namespace genrender;
    return examples::compare_graphs(std::string("ggml ") + ggml_version(), [](examples::graph_case const& given) {
        auto run = render(examples::ggml_denoiser{}, to_uv_view(given.UV), {.settings = given.settings});
        return examples::graph_frames{std::move(run.z), std::move(run.report)};
    });
}
