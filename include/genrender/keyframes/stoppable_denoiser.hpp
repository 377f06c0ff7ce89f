// SPDX-License-Identifier: MIT
// [GR alg. 1: f_KF, F_KF <- Phi(z_KF, D_KF, c)] What a denoiser may offer for the keyframe pass: to end it early, and
// not to do again for a keyframe what that pass has done.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/sampling/denoiser.hpp>
#include <genrender/sampling/latent_lender.hpp>

#include <concepts>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace genrender {

/// A denoiser that can end a call after the last site whose features are wanted, an optional capability: the keyframe
/// pass needs no estimates.
///
/// A denoiser without it estimates the keyframes as any others, and nobody reads the estimates.
///
/// expression                                         | type | meaning
/// ---------------------------------------------------|------|--------------------------------------------------------
/// `phi.run_until(z, sigma, frames, processor, last)` | void | runs the processor at the sites 0 ... last[branch] of
///                                                    |      | every branch as `phi(x0, z, sigma, frames, processor)`
///                                                    |      | does, to the bit; nothing of a branch without a last
///                                                    |      | site. `last` has one entry a branch
///
/// z is a latents_type of a latent_lender, too. Sites count in the order of sites(), so a network that stops saves most where that is the order in which it runs
/// them. It may run more sites than asked for, each once; z is not changed (check_denoiser_laws of
/// testing/denoiser_laws.hpp checks this).
template <class Phi>
concept stoppable_denoiser = denoiser<Phi> &&
    requires(Phi const& phi, strided_view<typename Phi::real_type const, 4> z, typename Phi::real_type sigma,
             std::span<frame_index const> frames, attention_processor_archetype& processor,
             std::span<std::optional<site_index> const> last) {
    phi.run_until(z, sigma, frames, processor, last);
};

/// A denoiser that lends what a call has computed of its frames to later calls of the same frames at the same z and
/// sigma, such as the residuals of a ControlNet and the network's way down, an optional capability. One without it
/// computes the keyframes anew among all frames.
///
/// expression                                                 | type            | meaning
/// -----------------------------------------------------------|-----------------|--------------------------------------
/// `typename Phi::residuals_type`                             | movable         | what is lent; made without arguments
/// `phi.run_until(z, sigma, frames, processor, last, &lent)`  | void            | as above, and fills in `lent` unless
///                                                            |                 | the pointer is null
/// `phi(x0, z, sigma, frames, processor, lent)`               | void            | as without `lent`, to the bit, which
///                                                            |                 | is const
/// `phi.residual_bytes()`                                     | size_t          | what is lent takes a frame
///
/// The model decides what is equal: it reuses only what both processors leave as it is (is_plain_at), and only for
/// frames, z and sigma that are those of the first call. The estimates may be asked for from several threads with one
/// `lent` (check_denoiser_laws checks that what is lent changes no estimate).
template <class Phi>
concept residual_lender = stoppable_denoiser<Phi> && std::movable<typename Phi::residuals_type> &&
    std::default_initializable<typename Phi::residuals_type> &&
    requires(Phi const& phi, strided_view<typename Phi::real_type, 4> x0,
             strided_view<typename Phi::real_type const, 4> z, typename Phi::real_type sigma,
             std::span<frame_index const> frames, attention_processor_archetype& processor,
             std::span<std::optional<site_index> const> last, typename Phi::residuals_type& lent,
             typename Phi::residuals_type const& known) {
    phi.run_until(z, sigma, frames, processor, last, &lent);
    phi(x0, z, sigma, frames, processor, known);
    { phi.residual_bytes() } -> std::convertible_to<std::size_t>;
};

namespace detail {

/// Whether a denoiser that lends latents and stops takes handles where it stops; true for others.
template <class Phi>
concept lender_stops = !latent_lender<Phi> || !stoppable_denoiser<Phi> ||
                       requires(Phi const& phi, typename Phi::latents_type const& z, typename Phi::real_type sigma,
                                std::span<frame_index const> frames, attention_processor_archetype& processor,
                                std::span<std::optional<site_index> const> last) {
    phi.run_until(z, sigma, frames, processor, last);
    requires !residual_lender<Phi> ||
        requires(typename Phi::residuals_type & lent, typename Phi::residuals_type const& known) {
        phi.run_until(z, sigma, frames, processor, last, &lent);
        { phi(z, sigma, frames, processor, known) } -> std::convertible_to<typename Phi::latents_type>;
    };
};

struct no_residuals {};

template <class Phi>
struct residuals_of {
    using type = no_residuals;
};

template <residual_lender Phi>
struct residuals_of<Phi> {
    using type = typename Phi::residuals_type;
};

} // namespace detail

/// What the compiler says of a latent_lender that can end a call of views alone.
#define GENRENDER_LENDER_STOPS                                                                                         \
    "latent_lender: run_until(z, sigma, frames, processor, last) takes z as latents_type const&, too, and where "      \
    "residuals are lent run_until(..., &lent) and operator()(z, sigma, frames, processor, lent)"

/// What a denoiser lends; an empty type for one that does not.
template <denoiser Phi>
using residuals_of = typename detail::residuals_of<Phi>::type;

/// The last site that takes part, by branch; none in a branch without one. `takes_part(place)` tells.
template <denoiser Phi, class TakesPart>
std::vector<std::optional<site_index>> last_sites(Phi const& phi, TakesPart const& takes_part) {
    std::vector<std::optional<site_index>> last(phi.branches());
    for (std::uint32_t branch = 0; branch < last.size(); ++branch) {
        for (std::uint32_t site = 0; site < std::ranges::size(phi.sites()); ++site) {
            if (takes_part(attention_place{{site}, branch})) {
                last[branch] = site_index{site};
            }
        }
    }
    return last;
}

} // namespace genrender

#include <genrender/core/end_header.inl>
