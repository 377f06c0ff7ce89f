// SPDX-License-Identifier: MIT
// Sums of factors times latents of any type: the one thing that samplers do with them.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/error.hpp>
#include <genrender/core/linear_combination.hpp>
#include <genrender/sampling/sampler_arguments.hpp>

#include <array>
#include <concepts>
#include <cstddef>
#include <span>
#include <utility>

namespace genrender {

/// Latents that are summed by a function of their own, such as those in an engine's memory, an optional capability of
/// what samplers move: viewed_latents are summed by the library, others by their operators.
///
/// expression                 | type | meaning
/// ---------------------------|------|---------------------------------------------------------------------------------
/// `combine(out, factors, in)`| any  | out becomes factors[0] *in[0] + factors[1] *in[1] + ...; factors are a
///                            |      | span<Real const>, in is a span<Latents const* const> of as many, one of which may
///                            |      | be out; found in the namespace of the latents
template <class Latents, class Real>
concept combined_latents = requires(Latents& out, std::span<Real const> factors, std::span<Latents const* const> in) {
    combine(out, factors, in);
};

namespace detail {

/// `out`, which may be one of `in`, becomes the sum of factors times `in`. Throws shape_error for estimates of other
/// extents than z.
template <std::floating_point Real, class Latents, class... In>
void combine_latents(Latents& out, std::array<Real, sizeof...(In)> const& factors, In const&... in) {
    if constexpr (viewed_latents<Latents, Real>) {
        auto const view = to_view(out);
        (require_extents("sampler", "D(z, sigma)", to_view(in).extents(), view.extents()), ...);
        linear_combination(view, factors, std::array{to_view(in)...});
    } else if constexpr (combined_latents<Latents, Real>) {
        std::array<Latents const*, sizeof...(In)> const terms{&in...};
        combine(out, std::span<Real const>(factors), std::span<Latents const* const>(terms));
    } else {
        // One expression, for latents whose sums are lazy.
        [&]<std::size_t... term>(std::index_sequence<term...>) { out = (... + (factors[term] * in)); }
        (std::index_sequence_for<In...>{});
    }
}

} // namespace detail

} // namespace genrender

#include <genrender/core/end_header.inl>
