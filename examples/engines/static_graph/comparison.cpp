// SPDX-License-Identifier: MIT
// The library's side: the small network in plain loops, called back at each module, compiled once and without an engine.
#include "comparison.hpp"
#include "network.hpp"

#include "../../scenes/camera_rotation.hpp"
#include "../measures.hpp"

#include <genrender/injection/host_attention_call.hpp>
#include <genrender/pipeline/render.hpp>
#include <genrender/sampling/preconditioning.hpp>
#include <genrender/scene/rasterizer.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <utility>

namespace genrender::examples {

namespace {

using tensor3 = stack<float, 3>; // [frames, tokens, channels]

/// out[t] = W f[t] of the tokens of one frame.
void multiply(strided_view<float, 2> out, layer_weights const& w, strided_view<float const, 2> f) {
    for (std::size_t t = 0; t < out.extent(0); ++t) {
        for (std::size_t o = 0; o < w.outputs; ++o) {
            float sum = 0;
            for (std::size_t i = 0; i < w.inputs; ++i) {
                sum += w.values[o * w.inputs + i] * f(t, i);
            }
            out(t, o) = sum;
        }
    }
}

struct block_projections {
    small_unet::block const& of;
    void query(strided_view<float, 2> out, strided_view<float const, 2> f) const { multiply(out, of.query, f); }
    void key(strided_view<float, 2> out, strided_view<float const, 2> f) const { multiply(out, of.key, f); }
    void value(strided_view<float, 2> out, strided_view<float const, 2> f) const { multiply(out, of.value, f); }
    std::size_t heads() const { return small_unet::heads; }
};

/// The operations in plain loops; `run(site, block, f)` is a self-attention module.
template <class Attention>
struct plain_loops {
    Attention const& run;

    tensor3 linear(layer_weights const& w, tensor3 const& x) const {
        tensor3 y({x.extent(0), x.extent(1), w.outputs});
        for (std::size_t i = 0; i < x.extent(0); ++i) {
            multiply(y.view()[i], w, x.view()[i]);
        }
        return y;
    }
    tensor3 add(tensor3 const& a, tensor3 const& b) const {
        tensor3 y = a;
        for (std::size_t e = 0; e < y.size(); ++e) {
            y.data()[e] += b.data()[e % b.size()];
        }
        return y;
    }
    tensor3 silu(tensor3 x) const {
        std::for_each(x.data(), x.data() + x.size(), [](float& v) { v /= 1 + std::exp(-v); });
        return x;
    }
    tensor3 normalized(tensor3 x) const {
        auto const channels = x.extent(2);
        for (auto* token = x.data(); token != x.data() + x.size(); token += channels) {
            double mean = 0;
            double square = 0;
            std::for_each(token, token + channels, [&](float v) { mean += v / static_cast<double>(channels); });
            std::for_each(token, token + channels, [&](float v) { square += (v - mean) * (v - mean); });
            auto const scale = 1 / std::sqrt(square / static_cast<double>(channels) + small_unet::epsilon);
            std::for_each(token, token + channels, [&](float& v) { v = static_cast<float>((v - mean) * scale); });
        }
        return x;
    }
    tensor3 pooled(tensor3 const& x, grid_extents from) const {
        tensor3 y({x.extent(0), x.extent(1) / 4, x.extent(2)});
        each_pair(from, x.extent(0), x.extent(2),
                  [&](auto i, auto fine, auto cell, auto c) { y(i, cell, c) += x(i, fine, c) / 4; });
        return y;
    }
    tensor3 enlarged(tensor3 const& x, grid_extents from) const {
        tensor3 y({x.extent(0), x.extent(1) * 4, x.extent(2)});
        each_pair({2 * from.height, 2 * from.width}, x.extent(0), x.extent(2),
                  [&](auto i, auto fine, auto cell, auto c) { y(i, fine, c) = x(i, cell, c); });
        return y;
    }
    tensor3 attention(site_index site, small_unet::block const& block, tensor3 f) const { return run(site, block, f); }

    template <class Body>
    static void each_pair(grid_extents fine, std::size_t frames, std::size_t channels, Body const& body) {
        for (std::size_t i = 0; i < frames; ++i) {
            for (std::size_t t = 0; t < fine.size(); ++t) {
                auto const cell = t / fine.width / 2 * (fine.width / 2) + t % fine.width / 2;
                for (std::size_t c = 0; c < channels; ++c) {
                    body(i, t, cell, c);
                }
            }
        }
    }
};

struct called_back {
    using real_type = float;
    using features_type = host_features<float>;
    small_unet net;
    std::size_t latent_channels() const { return small_unet::latent_channels; }
    grid_extents latent_grid() const { return small_unet::grid; }
    auto const& sites() const { return net.sites; }
    std::size_t branches() const { return small_unet::prompts; }

