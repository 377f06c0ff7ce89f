// SPDX-License-Identifier: MIT
// [GR alg. 1: z] The laws of latent_lender and normalizing_lender, as a check of a model against plain loops.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/attention/plain_attention.hpp>
#include <genrender/core/stack.hpp>
#include <genrender/keyframes/stoppable_denoiser.hpp>
#include <genrender/sampling/latent_lender.hpp>
#include <genrender/testing/at_once.hpp>
#include <genrender/testing/denoiser_laws.hpp>
#include <genrender/testing/law_report.hpp>
#include <genrender/testing/random_stack.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <ranges>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace genrender::testing {

namespace detail {

/// What is the same in all trials of one lender.
template <latent_lender Phi>
struct lender_trials {
    using Real = typename Phi::real_type;
    using handle = typename Phi::latents_type;

    Phi const* phi;
    Real sigma;
    denoiser_trial const* trial;
    law_report* report;
    denoiser_trials<Phi> of_views;

    lender_trials(Phi const& tried, Real level, denoiser_trial const& given, law_report& to)
        : phi(&tried), sigma(level), trial(&given), report(&to), of_views(tried, level, given) {}

    stack<Real, 4> random(std::size_t frames, std::uint64_t seed) const {
        return random_stack<Real>(of_views.extents(frames), trial->seed + seed);
    }
    handle upload(stack<Real, 4> const& z) const { return phi->upload(z.view()); }
    /// The elements of a handle, in memory that held what no latents hold.
    stack<Real, 4> download(handle const& z, std::size_t frames) const {
        auto to = of_views.unwritten(frames);
        phi->download(to.view(), z);
        return to;
    }
    void require(std::string const& law, stack<Real, 4> const& found, stack<Real, 4> const& expected,
                 double tolerance = 0) const {
        require_same(*report, law, "element ", found, expected, tolerance);
    }

    void check_transfers() const {
        auto const z = random(3, 0);
        auto changed = z;
        auto const handle_of_z = phi->upload(std::as_const(changed).view());
        std::fill_n(changed.data(), changed.size(), std::numeric_limits<Real>::quiet_NaN());
        require("latent_lender: what is uploaded is downloaded to the bit, whatever becomes of the view",
                download(handle_of_z, 3), z);
        auto const other = random(2, 1);
        upload(other);
        auto const copied = handle_of_z;
        require("latent_lender: copies of a handle stand for the same latents", download(copied, 3), z);
    }

    void check_frames() const {
        auto const z = random(4, 2);
        auto const all = upload(z);
        for (auto const& frames : {std::vector<frame_index>{{0}, {1}, {2}, {3}}, std::vector<frame_index>{{2}, {3}},
                                   std::vector<frame_index>{{3}, {0}, {2}}, std::vector<frame_index>{{1}, {3}, {3}}}) {
            stack<Real, 4> expected(of_views.extents(frames.size()));
            for (std::size_t i = 0; i < frames.size(); ++i) {
                copy(expected.view()[i], in_view<Real, 3>(z.view()[frames[i].value]));
            }
            require("latent_lender: frames_of gives the entries that are named, in their order",
                    download(phi->frames_of(all, std::span<frame_index const>(frames)), frames.size()), expected);
        }
        auto const lone = random(1, 3);
        std::vector<handle> const stacks{upload(lone), all, upload(lone)};
        stack<Real, 4> expected(of_views.extents(6));
        copy(expected.view().slice(0, 1), in_view<Real, 4>(lone.view()));
        copy(expected.view().slice(1, 4), in_view<Real, 4>(z.view()));
        copy(expected.view().slice(5, 1), in_view<Real, 4>(lone.view()));
        require("latent_lender: joined gives the entries of all stacks, in their order",
                download(phi->joined(std::span<handle const>(stacks)), 6), expected);
        require("latent_lender: one stack joined is that stack",
                download(phi->joined(std::span<handle const>(stacks).subspan(1, 1)), 4), z);
        require("latent_lender: frames_of and joined do not change what they are given", download(all, 4), z);
    }

