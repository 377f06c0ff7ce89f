// SPDX-License-Identifier: MIT
// [GR alg. 1: z] Latents in the memory of the denoiser's engine: what it lends so that they stay there for a whole run.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/attention/attention_processor.hpp>
#include <genrender/core/index.hpp>
#include <genrender/core/strided_view.hpp>
#include <genrender/sampling/denoiser.hpp>

#include <concepts>
#include <span>

namespace genrender {

/// A denoiser that lends its engine's own latents, an optional capability: z and the estimates of a run are handles
/// then, uploaded once when it begins and downloaded once when it ends. Latents of others lie in host memory.
///
/// expression                          | type         | meaning
/// ------------------------------------|--------------|----------------------------------------------------------------
/// `typename Phi::latents_type`        | copyable     | a handle of latents [frames, channels, height, width]
/// `phi.upload(z)`                     | latents_type | the elements of a view in host memory, row-major without gaps,
///                                     |              | which is not read any more when it returns
/// `phi.download(to, z)`               | void         | writes the elements of a handle to such a view of its extents,
///                                     |              | before it returns
/// `phi.frames_of(z, frames)`          | latents_type | the stack whose entry i is entry frames[i] of z, a
///                                     |              | span<frame_index const>; a frame may come more than once
/// `phi.joined(stacks)`                | latents_type | the entries of all stacks, a span<latents_type const>, in order
/// `phi.combination(factors, in)`      | latents_type | factors[0] in[0] + factors[1] in[1] + ..., a span<Real const>
///                                     |              | and a span<latents_type const> of as many of equal extents
/// `phi.all_finite(z)`                 | bool         | whether no element is infinite or not a number
/// `phi(z, sigma, frames, processor)`  | latents_type | D(z, sigma) of a stack, as the call on views estimates it
///
/// A denoiser that names `latents_type` is taken for one, and refused where it lacks an operation. All members are
/// const. A handle stands for values that never change: copies share them, no operation writes into what it was given,
/// and what it gives is written by no other. `frames_of` and calls may run at the same time on several threads where
/// the run's loop has them. The call on views stays (D of `phi.upload(z)`, downloaded); any_denoiser and the C header
/// know no other.
///
/// A stoppable_denoiser that lends takes handles in `run_until`, too, and a residual_lender with `lent`. For latent
/// normalisation see normalizing_lender. The laws: check_latent_lender_laws of testing/latent_lender_laws.hpp.
template <class Phi>
concept latent_lender = denoiser<Phi> && std::copyable<typename Phi::latents_type> &&
    requires(Phi const& phi, typename Phi::latents_type const& z, strided_view<typename Phi::real_type const, 4> from,
             strided_view<typename Phi::real_type, 4> to, std::span<frame_index const> frames,
             std::span<typename Phi::real_type const> factors, std::span<typename Phi::latents_type const> in,
             typename Phi::real_type sigma, attention_processor_archetype& processor) {
    { phi.upload(from) } -> std::convertible_to<typename Phi::latents_type>;
    phi.download(to, z);
    { phi.frames_of(z, frames) } -> std::convertible_to<typename Phi::latents_type>;
    { phi.joined(in) } -> std::convertible_to<typename Phi::latents_type>;
    { phi.combination(factors, in) } -> std::convertible_to<typename Phi::latents_type>;
    { phi.all_finite(z) } -> std::convertible_to<bool>;
    { phi(z, sigma, frames, processor) } -> std::convertible_to<typename Phi::latents_type>;
};

/// A latent_lender that lends what latent normalisation takes, an optional capability: without it the latents are
/// downloaded, normalised by the library and uploaded again in each evaluation that normalises.
///
/// expression                                     | type         | meaning
/// -----------------------------------------------|--------------|-----------------------------------------------------
/// `phi.channel_statistics(mean, deviation, z, w)`| void         | writes the mean and sqrt(unbiased variance + 1e-5) of
///                                                |              | the elements of each frame and channel of z where w is
///                                                |              | 1 into views [frames, channels] of host memory; w is a
///                                                |              | handle [frames, 1, height, width] of 0 and 1, which was
///                                                |              | uploaded. What it writes for frames with fewer than 2
///                                                |              | such pixels is not read
/// `phi.rescaled(z, mean_from, scale, mean_to)`   | latents_type | (z - mean_from) scale + mean_to, each a view [frames,
///                                                |              | channels] of constant elements in host memory, which
///                                                |              | are not read any more when it returns
template <class Phi>
concept normalizing_lender = latent_lender<Phi> &&
    requires(Phi const& phi, typename Phi::latents_type const& z, strided_view<typename Phi::real_type, 2> to,
             strided_view<typename Phi::real_type const, 2> from) {
    phi.channel_statistics(to, to, z, z);
    { phi.rescaled(z, from, from, from) } -> std::convertible_to<typename Phi::latents_type>;
};

namespace detail {

template <class Phi>
concept names_latents = requires {
    typename Phi::latents_type;
};

// One part of the concept each; true where a denoiser lends nothing or its types are wrong, which is told already.
template <class Phi>
concept lender_names_handle = !names_latents<Phi> || std::copyable<typename Phi::latents_type>;
/// Whether a part has to be asked for.
template <class Phi>
concept lends = names_latents<Phi> && denoiser_names_types<Phi> && lender_names_handle<Phi>;
template <class Phi>
concept lender_uploads = !lends<Phi> || requires(Phi const& phi, strided_view<typename Phi::real_type const, 4> from) {
    { phi.upload(from) } -> std::convertible_to<typename Phi::latents_type>;
};
template <class Phi>
concept lender_downloads = !lends<Phi> || requires(Phi const& phi, strided_view<typename Phi::real_type, 4> to,
                                                   typename Phi::latents_type const& z) {
    phi.download(to, z);
};
template <class Phi>
concept lender_gives_frames =
    !lends<Phi> || requires(Phi const& phi, typename Phi::latents_type const& z, std::span<frame_index const> frames) {
    { phi.frames_of(z, frames) } -> std::convertible_to<typename Phi::latents_type>;
};
template <class Phi>
concept lender_joins = !lends<Phi> || requires(Phi const& phi, std::span<typename Phi::latents_type const> in) {
    { phi.joined(in) } -> std::convertible_to<typename Phi::latents_type>;
};
template <class Phi>
concept lender_combines = !lends<Phi> || requires(Phi const& phi, std::span<typename Phi::real_type const> factors,
                                                  std::span<typename Phi::latents_type const> in) {
    { phi.combination(factors, in) } -> std::convertible_to<typename Phi::latents_type>;
};
template <class Phi>
concept lender_tells_finite = !lends<Phi> || requires(Phi const& phi, typename Phi::latents_type const& z) {
    { phi.all_finite(z) } -> std::convertible_to<bool>;
};
template <class Phi>
concept lender_estimates =
    !lends<Phi> || requires(Phi const& phi, typename Phi::latents_type const& z, typename Phi::real_type sigma,
                            std::span<frame_index const> frames, attention_processor_archetype& processor) {
    { phi(z, sigma, frames, processor) } -> std::convertible_to<typename Phi::latents_type>;
};

} // namespace detail

// The sentences, which static_assert takes as literals only.
/// What the compiler says of a denoiser that names latents_type and lacks this.
#define GENRENDER_LENDER_HANDLE "latent_lender: latents_type is copyable"
/// What the compiler says of a denoiser that names latents_type and lacks this.
#define GENRENDER_LENDER_UPLOAD                                                                                        \
    "latent_lender: upload(z) is const, takes strided_view<real_type const, 4> and returns latents_type"
/// What the compiler says of a denoiser that names latents_type and lacks this.
#define GENRENDER_LENDER_DOWNLOAD                                                                                      \
    "latent_lender: download(to, z) is const and takes strided_view<real_type, 4> and latents_type const&"
/// What the compiler says of a denoiser that names latents_type and lacks this.
#define GENRENDER_LENDER_FRAMES                                                                                        \
    "latent_lender: frames_of(z, frames) is const, takes latents_type const& and std::span<frame_index const> and "    \
    "returns latents_type"
/// What the compiler says of a denoiser that names latents_type and lacks this.
#define GENRENDER_LENDER_JOINED                                                                                        \
    "latent_lender: joined(stacks) is const, takes std::span<latents_type const> and returns latents_type"
/// What the compiler says of a denoiser that names latents_type and lacks this.
#define GENRENDER_LENDER_COMBINATION                                                                                   \
    "latent_lender: combination(factors, in) is const, takes std::span<real_type const> and "                          \
    "std::span<latents_type const> and returns latents_type"
/// What the compiler says of a denoiser that names latents_type and lacks this.
#define GENRENDER_LENDER_FINITE                                                                                        \
    "latent_lender: all_finite(z) is const, takes latents_type const& and returns whether all elements are finite"
/// What the compiler says of a denoiser that names latents_type and lacks this.
#define GENRENDER_LENDER_CALL                                                                                          \
    "latent_lender: operator()(z, sigma, frames, processor) is const, takes z as latents_type const&, sigma as "       \
    "real_type, frames as std::span<frame_index const>, is a template for every processor and returns latents_type"

/// Fails to compile with a sentence for each part that a denoiser which names latents_type lacks.
template <class Phi>
consteval void require_latent_lender() {
    static_assert(detail::lender_names_handle<Phi>, GENRENDER_LENDER_HANDLE);
    static_assert(detail::lender_uploads<Phi>, GENRENDER_LENDER_UPLOAD);
    static_assert(detail::lender_downloads<Phi>, GENRENDER_LENDER_DOWNLOAD);
    static_assert(detail::lender_gives_frames<Phi>, GENRENDER_LENDER_FRAMES);
    static_assert(detail::lender_joins<Phi>, GENRENDER_LENDER_JOINED);
    static_assert(detail::lender_combines<Phi>, GENRENDER_LENDER_COMBINATION);
    static_assert(detail::lender_tells_finite<Phi>, GENRENDER_LENDER_FINITE);
    static_assert(detail::lender_estimates<Phi>, GENRENDER_LENDER_CALL);
}

/// The least that a latent_lender is, for checking what takes one; never run.
template <class Real, class Features, class Latents>
struct latent_lender_archetype : denoiser_archetype<Real, Features> {
    using latents_type = Latents; ///< the engine's handle of latents
    using denoiser_archetype<Real, Features>::operator();
    /// The elements of a view.
    Latents upload(strided_view<Real const, 4> z) const;
    /// Writes the elements of a handle.
    void download(strided_view<Real, 4> to, Latents const& z) const;
    /// A stack of entries of z.
    Latents frames_of(Latents const& z, std::span<frame_index const> frames) const;
    /// Stacks one after the other.
    Latents joined(std::span<Latents const> stacks) const;
    /// The sum of factors times latents.
    Latents combination(std::span<Real const> factors, std::span<Latents const> in) const;
    /// Whether all elements are finite.
    bool all_finite(Latents const& z) const;
    /// D(z, sigma).
    template <class Processor>
    requires attention_processor<Processor, attention_call_archetype<Features, Real>> Latents
    operator()(Latents const& z, Real sigma, std::span<frame_index const> frames, Processor& processor) const;
};

} // namespace genrender

#include <genrender/core/end_header.inl>
