// SPDX-License-Identifier: MIT
// Your own engine behind genrender, wired both ways: called back at each self-attention site, or as a static graph.
#include "scenes/camera_rotation.hpp"
#include "support/my_engine.hpp"

#include <genrender/attention/scaled_dot_product.hpp>
#include <genrender/baselines/per_frame.hpp>
#include <genrender/guidance/rasterizer.hpp>
#include <genrender/injection/feature_io.hpp>
#include <genrender/injection/post_attention.hpp>
#include <genrender/pipeline/render.hpp>
#include <genrender/sampling/preconditioning.hpp>

#include <cstdio>
#include <exception>

using namespace genrender;
using my_tensor = my_engine::tensor;

// The door: how the library looks into the engine's tensors. It lies in the engine's namespace and copies nothing.
namespace my_engine {
strided_view<float, 3> to_view(tensor const& t) { return {t.memory.get(), t.sizes, t.strides}; }
} // namespace my_engine

// What both ways share: what the network is, and the way of latents through it. Prompts, depth and guidance are its
// own.
struct my_denoiser {
    using real_type = float;
    using features_type = my_tensor;
    static constexpr grid_extents grid{8, 8};
    my_engine::network net;
    std::array<attention_site, 2> modules{
        {{"down.attn1", network_kind::denoiser, network_part::encoder, grid, net.channels},
         {"up.attn1", network_kind::denoiser, network_part::decoder, grid, net.channels}}};
    std::size_t latent_channels() const { return net.latent_channels; }
    grid_extents latent_grid() const { return grid; }
    std::span<attention_site const> sites() const { return modules; }
    std::size_t branches() const { return net.prompts; }

    // D(z, sigma) of a network that predicts v; run(place, f) runs a self-attention module.
    template <class Run>
    void denoise(strided_view<float, 4> x0, strided_view<float const, 4> z, float sigma, Run const& run) const {
        my_tensor latents(z.extent(0), grid.size(), z.extent(1));
        copy(channels_first(latents), z);
        auto const v = net(latents, sigma, [&](std::uint32_t prompt, std::uint32_t module, my_tensor const& f) {
            return run(attention_place{{module}, prompt}, f);
        });
        to_clean(x0, prediction::velocity, z, channels_first(v), sigma);
    }
    static strided_view<float, 4> channels_first(my_tensor const& t) {
        auto const [frame, token, channel] = t.strides;
        return {t.memory.get(), {t.sizes[0], t.sizes[2], grid.height, grid.width},
                {frame, channel, token * std::ptrdiff_t{grid.width}, token}};
    }
};

// First way in: at each site the engine calls back, and lends the processor its operations. Where it has none of its
// own, as here for attention and mixing, the library's kernels run on views of its memory.
struct my_call {
    using features_type = my_tensor;
    using real_type = float;
    my_engine::self_attention const& module;
    attention_place site;
    std::span<frame_index const> stack;
    my_tensor input;
    attention_place place() const { return site; }
    std::span<frame_index const> frames() const { return stack; }
    my_tensor f() const { return input; }
    my_tensor query(my_tensor const& f) const { return module.query(f); }
    my_tensor key(my_tensor const& f) const { return module.key(f); }
    my_tensor value(my_tensor const& f) const { return module.value(f); }
    my_tensor attend(my_tensor const& Q, attention_sources<my_tensor> const& sources) const {
        my_tensor F(Q.sizes[0], Q.sizes[1], Q.sizes[2]);
        for (std::size_t i = 0; i < sources.size(); ++i) {
            std::vector<key_value_view<float>> blocks;
            for (auto const& block : sources[i]) {
                blocks.push_back({to_view(*block.K)[block.frame], to_view(*block.V)[block.frame]});
            }
            scaled_dot_product(to_view(F)[i], to_view(Q)[i], blocks, 1);
        }
        return F;
    }
    my_tensor mix(my_tensor const& F, my_tensor const& F_KF, std::span<sparse_rows<float> const> rows,
                  float alpha) const {
        for (std::size_t i = 0; i < rows.size(); ++i) {
            post_attention(to_view(F)[i], F_KF, rows[i], alpha);
        }
        return F;
    }
};