    void check_combinations() const {
        std::array<Real, 4> const factors{Real(1.25), Real(-0.5), Real(3), Real(-0.25)};
        std::vector<stack<Real, 4>> values;
        std::vector<handle> in;
        for (std::size_t n = 0; n < factors.size(); ++n) {
            values.push_back(random(2, 4 + n));
            in.push_back(upload(values.back()));
        }
        auto const check = [&](std::size_t terms) {
            stack<Real, 4> expected(of_views.extents(2));
            for (std::size_t n = 0; n < terms; ++n) {
                for (std::size_t e = 0; e < expected.size(); ++e) {
                    expected.data()[e] += factors[n] * values[n].data()[e];
                }
            }
            require("latent_lender: combination is the sum of factors times latents",
                    download(phi->combination(std::span<Real const>(factors).first(terms),
                                              std::span<handle const>(in).first(terms)),
                             2),
                    expected, trial->tolerance);
        };
        for (std::size_t terms = 1; terms <= in.size(); ++terms) {
            check(terms);
        }
        for (std::size_t n = 0; n < in.size(); ++n) {
            require("latent_lender: combination does not change what it is given", download(in[n], 2), values[n]);
        }
        in[1] = in[0]; // A sampler's sum may name latents twice.
        values[1] = values[0];
        check(3);
    }

    void check_finite() const {
        auto z = random(2, 8);
        report->require(phi->all_finite(upload(z)), "latent_lender: all_finite tells what is finite",
                        "false for numbers", "true");
        for (auto const value : {std::numeric_limits<Real>::quiet_NaN(), std::numeric_limits<Real>::infinity(),
                                 -std::numeric_limits<Real>::infinity()}) {
            z.data()[z.size() - 1] = value;
            report->require(!phi->all_finite(upload(z)), "latent_lender: all_finite tells what is not",
                            "true for " + number_text(static_cast<double>(value)), "false");
        }
    }

    void check_call() const {
        plain_attention const plain;
        auto const expected = of_views.estimate(plain);
        auto const frames = std::span<frame_index const>(of_views.frames);
        auto const z = upload(of_views.z);
        handle const x0 = (*phi)(z, sigma, frames, plain);
        require("latent_lender: a call on handles estimates what one on views does", download(x0, frames.size()),
                expected, trial->tolerance);
        (*phi)(upload(random(frames.size(), 9)), sigma, frames, plain);
        require("latent_lender: estimates are not written by another call", download(x0, frames.size()), expected,
                trial->tolerance);
        require("latent_lender: a call does not change z", download(z, frames.size()), of_views.z);
        std::vector<std::optional<site_index>> const all(
            phi->branches(), site_index{static_cast<std::uint32_t>(std::ranges::size(phi->sites()))});
        require_runs(*report, "latent_lender", of_views, all,
                     [&](counting_attention const& counting) { (*phi)(z, sigma, frames, counting); });
        if (trial->threads > 1) {
            std::vector<stack<Real, 4>> beside_others(frames.size());
            at_once(trial->threads, frames.size(), [&](std::size_t i) {
                std::array const entry{frame_index{static_cast<std::uint32_t>(i)}};
                beside_others[i] = download(
                    (*phi)(phi->frames_of(z, std::span<frame_index const>(entry)), sigma, frames.subspan(i, 1), plain),
                    1);
            });
            for (std::size_t i = 0; i < frames.size(); ++i) {
                require("latent_lender: calls for different frames may run at the same time", beside_others[i],
                        of_views.frame_of(expected, i), trial->tolerance);
            }
        }
        if constexpr (stoppable_denoiser<Phi>) {
            check_stopping(z, expected);
        }
    }

    void check_stopping(handle const& z, stack<Real, 4> const& expected) const {
        auto const frames = std::span<frame_index const>(of_views.frames);
        std::size_t const sites = std::ranges::size(phi->sites());
        for (std::uint32_t site = 0; site < sites; ++site) {
            std::vector<std::optional<site_index>> const last(phi->branches(), site_index{site});
            require_runs(*report, "latent_lender", of_views, last,
                         [&](counting_attention const& counting) { phi->run_until(z, sigma, frames, counting, last); });
        }
        require("latent_lender: run_until does not change z", download(z, frames.size()), of_views.z);
        if constexpr (residual_lender<Phi>) {
            std::vector<std::optional<site_index>> const last(phi->branches(),
                                                              site_index{static_cast<std::uint32_t>(sites - 1)});
            plain_attention const plain;
            typename Phi::residuals_type lent{};
            phi->run_until(z, sigma, frames, plain, last, &lent);
            require("latent_lender: what is lent changes no estimate",
                    download((*phi)(z, sigma, frames, plain, lent), frames.size()), expected, trial->tolerance);
        }
    }

