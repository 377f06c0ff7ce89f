// SPDX-License-Identifier: MIT
// [GR sec. 4, tables 1 and 2, fig. 6] Every method, baseline and ablation that is compared, as one list.
#pragma once

#include <genrender/baselines/baseline_settings.hpp>
#include <genrender/baselines/per_frame.hpp>
#include <genrender/baselines/pix2video.hpp>
#include <genrender/baselines/tokenflow.hpp>
#include <genrender/core/tensor.hpp>
#include <genrender/maps/uv_maps_view.hpp>
#include <genrender/pipeline/render.hpp>

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace genrender::examples {

/// One row of the tables.
template <class Network>
struct compared_method {
    std::string name;  ///< as the paper writes it
    std::string noise; ///< UV, fixed or independent
    std::string group; ///< method, noise, ablation or correspondence
    /// The clean latents of all frames for the settings that all methods share.
    std::function<latents<float>(Network const&, uv_maps_view const&, render_settings<float>)> run;
};

/// The name of a kind of noise in the tables.
inline std::string noise_name(noise_kind kind) {
    return kind == noise_kind::uv ? "UV" : kind == noise_kind::fixed ? "fixed" : "independent";
}

/// The groups of compared_methods that the paper's comparison holds.
inline std::vector<std::string> paper_groups() { return {"method", "noise", "ablation"}; }

/// The paper's methods as it runs them, then every baseline with our method's noise, then the ablations, then the
/// literal texels of features and of noise that the library's own correspondence and noise replace. What they share, a
/// caller sets: seeds, steps, sampler, keyframes and layers.
template <class Network>
std::vector<compared_method<Network>> compared_methods() {
    using settings_type = render_settings<float>;
    std::vector<compared_method<Network>> methods;
    auto const run = [](auto const& method, Network const& phi, uv_maps_view const& UV, settings_type const& settings) {
        return render<std::remove_cvref_t<decltype(method)>>(phi, UV, {.settings = settings, .method = method}).z;
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
        methods.push_back(
            {std::move(name), noise_name(noise), std::move(group),
             [run, noise, method](Network const& phi, uv_maps_view const& UV, settings_type const& settings) {
                 return run(method, phi, UV, baseline_settings(settings, noise));
             }});
    };
    auto const add_ours = [&](std::string name, std::string group, noise_kind noise, auto change) {
        methods.push_back({std::move(name), noise_name(noise), std::move(group),
                           [run, noise, change](Network const& phi, uv_maps_view const& UV, settings_type settings) {
                               settings.noise.kind = noise;
                               // The paper's, which is not the default.
                               settings.normalization.statistics = adain_statistics::mean_and_deviation;
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
             [](settings_type& settings) { settings.injection.pre_attention = false; });
    add_ours("No post-attention", "ablation", noise_kind::uv,
             [](settings_type& settings) { settings.injection.post_attention = false; });
    add_ours("Ours", "ablation", noise_kind::fixed, as_it_is);
    add_ours("Ours", "ablation", noise_kind::independent, as_it_is);
    add_ours("No AdaIN", "ablation", noise_kind::uv,
             [](settings_type& settings) { settings.normalization.enabled = false; });
    add_ours("AdaIN of means alone", "ablation", noise_kind::uv,
             [](settings_type& settings) { settings.normalization.statistics = adain_statistics::mean; });

    auto const add_variant = [&](std::string name, std::string noise, auto change) {
        add_ours(std::move(name), "correspondence", noise_kind::uv, change);
        methods.back().noise = std::move(noise);
    };
    auto const by_texels = [](settings_type& settings, std::size_t T) {
        settings.correspondence.kind = correspondence_kind::texel_grid;
        settings.correspondence.texels.T = T > 0 ? std::optional(T) : std::nullopt;
    };
    auto const read_noise = [](settings_type& settings, noise_reading reading, std::size_t T) {
        settings.noise.reading = reading;
        settings.noise.T = T > 0 ? std::optional(T) : std::nullopt;
    };
    for (std::size_t const T : {64U, 256U, 1024U, 4096U}) {
        add_variant("Texels " + std::to_string(T), "UV",
                    [by_texels, T](settings_type& settings) { by_texels(settings, T); });
    }
    for (std::size_t const T : {64U, 256U, 1024U, 4096U}) {
        add_variant("Ours", "nearest " + std::to_string(T), [read_noise, T](settings_type& settings) {
            read_noise(settings, noise_reading::nearest_texel, T);
        });
    }
    add_variant("Ours", "bilinear matched",
                [read_noise](settings_type& settings) { read_noise(settings, noise_reading::bilinear_texel, 0); });
    add_variant("Texels matched", "nearest matched", [by_texels, read_noise](settings_type& settings) {
        by_texels(settings, 0);
        read_noise(settings, noise_reading::nearest_texel, 0);
    });
    add_variant("Plain average", "UV", [](settings_type& settings) { settings.average = texel_average::plain; });
    return methods;
}

} // namespace genrender::examples
