// SPDX-License-Identifier: MIT
// [GR alg. 1: Phi] The laws of denoiser, stoppable_denoiser and residual_lender, as a check of a model.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/attention/plain_attention.hpp>
#include <genrender/core/finite.hpp>
#include <genrender/core/stack.hpp>
#include <genrender/injection/feature_io.hpp>
#include <genrender/keyframes/stoppable_denoiser.hpp>
#include <genrender/sampling/denoiser.hpp>
#include <genrender/testing/at_once.hpp>
#include <genrender/testing/law_report.hpp>
#include <genrender/testing/random_stack.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <mutex>
#include <optional>
#include <ranges>
#include <span>
#include <string>
#include <vector>

namespace genrender::testing {

/// How a denoiser is tried.
struct denoiser_trial {
    /// The frames of the animation that it is asked for, at least 2, all different, all known to it.
    std::vector<frame_index> frames{{0}, {1}, {2}};
    /// How far estimates of one frame may differ by rounding, relative to the greater of their size and 1.
    double tolerance = 1e-5;
    /// Threads that call it at the same time; 1 for a denoiser that is only ever run on one thread.
    std::size_t threads = 2;
    /// Of the latents z ~ N(0, 1).
    std::uint64_t seed = 7;
};

namespace detail {

/// What is the same in all trials of one denoiser.
template <denoiser Phi>
struct denoiser_trials {
    using Real = typename Phi::real_type;

    Phi const* phi;
    Real sigma;
    std::vector<frame_index> frames;
    stack<Real, 4> z;

    denoiser_trials(Phi const& tried, Real level, denoiser_trial const& trial)
        : phi(&tried), sigma(level), frames(trial.frames), z(random_stack<Real>(extents(frames.size()), trial.seed)) {}

    std::array<std::size_t, 4> extents(std::size_t count) const {
        auto const grid = grid_extents(phi->latent_grid());
        return {count, std::size_t(phi->latent_channels()), grid.height, grid.width};
    }

    /// Estimates that hold what no estimate may be until they are written.
    stack<Real, 4> unwritten(std::size_t count) const {
        stack<Real, 4> x0(extents(count));
        std::fill_n(x0.data(), x0.size(), std::numeric_limits<Real>::quiet_NaN());
        return x0;
    }

    /// The estimates of all frames with a processor.
    template <class Processor>
    stack<Real, 4> estimate(Processor& processor) const {
        auto x0 = unwritten(frames.size());
        (*phi)(x0.view(), z.view(), sigma, frames, processor);
        return x0;
    }

    /// The estimate of one frame alone with plain attention.
    stack<Real, 4> estimate_alone(std::size_t i) const {
        auto x0 = unwritten(1);
        plain_attention const plain;
        (*phi)(x0.view(), z.view().slice(i, 1), sigma, std::array{frames[i]}, plain);
        return x0;
    }

    /// One frame of estimates of all.
    stack<Real, 4> frame_of(stack<Real, 4> const& x0, std::size_t i) const {
        stack<Real, 4> alone(extents(1));
        copy(alone.view(), in_view<Real, 4>(x0.view().slice(i, 1)));
        return alone;
    }
};

/// Plain attention that counts the runs of each place and compares the frames it is given. A processor for callbacks
/// and for static graphs.
struct counting_attention {
    std::map<attention_place, std::size_t>* runs;
    std::span<frame_index const> frames;
    std::optional<std::string>* other_frames; ///< frames that it was given instead, if it was
    std::mutex* mutex;

    template <attention_call Call>
    typename Call::features_type operator()(Call& call) const {
        count(call.place());
        compare(call.frames());
        return plain_attention{}(call);
    }