    /// Of a normalizing_lender.
    void check_normalization() const {
        auto z = random(3, 10);
        auto const frames = z.extent(0);
        auto const channels = z.extent(1);
        auto const pixels = z.extent(2) * z.extent(3);
        stack<Real, 4> w({frames, 1, z.extent(2), z.extent(3)});
        for (std::size_t i = 0; i < frames; ++i) {
            for (std::size_t p = 0; p < pixels; ++p) {
                w.data()[i * pixels + p] = (p + i) % 3 != 0 || i == 2 ? 1 : 0;
            }
        }
        stack<Real, 2> mean({frames, channels});
        stack<Real, 2> deviation({frames, channels});
        auto const handle_of_z = upload(z);
        phi->channel_statistics(mean.view(), deviation.view(), handle_of_z, phi->upload(std::as_const(w).view()));
        stack<Real, 2> mean_expected({frames, channels});
        stack<Real, 2> deviation_expected({frames, channels});
        for (std::size_t i = 0; i < frames; ++i) {
            for (std::size_t c = 0; c < channels; ++c) {
                auto const at = [&](std::size_t p) {
                    return static_cast<double>(z.data()[(i * channels + c) * pixels + p]);
                };
                double count = 0;
                double sum = 0;
                double squares = 0;
                for (std::size_t p = 0; p < pixels; ++p) {
                    auto const weight = static_cast<double>(w.data()[i * pixels + p]);
                    count += weight;
                    sum += weight * at(p);
                }
                for (std::size_t p = 0; p < pixels; ++p) {
                    squares += static_cast<double>(w.data()[i * pixels + p]) * std::pow(at(p) - sum / count, 2);
                }
                if (count < 2) { // Then nobody reads them.
                    mean_expected(i, c) = mean(i, c);
                    deviation_expected(i, c) = deviation(i, c);
                    continue;
                }
                mean_expected(i, c) = static_cast<Real>(sum / count);
                deviation_expected(i, c) = static_cast<Real>(std::sqrt(squares / (count - 1) + 1e-5));
            }
        }
        require_same(*report, "normalizing_lender: means are of the elements where w is 1", "mean", mean, mean_expected,
                     trial->tolerance);
        require_same(*report, "normalizing_lender: deviations are sqrt(unbiased variance + 1e-5) where w is 1",
                     "deviation", deviation, deviation_expected, trial->tolerance);

        auto const mean_from = random_stack<Real>(std::array{frames, channels}, trial->seed + 11);
        auto const scale = random_stack<Real>(std::array{frames, channels}, trial->seed + 12);
        auto const mean_to = random_stack<Real>(std::array{frames, channels}, trial->seed + 13);
        auto expected = z;
        for (std::size_t row = 0; row < frames * channels; ++row) {
            for (std::size_t p = 0; p < pixels; ++p) {
                auto& value = expected.data()[row * pixels + p];
                value = (value - mean_from.data()[row]) * scale.data()[row] + mean_to.data()[row];
            }
        }
        require("normalizing_lender: rescaled is (z - mean_from) scale + mean_to",
                download(phi->rescaled(handle_of_z, mean_from.view(), scale.view(), mean_to.view()), frames), expected,
                trial->tolerance);
        require("normalizing_lender: rescaled does not change z", download(handle_of_z, frames), z);
    }
};

} // namespace detail

/// Checks the laws of latent_lender at noise level sigma, and those of normalizing_lender where `phi` is one; its calls
/// on views are check_denoiser_laws'. Operations that round are compared with plain loops up to the trial's tolerance,
/// all others to the bit. Throws value_error for a trial of fewer than 2 frames, and what the denoiser throws.
template <latent_lender Phi>
law_report check_latent_lender_laws(Phi const& phi, typename Phi::real_type sigma, denoiser_trial const& trial = {}) {
    require_value(trial.frames.size() >= 2, "check_latent_lender_laws", "trial.frames.size()", trial.frames.size(),
                  "at least 2 frames");
    law_report report;
    detail::lender_trials<Phi> const trials(phi, sigma, trial, report);
    trials.check_transfers();
    if (!report.empty()) {
        return report;
    }
    trials.check_frames();
    trials.check_combinations();
    trials.check_finite();
    trials.check_call();
    if constexpr (normalizing_lender<Phi>) {
        trials.check_normalization();
    }
    return report;
}

} // namespace genrender::testing

#include <genrender/core/end_header.inl>