struct calling_denoiser : my_denoiser {
    template <attention_processor<my_call> Processor>
    void operator()(strided_view<float, 4> x0, strided_view<float const, 4> z, float sigma,
                    std::span<frame_index const> frames, Processor& processor) const {
        denoise(x0, z, sigma, [&](attention_place place, my_tensor const& f) {
            my_call call{net.modules[place.site.value], place, frames, f};
            return processor(call);
        });
    }
};

// Second way in: nothing can be called from within a static graph. It takes extra inputs and gives extra outputs
// instead.
struct graph_denoiser : my_denoiser {
    template <feature_io_processor<my_tensor, float> Processor>
    void operator()(strided_view<float, 4> x0, strided_view<float const, 4> z, float sigma,
                    std::span<frame_index const> frames, Processor& processor) const {
        std::map<attention_place, feature_inputs<my_tensor, float>> inputs;
        std::map<attention_place, std::array<my_tensor, 2>> outputs;
        for (std::uint32_t site = 0; site < modules.size(); ++site) {
            for (std::uint32_t branch = 0; branch < branches(); ++branch) {
                attention_place const place{{site}, branch};
                inputs[place] = inputs_at<my_tensor, float>(processor, place, frames);
            }
        }
        denoise(x0, z, sigma, [&](attention_place place, my_tensor const& f) {
            outputs[place] = {f, module_of_graph(net.modules[place.site.value], f, inputs.at(place))};
            return outputs[place][1];
        });
        for (auto const& [place, f_and_F] : outputs) {
            if (inputs.at(place).is_recorded) {
                record_features(processor, place, f_and_F[0], f_and_F[1]);
            }
        }
    }

    // A self-attention module as it is built into the graph, of the engine's operations alone.
    static my_tensor module_of_graph(my_engine::self_attention const& module, my_tensor const& f,
                                     feature_inputs<my_tensor, float> const& in) {
        my_engine::key_values const own{module.key(f), module.value(f)};
        my_engine::key_values joined;
        if (in.f_KF != nullptr) {
            joined = {module.key(*in.f_KF), module.value(*in.f_KF)};
        }
        my_engine::attention_lists lists(f.sizes[0]);
        for (std::size_t i = 0; i < lists.size(); ++i) {
            for (std::size_t j = 0; j < lists.size(); ++j) { // eq. 1, or eq. 3 over the whole stack
                if (j == i || in.attends_to_stack) {
                    lists[i].push_back({own, j});
                }
            }
            for (std::size_t k = 0; k < joined.K.sizes[0]; ++k) { // eq. 5
                if (k != in.left_out[i]) {
                    lists[i].push_back({joined, k});
                }
            }
        }
        auto F = attend(module.query(f), lists);
        for (std::size_t i = 0; i < in.rows.size(); ++i) { // eq. 6
            mix_gathered(F, i, *in.F_KF, in.rows[i].offsets, in.rows[i].sources, in.rows[i].weights, in.alpha);
        }
        return F;
    }
};

static_assert(attention_call<my_call> && denoiser<calling_denoiser> && denoiser<graph_denoiser>);

int main() try {
    auto const guidance = rasterize(scenes::camera_rotation(5, 0.6f), {64, 64});
    auto const UV = to_uv_view(guidance.uv);
    render_settings<float> settings;
    settings.steps = 4;
    settings.keyframes.count = 3;
    render_report report;
    auto const called = render(calling_denoiser{}, UV, settings, report);
    auto const graphed = render(graph_denoiser{}, UV, settings, report);
    auto const alone = render(calling_denoiser{}, UV, per_frame(settings, noise_kind::uv), report);

    float difference = 0;
    float effect = 0;
    for (std::size_t e = 0; e < called.size(); ++e) {
        difference = std::max(difference, std::abs(called.data()[e] - graphed.data()[e]));
        effect = std::max(effect, std::abs(called.data()[e] - alone.data()[e]));
    }
    std::printf("Latents move by up to %.2f with injection, and differ by %.1e between the two ways in.\n", effect,
                difference);
    require_value(difference <= 1e-5f && effect > 0.01f, "your_own_denoiser", "difference", difference,
                  "at most 1e-5, at frames that injection changes");
} catch (std::exception const& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
}
