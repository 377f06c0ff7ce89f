// SPDX-License-Identifier: MIT
// [EDM sec. 5, table 1] The noise levels a network was trained at, and the continuous time between them.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/error.hpp>
#include <genrender/core/finite.hpp>

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace genrender {

/// alpha_bar_t = prod_{i <= t} (1 - beta_i), t = 0 .. steps - 1, of 'scaled linear' betas: sqrt(beta) runs linearly
/// from sqrt(beta_first) to sqrt(beta_last). The defaults are Stable Diffusion's (1.x and 2.x, and SDXL). Falls
/// strictly within (0, 1). Throws value_error for fewer than 2 steps or betas that are not 0 < beta_first <=
/// beta_last < 1.
inline std::vector<double> scaled_linear_alphas_cumprod(double beta_first = 0.00085, double beta_last = 0.012,
                                                        std::size_t steps = 1000) {
    auto const function = "scaled_linear_alphas_cumprod";
    require_value(beta_first > 0 && beta_first < 1, function, "beta_first", beta_first, "a number in (0, 1)");
    require_value(beta_last >= beta_first && beta_last < 1, function, "beta_last", beta_last,
                  "a number in [beta_first, 1)");
    require_value(steps >= 2, function, "steps", steps, "at least 2");

    auto const root_first = std::sqrt(beta_first);
    auto const root_last = std::sqrt(beta_last);
    std::vector<double> alphas_cumprod(steps);
    double alpha_bar = 1;
    for (std::size_t t = 0; t < steps; ++t) {
        auto const ramp = static_cast<double>(t) / static_cast<double>(steps - 1);
        auto const root = root_first + ramp * (root_last - root_first);
        alpha_bar *= 1 - root * root;
        alphas_cumprod[t] = alpha_bar;
    }
    return alphas_cumprod;
}

/// The discrete noise levels of a network's training, sigma_t = sqrt((1 - alpha_bar_t) / alpha_bar_t) for z = x0 +
/// sigma n, joined to a continuous and strictly rising function of time: log sigma is linear between neighbouring
/// steps, never rounded to one. Inside is double precision, whatever the scalar type of the question.
class discrete_noise_schedule {
public:
    /// Stable Diffusion's 1000 levels: sigma from 0.0292 to 14.6146.
    discrete_noise_schedule() : discrete_noise_schedule(scaled_linear_alphas_cumprod()) {}

    /// The levels of `alphas_cumprod` [steps], alpha_bar_t of step t. Throws shape_error for fewer than 2 of them,
    /// value_error unless they fall strictly within (0, 1).
    explicit discrete_noise_schedule(std::span<double const> alphas_cumprod) {
        auto const function = "discrete_noise_schedule";
        if (alphas_cumprod.size() < 2) {
            throw shape_error(std::string(function) + ": alphas_cumprod is " + extents_text({alphas_cumprod.size()}) +
                              ", expected at least [2]");
        }
        log_sigmas_.reserve(alphas_cumprod.size());
        double last = 1;
        for (auto const alpha_bar : alphas_cumprod) {
            require_value(alpha_bar > 0 && alpha_bar < last, function, "alphas_cumprod", alpha_bar,
                          "values that fall strictly within (0, 1)");
            log_sigmas_.push_back(0.5 * std::log((1 - alpha_bar) / alpha_bar));
            last = alpha_bar;
        }
    }

    /// Number of discrete levels.
    std::size_t size() const { return log_sigmas_.size(); }
    /// The lowest level, of time 0.
    double sigma_min() const { return std::exp(log_sigmas_.front()); }
    /// The highest level, of time size() - 1.
    double sigma_max() const { return std::exp(log_sigmas_.back()); }

    /// The noise level of time t; t outside [0, size() - 1] counts as the nearer end. Throws value_error if t is NaN.
    template <std::floating_point Real>
    Real sigma_of(Real t) const {
        require_value(!is_nan(t), "sigma_of", "t", t, "a number");
        auto const position = std::clamp(static_cast<double>(t), 0.0, static_cast<double>(size() - 1));
        // The last interval is closed, so that its upper end has a neighbour above too.
        auto const low = std::min(static_cast<std::size_t>(position), size() - 2);
        auto const w = position - static_cast<double>(low);
        return static_cast<Real>(std::exp((1 - w) * log_sigmas_[low] + w * log_sigmas_[low + 1]));
    }

    /// The time of a noise level, in [0, size() - 1], with a fraction; the inverse of sigma_of. A level outside
    /// [sigma_min(), sigma_max()] counts as the nearer end. Throws value_error unless sigma is at least 0.
    template <std::floating_point Real>
    Real t_of(Real sigma) const {
        require_value(sigma >= 0, "t_of", "sigma", sigma, "at least 0");
        auto const log_sigma =
            std::clamp(std::log(static_cast<double>(sigma)), log_sigmas_.front(), log_sigmas_.back());
        auto const above = std::upper_bound(log_sigmas_.begin() + 1, log_sigmas_.end() - 1, log_sigma);
        auto const low = above - 1;
        auto const w = (log_sigma - *low) / (*above - *low);
        return static_cast<Real>(static_cast<double>(low - log_sigmas_.begin()) + w);
    }

private:
    std::vector<double> log_sigmas_;
};

} // namespace genrender

#include <genrender/core/end_header.inl>
