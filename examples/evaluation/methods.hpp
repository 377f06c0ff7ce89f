// SPDX-License-Identifier: MIT
// [GR sec. 4, tables 1 and 2, fig. 6] Every method, baseline and ablation that is compared, as one list.
#pragma once

#include <genrender/baselines/baseline_settings.hpp>
#include <genrender/baselines/per_frame.hpp>
#include <genrender/baselines/pix2video.hpp>
#include <genrender/baselines/tokenflow.hpp>
#include <genrender/core/tensor.hpp>
#include <genrender/guidance/uv_maps_view.hpp>
#include <genrender/pipeline/render.hpp>

#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace genrender::examples {

/// One row of the tables.
template <class Network>
struct compared_method {
    std::string name;  ///< as the paper writes it
    std::string noise; ///< UV, fixed or independent
    std::string group; ///< method, noise or ablation
    /// The clean latents of all frames for the settings that all methods share.
    std::function<latents<float>(Network const&, uv_maps_view const&, render_settings<float>)> run;
};

/// The name of a kind of noise in the tables.
inline std::string noise_name(noise_kind kind) {
    return kind == noise_kind::uv ? "UV" : kind == noise_kind::fixed ? "fixed" : "independent";
}

/// The paper's methods as it runs them, then every baseline with our method's noise, then the ablations. What they
/// share, a caller sets: seeds, steps, sampler, keyframes and layers.
template <class Network>
std::vector<compared_method<Network>> compared_methods() {
    using settings_type = render_settings<float>;
    std::vector<compared_method<Network>> methods;
    auto const run = [](auto const& method, Network const& phi, uv_maps_view const& UV, settings_type const& settings) {
        render_report report;
        return render(method, phi, UV, settings, report);
    };
    auto const add_frame_by_frame = [&](std::string group, noise_kind noise) {
        methods.push_back({"Per-Frame", noise_name(noise), std::move(group),
                           [run, noise](Network const& phi, uv_maps_view const& UV, settings_type settings) {
                               settings = per_frame(settings);
                               settings.noise.kind = noise;
                               return run(generative_rendering{}, phi, UV, settings);
                           }});
    };
    auto const add_baseline = [&](std::string name, std::string group, noise_kind noise, auto method) {
        methods.push_back({std::move(name), noise_name(noise), std::move(group),
                           [run, noise, method](Network const& phi, uv_maps_view const& UV,
                                                settings_type const& settings) {
                               return run(method, phi, UV, baseline_settings(settings, noise));
                           }});
    };
    auto const add_ours = [&](std::string name, std::string group, noise_kind noise, auto change) {
        methods.push_back({std::move(name), noise_name(noise), std::move(group),
                           [run, noise, change](Network const& phi, uv_maps_view const& UV, settings_type settings) {
                               settings.noise.kind = noise;
                               change(settings);
                               return run(generative_rendering{}, phi, UV, settings);
                           }});
    };
    auto const as_it_is = [](settings_type&) {};

    add_frame_by_frame("method", noise_kind::independent);
    add_baseline("Pix2Video*", "method", noise_kind::fixed, pix2video{});
    add_baseline("TokenFlow*", "method", noise_kind::fixed, tokenflow{});
    add_ours("Ours", "method", noise_kind::uv, as_it_is);

    add_frame_by_frame("noise", noise_kind::fixed);
    add_frame_by_frame("noise", noise_kind::uv);
    add_baseline("Pix2Video*", "noise", noise_kind::uv, pix2video{});
    add_baseline("TokenFlow*", "noise", noise_kind::uv, tokenflow{});

    add_ours("No pre-attention", "ablation", noise_kind::uv,
             [](settings_type& settings) { settings.pre_attention = false; });
    add_ours("No post-attention", "ablation", noise_kind::uv,
             [](settings_type& settings) { settings.post_attention = false; });
    add_ours("Ours", "ablation", noise_kind::fixed, as_it_is);
    add_ours("Ours", "ablation", noise_kind::independent, as_it_is);
    add_ours("No AdaIN", "ablation", noise_kind::uv,
             [](settings_type& settings) { settings.normalization.enabled = false; });
    return methods;
}

} // namespace genrender::examples
