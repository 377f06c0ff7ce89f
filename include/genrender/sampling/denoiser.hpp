// SPDX-License-Identifier: MIT
// [GR alg. 1: Phi] The front door of networks: estimates clean latents of a stack of frames.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/attention/attention_processor.hpp>
#include <genrender/attention/attention_site.hpp>
#include <genrender/core/index.hpp>
#include <genrender/core/strided_view.hpp>

#include <concepts>
#include <cstddef>
#include <ranges>
#include <span>
#include <type_traits>

namespace genrender {

/// The self-attention modules of a denoiser, in the order in which attention_place::site counts them: a vector, an
/// array or a span of attention_site, or what is read like one.
///
/// expression                 | type            | meaning
/// ---------------------------|-----------------|----------------------------------------------------------------------
/// `std::ranges::size(sites)` | size_t          | number of modules; sites are a random access range
/// `sites[s]`                 | attention_site  | what module s is: its name, network, part, grid and channels; of
///                            |                 | type attention_site const&, or what converts to it
template <class Sites>
concept attention_sites = std::ranges::random_access_range<Sites> && std::ranges::sized_range<Sites> &&
    requires(Sites&& sites, std::size_t s) {
    requires std::convertible_to<std::ranges::range_reference_t<Sites>, attention_site const&>;
    { sites[s] } -> std::convertible_to<attention_site const&>;
};

/// Estimates the clean latents of a stack of frames at a noise level, running the processor it is given at each of its
/// self-attention sites. Phi of the paper; it owns its conditioning (prompt, depth maps, guidance scale) and looks it
/// up by frame_index.
///
/// expression                             | type            | meaning
/// ---------------------------------------|-----------------|----------------------------------------------------------
/// `typename Phi::real_type`              | float or double | scalar of the latents, and `real_type` of its calls
/// `typename Phi::features_type`          | copyable        | its engine's handle of features [frames, tokens,
///                                        |                 | channels], and `features_type` of its calls
/// `phi.latent_channels()`                | size_t          | channels of z
/// `phi.latent_grid()`                    | grid_extents    | height and width of z
/// `phi.sites()`                          | attention_sites | its self-attention modules, the same in every call
/// `phi.branches()`                       | size_t          | guidance branches it runs: 1, or 2 with classifier-free
///                                        |                 | guidance; 1 too if its features hold both branches and
///                                        |                 | its calls do the same to each
/// `phi(x0, z, sigma, frames, processor)` | void            | writes D(z, sigma) [EDM sec. 3], the estimate of the
///                                        |                 | clean latents, into x0; x0 and z are [frames, channels,
///                                        |                 | height, width]; `frames[i]` says which frame of the
///                                        |                 | animation entry i is; z = clean + sigma * noise
///
/// All members are const. x0 and z of the library's calls are row-major without gaps, so that `z.data()` can be handed
/// to an engine; what x0 holds before the call is not to be read. `processor` is of any type that models
/// attention_processor for the engine's calls, so operator() is a template; it is an lvalue, const or not.
///
/// What is run at a site. Where module s of branch b has normed its input f, [frames, tokens, channels] with the tokens
/// of sites()[s].grid row by row, the denoiser makes a call, a model of attention_call with the operations of its own
/// engine, and takes the module's output from the processor instead of computing it:
///
///     my_call call(...);                                // call.place() is {s, b}, call.frames() is `frames`
///     typename Phi::features_type F = processor(call);  // then the output projection, and the residual is added
///
/// so `my_call::features_type` is `Phi::features_type` and `my_call::real_type` is `Phi::real_type`. `call` is an
/// lvalue that lives until the processor returns; handles that it gave out may live on (F_KF is kept until the step
/// ends), so nobody may write into the memory of F. For features in host memory the library has the handle
/// host_features and the call host_attention_call. An engine whose graph is static and cannot call back asks the
/// processor by `inputs_at` and `record_features` instead (feature_io_processor in injection/feature_io.hpp) and needs
/// no attention_call.
///
/// These the compiler cannot check, and a model owes them (check_denoiser_laws of testing/denoiser_laws.hpp checks
/// them, check_attention_call_laws of testing/attention_call_laws.hpp its calls): every site is run once per branch and
/// call, with all frames of the stack at once; with plain_attention the estimate of a frame does not depend on the
/// other frames of the stack; equal arguments give equal results; all of x0 is written; z is not changed; calls for
/// different frames may run at the same time on several threads if the caller uses more than one. Branches and sites
/// may be run in any order. The maps that are rendered must be a whole multiple of the latent grid and of every feature
/// grid. It does not require to be a neural network, to be differentiable, or to know of keyframes, noise or textures.
///
/// Optional capabilities: stoppable_denoiser and residual_lender (keyframes/stoppable_denoiser.hpp) of the denoiser,
/// storing_attention_call (attention/feature_storage.hpp) of its calls, shaped_features (attention/attention_call.hpp)
/// of its features. See also: attention_processor, what it runs; sequence_denoiser, which turns it into a denoiser of
/// whole animations.
template <class Phi>
concept denoiser = std::floating_point<typename Phi::real_type> && std::copyable<typename Phi::features_type> &&
    requires(Phi const& phi, strided_view<typename Phi::real_type, 4> x0,
             strided_view<typename Phi::real_type const, 4> z, typename Phi::real_type sigma,
             std::span<frame_index const> frames, attention_processor_archetype& processor) {
    { phi.latent_channels() } -> std::convertible_to<std::size_t>;
    { phi.latent_grid() } -> std::convertible_to<grid_extents>;
    { phi.sites() } -> attention_sites;
    { phi.branches() } -> std::convertible_to<std::size_t>;
    phi(x0, z, sigma, frames, processor);
};

namespace detail {

/// The scalar of a denoiser; float for what is none.
template <class Phi>
struct real_type_of {
    using type = float;
};
template <class Phi>
    requires std::floating_point<typename Phi::real_type>
struct real_type_of<Phi> {
    using type = typename Phi::real_type;
};
template <class Phi>
using scalar_of = typename real_type_of<Phi>::type;

// One part of the concept each, so that who checks it names what is missing in a line of his own.
template <class Phi>
concept denoiser_names_types =
    std::floating_point<typename Phi::real_type> && std::copyable<typename Phi::features_type>;
template <class Phi>
concept denoiser_tells_latents = requires(Phi const& phi) {
    { phi.latent_channels() } -> std::convertible_to<std::size_t>;
    { phi.latent_grid() } -> std::convertible_to<grid_extents>;
};
template <class Phi>
concept denoiser_tells_sites = requires(Phi const& phi) {
    { phi.sites() } -> attention_sites;
};
template <class Phi>
concept denoiser_tells_branches = requires(Phi const& phi) {
    { phi.branches() } -> std::convertible_to<std::size_t>;
};
/// Whether a Phi, const or not, can be called with z of these elements; true where it names no scalar, which is told
/// already.
template <class Phi, class Element>
concept denoiser_estimates = !denoiser_names_types<std::remove_const_t<Phi>> ||
                             requires(Phi & phi, strided_view<typename Phi::real_type, 4> x0,
                                      strided_view<Element, 4> z, typename Phi::real_type sigma,
                                      std::span<frame_index const> frames, attention_processor_archetype& processor) {
    phi(x0, z, sigma, frames, processor);
};
template <class Phi>
concept denoiser_call_is_right = denoiser_estimates < Phi const,
        scalar_of<Phi>
const > ;
template <class Phi>
concept denoiser_call_is_const = denoiser_call_is_right<Phi> || !denoiser_estimates<Phi, scalar_of<Phi> const>;
template <class Phi>
concept denoiser_keeps_z = denoiser_call_is_right<Phi> || !denoiser_estimates<Phi const, scalar_of<Phi>>;

} // namespace detail

// The sentences, which static_assert takes as literals only.
/// What the compiler says of a denoiser that lacks this.
#define GENRENDER_DENOISER_TYPES "denoiser: real_type is float or double and features_type is copyable"
/// What the compiler says of a denoiser that lacks this.
#define GENRENDER_DENOISER_LATENTS                                                                                     \
    "denoiser: latent_channels() is const and returns a number, latent_grid() is const and returns grid_extents"
/// What the compiler says of a denoiser that lacks this.
#define GENRENDER_DENOISER_SITES "denoiser: sites() is const and returns a random access range of attention_site"
/// What the compiler says of a denoiser that lacks this.
#define GENRENDER_DENOISER_BRANCHES "denoiser: branches() is const and returns the number of guidance branches"
/// What the compiler says of a denoiser that lacks this.
#define GENRENDER_DENOISER_CONST "denoiser: operator()(x0, z, sigma, frames, processor) is const"
/// What the compiler says of a denoiser that lacks this.
#define GENRENDER_DENOISER_Z                                                                                           \
    "denoiser: operator()(x0, z, sigma, frames, processor) takes z as strided_view<real_type const, 4>: it is not "    \
    "changed"
/// What the compiler says of a denoiser that lacks this.
#define GENRENDER_DENOISER_CALL                                                                                        \
    "denoiser: operator()(x0, z, sigma, frames, processor) takes x0 as strided_view<real_type, 4>, z as "              \
    "strided_view<real_type const, 4>, sigma as real_type, frames as std::span<frame_index const>, and is a template " \
    "for every processor, which it takes as Processor&"

/// Fails to compile with a sentence for each part that a denoiser lacks.
template <class Phi>
consteval void require_denoiser() {
    static_assert(detail::denoiser_names_types<Phi>, GENRENDER_DENOISER_TYPES);
    static_assert(detail::denoiser_tells_latents<Phi>, GENRENDER_DENOISER_LATENTS);
    static_assert(detail::denoiser_tells_sites<Phi>, GENRENDER_DENOISER_SITES);
    static_assert(detail::denoiser_tells_branches<Phi>, GENRENDER_DENOISER_BRANCHES);
    static_assert(detail::denoiser_call_is_const<Phi>, GENRENDER_DENOISER_CONST);
    static_assert(detail::denoiser_keeps_z<Phi>, GENRENDER_DENOISER_Z);
    static_assert(detail::denoiser_call_is_right<Phi> || !detail::denoiser_call_is_const<Phi> ||
                      !detail::denoiser_keeps_z<Phi>,
                  GENRENDER_DENOISER_CALL);
}

/// The least that a denoiser is, for checking what takes one; never run.
template <class Real, class Features>
struct denoiser_archetype {
    using real_type = Real;         ///< scalar of the latents
    using features_type = Features; ///< the engine's handle of features
    /// Channels of z.
    std::size_t latent_channels() const;
    /// Height and width of z.
    grid_extents latent_grid() const;
    /// Its self-attention modules.
    std::span<attention_site const> sites() const;
    /// Guidance branches that it runs.
    std::size_t branches() const;
    /// Writes D(z, sigma) into x0.
    template <class Processor>
        requires attention_processor<Processor, attention_call_archetype<Features, Real>>
    void operator()(strided_view<Real, 4> x0, strided_view<Real const, 4> z, Real sigma,
                    std::span<frame_index const> frames, Processor& processor) const;
};

} // namespace genrender

#include <genrender/core/end_header.inl>