    template <class Processor>
    void operator()(strided_view<float, 4> x0, strided_view<float const, 4> z, float sigma,
                    std::span<frame_index const> frames, Processor& processor) const {
        auto const c_in = scalings_of(prediction::velocity, sigma).c_in;
        tensor3 tokens({frames.size(), small_unet::grid.size(), small_unet::latent_channels});
        latents<float> v =
            xt::zeros<float>(std::array<std::size_t, 4>{z.extent(0), z.extent(1), z.extent(2), z.extent(3)});
        for (std::uint32_t prompt = 0; prompt < branches(); ++prompt) {
            auto const attend = [&](site_index site, small_unet::block const& block, tensor3& f) {
                block_projections const module{block};
                host_attention_call<float, block_projections> call({site, prompt}, frames,
                                                                   host_features<float>(f.view()), module);
                tensor3 F(f.extents());
                copy(F.view(), strided_view<float const, 3>(processor(call).view()));
                return F;
            };
            plain_loops<decltype(attend)> ops{attend};
            each_latent(tokens, z, [&](float& token, float latent) { token = c_in * latent; });
            tensor3 shift({1, 1, small_unet::channels});
            std::ranges::copy(small_unet::shift(sigma, prompt), shift.data());
            each_latent(net(ops, tokens, shift), to_view(v), [](float token, float& latent) { latent += token / 2; });
        }
        to_clean(x0, prediction::velocity, z, to_view(v), sigma);
    }

    /// body(element of [frames, tokens, channels], the same of [frames, channels, height, width]).
    template <class Latents, class Body>
    static void each_latent(auto&& tokens, Latents const& z, Body const& body) {
        for (std::size_t i = 0; i < z.extent(0); ++i) {
            for (std::size_t c = 0; c < z.extent(1); ++c) {
                for (std::size_t t = 0; t < z.extent(2) * z.extent(3); ++t) {
                    body(tokens(i, t, c), z(i, c, t / z.extent(3), t % z.extent(3)));
                }
            }
        }
    }
};

} // namespace

int compare_graphs(std::string const& engine, std::function<graph_frames(graph_case const&)> const& run) {
    try {
        graph_case given{rasterize(scenes::camera_rotation(7, 0.6f), {64, 64}).uv, {}};
        given.settings.steps = 6;
        given.settings.keyframes.count = 3;
        given.settings.frames_per_call = 3;
        given.settings.window_end = 0.8f;
        given.settings.injection.keeps_own_copy = false; // takes a mask
        given.settings.noise.seed = 5;
        auto const rendered = [&](render_settings<float> const& settings) {
            return render(called_back{}, to_uv_view(given.UV), {.settings = settings}).z;
        };
        auto plain = given.settings;
        plain.injection.pre_attention = plain.injection.post_attention = false;
        latents<float> reference;
        auto const reference_seconds = seconds_of([&] { reference = rendered(given.settings); });
        auto const effect = difference(rendered(plain), reference);
        graph_frames frames;
        auto const seconds = seconds_of([&] { frames = run(given); });
        auto const apart = difference(frames.z, reference);
        auto const& report = frames.report;
        auto const share = 100 * report.library_seconds / (report.library_seconds + report.denoiser_seconds);
        std::printf("%s | feature I/O | - | - | %.1e | %.2f / %.2f | %.1f %%\n", engine.c_str(), apart, seconds,
                    reference_seconds, share);
        if (!(apart <= 1e-5 && effect >= 1e-2)) {
            std::fprintf(stderr,
                         "latents differ by %g of their range, expected at most 1e-5; injection moves them by %g\n",
                         apart, effect);
            return 1;
        }
        given.settings.injection.length_correction = 1;
        auto const scaled = rendered(given.settings);
        auto const scaled_apart = difference(run(given).z, scaled);
        auto const scaled_effect = difference(reference, scaled);
        if (!(scaled_apart <= 1e-5 && scaled_effect >= 1e-3)) {
            std::fprintf(stderr,
                         "with a length_correction of 1 latents differ by %g of their range, expected at most 1e-5; it "
                         "moves them by %g\n",
                         scaled_apart, scaled_effect);
            return 1;
        }
        return 0;
    } catch (std::exception const& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
}

} // namespace genrender::examples
