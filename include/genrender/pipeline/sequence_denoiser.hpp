// SPDX-License-Identifier: MIT
// [GR alg. 1: the body of the loop] A denoiser of single frames becomes a denoiser of the whole animation.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/finite.hpp>
#include <genrender/core/tensor.hpp>
#include <genrender/maps/background_mask.hpp>
#include <genrender/normalization/latent_normalizer.hpp>
#include <genrender/pipeline/estimate_consensus.hpp>
#include <genrender/pipeline/generative_rendering.hpp>
#include <genrender/pipeline/pass_latents.hpp>
#include <genrender/pipeline/sequence_passes.hpp>
#include <genrender/pipeline/sequence_method.hpp>

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <type_traits>
#include <utility>

namespace genrender {

/// The diffusion step at a noise level: the step i with sigmas[i] >= sigma > sigmas[i + 1]. A second evaluation within
/// a step, such as Heun's, thereby counts to the step that begins at its own level.
template <class Real>
std::size_t step_at(std::span<Real const> sigmas, std::type_identity_t<Real> sigma) {
    std::size_t step = 0;
    while (step + 2 < sigmas.size() && sigmas[step + 1] >= sigma) {
        ++step;
    }
    return step;
}

/// D(z, sigma) of a whole animation: a method's estimates of all frames, in consensus and normalised where settings say
/// so. Any sampler drives it; it keeps nothing from one evaluation to the next, and what it draws depends on the seed and
/// the noise level alone.
template <denoiser Phi, correspondence_map Map,
          sequence_method<sequence_passes<Phi, Map>> Method = generative_rendering>
class sequence_denoiser {
public:
    using real_type = typename Phi::real_type;         ///< scalar of the latents
    using features_type = typename Phi::features_type; ///< the engine's handle of features
    using latents_type = run_latents<Phi>;             ///< z and x0, in host memory or lent

    /// `sigmas` are the run's noise levels; `background` and `shares` [frames, height, width] of the latents, the latter
    /// those of cell_shares for a consensus that fades at silhouettes, else nothing. Everything but the method is referred
    /// to and must outlive the sequence denoiser.
    sequence_denoiser(Phi const& phi, correspondence_set<Map> const& maps,
                      strided_view<std::uint8_t const, 3> background, std::span<real_type const> sigmas,
                      render_settings<real_type> const& settings, any_loop loop, progress_meter& meter,
                      report_writer& report, Method method = {}, strided_view<std::uint8_t const, 3> shares = {})
        : run_{&phi, &maps, &settings, std::move(loop), &meter, &report}, normalizer_(phi, background), shares_(shares),
          open_background_(has_background_consensus(settings)
                               ? open_background(background, settings.consensus.background_distance)
                               : tensor<std::uint8_t, 3>()),
          sigmas_(sigmas), method_(std::move(method)) {}

    /// The clean estimates of all frames of z [frames, channels, height, width] at noise level sigmas[step]; a second
    /// evaluation within a step, such as Heun's, is one of the step that begins at its level. Throws value_error if an
    /// estimate is not finite, cancelled if the observer says so, and what the denoiser throws.
    latents_type operator()(latents_type const& z, real_type sigma, std::size_t step) const {
        auto x0 = estimates_for(z);
        method_(sequence_passes<Phi, Map>(run_, x0, z, sigma, step));
        require_finite(x0, step);
        if (has_consensus(*run_.settings, step)) { // In host memory: no engine lends it.
            on_host(x0, [&](strided_view<real_type, 4> estimates) {
                reach_consensus(run_, estimates, {shares_, to_view(open_background_)}, step);
            });
        }
        auto const& normalization = run_.settings->normalization;
        if (!normalization.on_noisy_latents) {
            normalize(x0, step);
        }
        return x0;
    }

    /// The same for samplers that do not tell the step, which is looked up by sigma.
    latents_type operator()(latents_type const& z, real_type sigma) const {
        return (*this)(z, sigma, step_at(sigmas_, sigma));
    }

    /// What the settings ask of the noisy latents after a step of the sampler: normalisation in place, where it is
    /// theirs and not that of the clean estimates.
    void after_step(std::size_t step, latents_type& z) const {
        if (run_.settings->normalization.on_noisy_latents) {
            normalize(z, step);
        }
    }

private:
    /// Normalises latents of the whole sequence in place where the settings' window holds `step` [GR sec. 3.4].
    void normalize(latents_type& z, std::size_t step) const {
        using clock = std::chrono::steady_clock;
        auto const& normalization = run_.settings->normalization;
        if (normalization.enabled &&
            is_in_window(step, run_.settings->steps, normalization.window_begin, normalization.window_end)) {
            auto const start = clock::now();
            run_.report->add_skipped(normalizer_(z, normalization));
            run_.report->add_seconds(0, std::chrono::duration<double>(clock::now() - start).count());
        }
    }

    /// Refuses estimates that would poison every later step. Those that are lent are downloaded for the sentence alone.
    void require_finite(latents_type const& x0, std::size_t step) const {
        if constexpr (latent_lender<Phi>) {
            if (!run_.phi->all_finite(x0.handle())) {
                auto refused = x0;
                refused.on_host([&](strided_view<real_type const, 4> view) { require_finite_elements(view, step); });
            }
        } else {
            require_finite_elements(to_view(x0), step);
        }
    }
    static void require_finite_elements(strided_view<real_type const, 4> x0, std::size_t step) {
        auto const values = x0.size() / x0.extent(0);
        for (std::size_t i = 0; i < x0.size(); ++i) {
            if (!is_finite(x0.data()[i])) {
                throw value_error("sequence_denoiser: the denoiser's estimate of frame " + std::to_string(i / values) +
                                  " in step " + std::to_string(step) + " is " + std::to_string(x0.data()[i]) +
                                  ", expected finite latents");
            }
        }
    }

    sequence_run<Phi, Map> run_;
    latent_normalizer<Phi> normalizer_;
    strided_view<std::uint8_t const, 3> shares_;
    tensor<std::uint8_t, 3> open_background_;
    std::span<real_type const> sigmas_;
    Method method_;
};

} // namespace genrender

#include <genrender/core/end_header.inl>