    void count(attention_place place) const {
        std::lock_guard const lock(*mutex);
        ++(*runs)[place];
    }
    void compare(std::span<frame_index const> given) const {
        if (std::equal(given.begin(), given.end(), frames.begin(), frames.end())) {
            return;
        }
        std::vector<std::uint32_t> numbers;
        for (auto const frame : given) {
            numbers.push_back(frame.value);
        }
        std::lock_guard const lock(*mutex);
        *other_frames = extents_text(numbers);
    }
};

template <class Features, class Real>
feature_inputs<Features, Real> inputs_at(counting_attention const& pass, attention_place,
                                         std::span<frame_index const> frames) {
    pass.compare(frames);
    feature_inputs<Features, Real> inputs;
    inputs.is_recorded = true;
    return inputs;
}
template <class Features>
void record_features(counting_attention const& pass, attention_place place, Features const&, Features const&) {
    pass.count(place);
}

/// A place as text: `site 2 of branch 0`.
inline std::string place_text(attention_place place) {
    return "site " + std::to_string(place.site.value) + " of branch " + std::to_string(place.branch);
}

/// Notes places that were run not once, or frames that were not those of the call. Places after the `last` site of
/// their branch may be left out.
template <denoiser Phi, class Run>
void require_runs(law_report& report, std::string const& concept_name, denoiser_trials<Phi> const& trials,
                  std::span<std::optional<site_index> const> last, Run const& run) {
    std::map<attention_place, std::size_t> runs;
    std::optional<std::string> other_frames;
    std::mutex mutex;
    counting_attention const counting{&runs, trials.frames, &other_frames, &mutex};
    run(counting);
    std::size_t const sites = std::ranges::size(trials.phi->sites());
    for (auto const& [place, count] : runs) {
        report.require(place.site.value < sites && place.branch < trials.phi->branches(),
                       concept_name + ": the places that are run are those of sites() and branches()",
                       place_text(place),
                       std::to_string(sites) + " sites of " + std::to_string(trials.phi->branches()) + " branches");
    }
    for (std::uint32_t branch = 0; branch < trials.phi->branches(); ++branch) {
        for (std::uint32_t site = 0; site < sites; ++site) {
            auto const found = runs.find({{site}, branch});
            auto const count = found == runs.end() ? std::size_t{0} : found->second;
            auto const is_wanted = last[branch] && site <= last[branch]->value;
            report.require(count == 1 || (count == 0 && !is_wanted),
                           concept_name + ": every site is run once per branch and call, with all frames at once",
                           std::to_string(count) + " runs of " + place_text({{site}, branch}), "1");
        }
    }
    report.require(!other_frames, concept_name + ": frames() of a call are those of the denoiser's call",
                   other_frames.value_or(""), "those that operator() was given, in their order");
}

/// The laws of stoppable_denoiser and residual_lender.
template <stoppable_denoiser Phi>
void check_stopping(law_report& report, denoiser_trials<Phi> const& trials,
                    [[maybe_unused]] stack<typename Phi::real_type, 4> const& together) {
    std::size_t const sites = std::ranges::size(trials.phi->sites());
    auto const before = trials.z;
    for (std::uint32_t site = 0; site < sites; ++site) {
        std::vector<std::optional<site_index>> const last(trials.phi->branches(), site_index{site});
        require_runs(report, "stoppable_denoiser", trials, last, [&](counting_attention const& counting) {
            trials.phi->run_until(trials.z.view(), trials.sigma, trials.frames, counting, last);
        });
    }
    require_same(report, "stoppable_denoiser: z is not changed", "z", trials.z, before);
    if constexpr (residual_lender<Phi>) {
        if (sites == 0) {
            return;
        }
        std::vector<std::optional<site_index>> const last(trials.phi->branches(),
                                                          site_index{static_cast<std::uint32_t>(sites - 1)});
        plain_attention const plain;
        typename Phi::residuals_type lent{};
        trials.phi->run_until(trials.z.view(), trials.sigma, trials.frames, plain, last, &lent);
        auto x0 = trials.unwritten(trials.frames.size());
        (*trials.phi)(x0.view(), trials.z.view(), trials.sigma, trials.frames, plain, lent);
        require_same(report, "residual_lender: what is lent changes no estimate", "x0", x0, together);
        auto other = trials;
        for (std::size_t e = 0; e < other.z.size(); ++e) {
            other.z.data()[e] = -trials.z.data()[e];
        }
        auto const expected = other.estimate(plain);
        (*trials.phi)(x0.view(), other.z.view(), trials.sigma, trials.frames, plain, lent);
        require_same(report, "residual_lender: what is lent is not used for another z", "x0", x0, expected);
    }
}

} // namespace detail

/// Checks the laws of denoiser at noise level sigma, and those of stoppable_denoiser and residual_lender where `phi` is
/// one: 7 calls of 3 frames or fewer, and one per site for the others. Works for denoisers of either way in. What it
/// cannot see: whether the estimates are any good. An engine that calls back has check_attention_call_laws besides.
/// Throws value_error for a trial of fewer than 2 frames, and what the denoiser throws.
template <denoiser Phi>
law_report check_denoiser_laws(Phi const& phi, typename Phi::real_type sigma, denoiser_trial const& trial = {}) {
    using Real = typename Phi::real_type;
    require_value(trial.frames.size() >= 2, "check_denoiser_laws", "trial.frames.size()", trial.frames.size(),
                  "at least 2 frames");
    law_report report;
    auto const grid = grid_extents(phi.latent_grid());
    report.require(phi.latent_channels() > 0 && grid.size() > 0 && phi.branches() > 0,
                   "denoiser: there are latents and a branch",
                   "latents " + extents_text({std::size_t(phi.latent_channels()), grid.height, grid.width}) + " and " +
                       std::to_string(phi.branches()) + " branches",
                   "extents and branches of at least 1");
    auto const& sites = phi.sites();
    for (std::size_t s = 0; s < std::size_t(std::ranges::size(sites)); ++s) {
        attention_site const& site = sites[s];
        report.require(site.grid.size() > 0 && site.channels > 0, "denoiser: sites tell their grid and channels",
                       "site " + std::to_string(s) + " of " +
                           extents_text({site.grid.height, site.grid.width, site.channels}),
                       "extents of at least 1");
    }
    if (!report.empty()) {
        return report;
    }

    detail::denoiser_trials<Phi> const trials(phi, sigma, trial);
    auto const before = trials.z;
    plain_attention const plain;
    auto const together = trials.estimate(plain);
    detail::require_same(report, "denoiser: z is not changed", "z", trials.z, before);
    for (std::size_t e = 0; e < together.size(); ++e) {
        if (!is_finite(together.data()[e])) {
            report.add("denoiser: all of x0 is written and finite",
                       "x0" + detail::address_text(together.extents(), e) + " = " +
                           detail::number_text(static_cast<double>(together.data()[e])),
                       "a finite number");
        }
    }
    if (!report.empty()) {
        return report;
    }
    detail::require_same(report, "denoiser: equal arguments give equal results", "x0", trials.estimate(plain),
                         together);

    std::vector<stack<Real, 4>> alone;
    for (std::size_t i = 0; i < trials.frames.size(); ++i) {
        alone.push_back(trials.estimate_alone(i));
        detail::require_same(report,
                             "denoiser: with plain attention a frame does not depend on the others of its stack",
                             "frame " + std::to_string(trials.frames[i].value) + " alone, x0", alone[i],
                             trials.frame_of(together, i), trial.tolerance);
    }
    if (trial.threads > 1) {
        std::vector<stack<Real, 4>> beside_others(alone.size());
        at_once(trial.threads, alone.size(), [&](std::size_t i) { beside_others[i] = trials.estimate_alone(i); });
        for (std::size_t i = 0; i < alone.size(); ++i) {
            detail::require_same(report, "denoiser: calls for different frames may run at the same time",
                                 "frame " + std::to_string(trials.frames[i].value) + " on a thread, x0",
                                 beside_others[i], alone[i]);
        }
    }

    std::vector<std::optional<site_index>> const all(phi.branches(),
                                                     site_index{static_cast<std::uint32_t>(std::ranges::size(sites))});
    detail::require_runs(report, "denoiser", trials, all,
                         [&](detail::counting_attention const& counting) { trials.estimate(counting); });
    if constexpr (stoppable_denoiser<Phi>) {
        detail::check_stopping(report, trials, together);
    }
    return report;
}

} // namespace genrender::testing

#include <genrender/core/end_header.inl>
