// SPDX-License-Identifier: MIT
// [EDM alg. 1] What every sampler takes: a clean estimate to follow, the noise levels to visit, a word after each step.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/error.hpp>
#include <genrender/core/finite.hpp>

#include <concepts>
#include <cstddef>
#include <iterator>
#include <string>
#include <type_traits>
#include <utility>

namespace genrender {

/// The noise levels of a run: any sequence of float or double with a size and an index, such as std::vector<Real> and
/// std::span<Real const>.
///
/// These the compiler cannot check, and require_noise_levels does: at least 2 levels, finite, strictly falling, none
/// below 0. So only the last can be 0. Levels have the scalar type of the latents they are multiplied with.
template <class Sigmas>
concept noise_levels = requires(Sigmas const& sigmas, std::size_t i) {
    { std::size(sigmas) } -> std::convertible_to<std::size_t>;
    requires std::floating_point<std::remove_cvref_t<decltype(sigmas[i])>>;
};

/// The scalar type of noise levels.
template <noise_levels Sigmas>
using level_type = std::remove_cvref_t<decltype(std::declval<Sigmas const&>()[std::size_t{}])>;

/// A clean estimator that is told at which of the run's noise levels it is, an optional capability: one without it is
/// told the level's sigma alone.
///
/// expression       | type    | meaning
/// -----------------|---------|----------------------------------------------------------------------------------------
/// `D(z, sigma, i)` | Latents | the clean estimate of z at level i of the run, sigma = sigmas[i]
template <class Denoise, class Latents, class Real>
concept level_estimator = requires(Denoise& D, Latents const& z, Real sigma, std::size_t level) {
    { D(z, sigma, level) } -> std::convertible_to<Latents>;
};

/// What a sampler follows.
///
/// expression    | type    | meaning
/// --------------|---------|-------------------------------------------------------------------------------------------
/// `D(z, sigma)` | Latents | the clean estimate x0 of latents z = x0 + sigma n
///
/// z is a whole animation, which is not changed; nothing here knows of frames. D need not be const. The library's
/// samplers call `D(z, sigma, i)` where D is a level_estimator, and a D that is one needs no `D(z, sigma)`.
template <class Denoise, class Latents, class Real>
concept clean_estimator = level_estimator<Denoise, Latents, Real> ||
    requires(Denoise& D, Latents const& z, Real sigma) {
    { D(z, sigma) } -> std::convertible_to<Latents>;
};

namespace detail {

/// The clean estimate of z at level i of a run.
template <class Latents, class Denoise, class Sigmas>
Latents estimate(Denoise& D, Latents const& z, Sigmas const& sigmas, std::size_t i) {
    if constexpr (level_estimator<Denoise, Latents, level_type<Sigmas>>) {
        return D(z, sigmas[i], i);
    } else {
        return D(z, sigmas[i]);
    }
}

} // namespace detail

/// The default after_step of the samplers: does nothing.
struct nothing_after_step {
    /// Leaves the latents as they are.
    template <class Latents>
    void operator()(std::size_t, Latents&) const {}
};

/// Latents whose elements the library can see, an optional capability of what samplers move: they then go through them
/// once a step and allocate nothing; others are added and multiplied by their own operators.
///
/// expression   | type               | meaning
/// -------------|--------------------|-----------------------------------------------------------------------------
/// `to_view(z)` | strided_view<Real> | the elements, constant ones of constant latents; found in the namespace of the
///              |                    | latents
template <class Latents, class Real>
concept viewed_latents = requires(Latents& z, Latents const& x0) {
    { to_view(z).data() } -> std::same_as<Real*>;
    { to_view(x0).data() } -> std::same_as<Real const*>;
};

/// Throws shape_error for fewer than 2 levels; value_error unless they are finite, at least 0 and strictly falling.
template <noise_levels Sigmas>
void require_noise_levels(char const* function, Sigmas const& sigmas) {
    auto const count = std::size(sigmas);
    if (count < 2) {
        throw shape_error(std::string(function) + ": sigmas is " + extents_text({count}) + ", expected at least [2]");
    }
    auto const name = [](std::size_t i) { return "sigmas[" + std::to_string(i) + "]"; };
    for (std::size_t i = 0; i < count; ++i) {
        require_value(is_finite(sigmas[i]) && sigmas[i] >= 0, function, name(i).c_str(), sigmas[i],
                      "a finite number of at least 0");
        require_value(i == 0 || sigmas[i] < sigmas[i - 1], function, name(i).c_str(), sigmas[i],
                      ("less than " + name(i - 1)).c_str());
    }
}

} // namespace genrender

#include <genrender/core/end_header.inl>
