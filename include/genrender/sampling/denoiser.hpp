// SPDX-License-Identifier: MIT
// [GR alg. 1: Phi] The front door of networks: estimates clean latents of a stack of frames.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/attention/attention_processor.hpp>
#include <genrender/core/index.hpp>
#include <genrender/core/strided_view.hpp>

#include <concepts>
#include <cstddef>
#include <ranges>
#include <span>

namespace genrender {

/// Estimates the clean latents of a stack of frames at a noise level, running the processor it is given at each of its
/// self-attention sites. Phi of the paper; it owns its conditioning (prompt, depth maps, guidance scale) and looks it
/// up by frame_index.
///
/// expression                             | type            | meaning
/// ---------------------------------------|-----------------|----------------------------------------------------------
/// `typename Phi::real_type`              | float or double | scalar of the latents
/// `typename Phi::features_type`          | copyable        | its engine's handle of features, see attention_call
/// `phi.latent_channels()`                | size_t          | channels of z
/// `phi.latent_grid()`                    | grid_extents    | height and width of z
/// `phi.sites()`                          | attention_sites | its self-attention modules, a random access range;
///                                        |                 | attention_place::site counts in this order
/// `phi.branches()`                       | size_t          | guidance branches it runs: 1, or 2 with classifier-free
///                                        |                 | guidance
/// `phi(x0, z, sigma, frames, processor)` | void            | writes D(z, sigma) [EDM sec. 3], the estimate of the
///                                        |                 | clean latents, into x0; x0 and z are [frames, channels,
///                                        |                 | height, width]; `frames[i]` says which frame of the
///                                        |                 | animation entry i is; z = clean + sigma * noise
///
/// These the compiler cannot check, and a model owes them (tests/support/denoiser_laws.hpp checks them):
/// every site is run once per branch and call, with all frames of the stack at once; with plain_attention the estimate
/// of a frame does not depend on the other frames of the stack; equal arguments give equal results; z is not changed;
/// calls for different frames may run at the same time on several threads if the caller uses more than one.
/// It does not require to be a neural network, to be differentiable, or to know of keyframes, noise or textures.
///
/// See also: attention_processor, what it runs; sequence_denoiser, which turns it into a denoiser of whole animations.
template <class Phi>
concept denoiser = std::floating_point<typename Phi::real_type> && std::copyable<typename Phi::features_type> &&
    requires(Phi const& phi, strided_view<typename Phi::real_type, 4> x0,
             strided_view<typename Phi::real_type const, 4> z, typename Phi::real_type sigma,
             std::span<frame_index const> frames, attention_processor_archetype& processor) {
    { phi.latent_channels() } -> std::convertible_to<std::size_t>;
    { phi.latent_grid() } -> std::convertible_to<grid_extents>;
    { phi.sites() } -> std::ranges::random_access_range;
    { phi.branches() } -> std::convertible_to<std::size_t>;
    phi(x0, z, sigma, frames, processor);
};

/// Fails to compile with a sentence for each part that a denoiser lacks.
template <class Phi>
consteval void require_denoiser() {
    static_assert(
        requires {
            requires std::floating_point<typename Phi::real_type>;
            requires std::copyable<typename Phi::features_type>;
        },
        "denoiser: real_type is float or double and features_type is copyable");
    static_assert(
        requires(Phi const& phi) {
            { phi.latent_channels() } -> std::convertible_to<std::size_t>;
            { phi.latent_grid() } -> std::convertible_to<grid_extents>;
        },
        "denoiser: latent_channels() is const and returns a number, latent_grid() is const and returns grid_extents");
    static_assert(
        requires(Phi const& phi) {
            { phi.sites() } -> std::ranges::random_access_range;
        },
        "denoiser: sites() is const and returns a random access range of attention_site");
    static_assert(
        requires(Phi const& phi) {
            { phi.branches() } -> std::convertible_to<std::size_t>;
        },
        "denoiser: branches() is const and returns the number of guidance branches");
    static_assert(
        requires(Phi const& phi, strided_view<typename Phi::real_type, 4> x0,
                 strided_view<typename Phi::real_type const, 4> z, typename Phi::real_type sigma,
                 std::span<frame_index const> frames,
                 attention_processor_archetype& processor) { phi(x0, z, sigma, frames, processor); },
        "denoiser: operator()(x0, z, sigma, frames, processor) is const, takes x0 as strided_view<real_type, 4>, z as "
        "strided_view<real_type const, 4>, and is a template for every processor");
}

/// The least that a denoiser is, for checking what takes one; never run.
template <class Real, class Features>
struct denoiser_archetype {
    using real_type = Real;
    using features_type = Features;
    std::size_t latent_channels() const;
    grid_extents latent_grid() const;
    std::span<attention_site const> sites() const;
    std::size_t branches() const;
    template <class Processor>
        requires attention_processor<Processor, attention_call_archetype<Features, Real>>
    void operator()(strided_view<Real, 4> x0, strided_view<Real const, 4> z, Real sigma,
                    std::span<frame_index const> frames, Processor& processor) const;
};

} // namespace genrender

#include <genrender/core/end_header.inl>
