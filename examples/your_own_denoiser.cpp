// SPDX-License-Identifier: MIT
// Your own engine behind genrender, wired both ways: called back at each self-attention site, or as a static graph.
#include "scenes/camera_rotation.hpp"
#include "support/my_denoiser.hpp" // What the engine is, whichever way it is wired.

#include <genrender/attention/scaled_dot_product.hpp>
#include <genrender/baselines/per_frame.hpp>
#include <genrender/scene/rasterizer.hpp>
#include <genrender/injection/feature_io.hpp>
#include <genrender/injection/post_attention.hpp>
#include <genrender/pipeline/render.hpp>

#include <cstdio>
#include <exception>

using namespace genrender;
using examples::my_denoiser;
using my_tensor = my_engine::tensor;

// First way in: at each site the engine calls back, and lends the processor its operations. Where it has none of its
// own, as here for attention and mixing, the library's kernels run on views of its memory.
// docs:begin my_call
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
// docs:end

// docs:begin calling_denoiser
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
// docs:end

// Second way in: nothing can be called from within a static graph. It takes extra inputs and gives extra outputs
// instead.
// docs:begin graph_denoiser
struct graph_denoiser : my_denoiser {
    template <feature_io_processor<my_tensor, float> Processor>
    void operator()(strided_view<float, 4> x0, strided_view<float const, 4> z, float sigma,
                    std::span<frame_index const> frames, Processor& processor) const {
        // Before: everything that the processor wants is known by now.
        std::map<attention_place, feature_inputs<my_tensor, float>> inputs;
        std::map<attention_place, std::array<my_tensor, 2>> outputs;
        for (std::uint32_t site = 0; site < modules.size(); ++site) {
            for (std::uint32_t branch = 0; branch < branches(); ++branch) {
                attention_place const place{{site}, branch};
                inputs[place] = inputs_at<my_tensor, float>(processor, place, frames);
            }
        }
        denoise(x0, z, sigma, [&](attention_place place, my_tensor const& f) {
            outputs[place] = {f,
                              my_engine::self_attention_of_graph(net.modules[place.site.value], f, inputs.at(place))};
            return outputs[place][1];
        });
        // After: the keyframes' features, as the engine's own tensors.
        for (auto const& [place, f_and_F] : outputs) {
            if (inputs.at(place).is_recorded) {
                record_features(processor, place, f_and_F[0], f_and_F[1]);
            }
        }
    }
};
// docs:end

static_assert(attention_call<my_call> && denoiser<calling_denoiser> && denoiser<graph_denoiser>);

int main() try {
    auto const guidance = rasterize(scenes::camera_rotation(5, 0.6f), {64, 64});
    auto const UV = to_uv_view(guidance.uv);
    render_settings<float> settings;
    settings.steps = 4;
    settings.keyframes.count = 3;
    auto const called = render(calling_denoiser{}, UV, {.settings = settings}).z;
    auto const graphed = render(graph_denoiser{}, UV, {.settings = settings}).z;
    auto const alone = render(calling_denoiser{}, UV, {.settings = per_frame(settings, noise_kind::uv)}).z;

    float difference = 0;
    float effect = 0;
    for (std::size_t e = 0; e < called.size(); ++e) {
        difference = std::max(difference, std::abs(called.data()[e] - graphed.data()[e]));
        effect = std::max(effect, std::abs(called.data()[e] - alone.data()[e]));
    }
    std::printf("Latents move by up to %.2f with injection, and differ by %.1e between the two ways in.\n", effect,
                difference);
    require_value(difference <= 1e-5f && effect > 0.01f, "your_own_denoiser", "difference", difference, "at most 1e-5");
} catch (std::exception const& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
}
