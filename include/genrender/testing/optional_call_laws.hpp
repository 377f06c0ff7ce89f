// SPDX-License-Identifier: MIT
// The laws of calls that scale logits and keep variance, as a part of check_attention_call_laws.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/attention/attention_call.hpp>
#include <genrender/attention/extended_attention.hpp>
#include <genrender/attention/kept_variance.hpp>
#include <genrender/attention/length_correction.hpp>
#include <genrender/attention/plain_attention.hpp>
#include <genrender/core/sparse_rows.hpp>
#include <genrender/core/stack.hpp>
#include <genrender/sampling/denoiser.hpp>
#include <genrender/testing/denoiser_laws.hpp>
#include <genrender/testing/law_report.hpp>

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>
#include <vector>

namespace genrender::testing::detail {

/// Plans of a stack in which a row sums two entries of one source row, so that the weights are seen to be added up:
/// row t of frame i is row t of frame `of_frame[i]` of F_KF.
template <class Real>
class doubled_rows {
public:
    doubled_rows(std::span<std::size_t const> of_frame, std::size_t tokens) {
        for (std::size_t t = 0; t <= tokens; ++t) {
            offsets_.push_back(static_cast<std::uint32_t>(2 * t));
        }
        no_offsets_.assign(tokens + 1, 0);
        for (auto const frame : of_frame) {
            sources_.emplace_back();
            for (std::size_t t = 0; t < tokens; ++t) {
                sources_.back().insert(sources_.back().end(), 2, static_cast<std::uint32_t>(frame * tokens + t));
                weights_.insert(weights_.end(), {Real(0.75), Real(0.25)});
            }
        }
        weights_.resize(2 * tokens);
    }

    std::vector<sparse_rows<Real>> covered() const {
        std::vector<sparse_rows<Real>> rows;
        for (auto const& sources : sources_) {
            rows.push_back({offsets_, sources, weights_});
        }
        return rows;
    }
    std::vector<sparse_rows<Real>> uncovered() const {
        return std::vector<sparse_rows<Real>>(sources_.size(), sparse_rows<Real>{no_offsets_, {}, {}});
    }

private:
    std::vector<std::uint32_t> offsets_;
    std::vector<std::uint32_t> no_offsets_;
    std::vector<std::vector<std::uint32_t>> sources_;
    std::vector<Real> weights_;
};

/// The attention of a call with its own queries over given sources.
template <class Call, class MakeSources>
typename Call::features_type attend_to(Call& call, MakeSources const& make_sources) {
    using features = typename Call::features_type;
    features const f = call.f();
    features const Q = call.query(f);
    features const K = call.key(f);
    features const V = call.value(f);
    return call.attend(Q, make_sources(K, V, std::size_t{call.frames().size()}));
}

/// The laws of scaling_attention_call on the calls of a trial, whose estimates with plain attention are `plain_x0`.
template <denoiser Phi>
void check_scaling_laws(law_report& report, denoiser_trials<Phi> const& trials,
                        stack<typename Phi::real_type, 4> const& plain_x0, double tolerance) {
    using features = typename Phi::features_type;
    std::atomic<bool> is_scaling = false;
    auto const scaled = [&](double scale, bool by_lists) {
        auto const attend = [&, scale, by_lists](auto& call) {
            using call_type = std::remove_cvref_t<decltype(call)>;
            return attend_to(call, [&](features const& K, features const& V, std::size_t count) {
                auto sources = extended_attention_sources(K, V, count);
                if (by_lists) {
                    sources.begin(); // To be written: the pattern is forgotten.
                }
                if constexpr (scaling_attention_call<call_type>) {
                    sources.set_scales(std::vector<double>(count, scale));
                    is_scaling = true;
                }
                return sources;
            });
        };
        return trials.estimate(attend);
    };
    auto const unscaled = [](auto& call) {
        return attend_to(call, [](features const& K, features const& V, std::size_t count) {
            return extended_attention_sources(K, V, count);
        });
    };
    auto const as_it_is = trials.estimate(unscaled);
    auto const differs = [&](auto const& x0) { return !std::equal(x0.data(), x0.data() + x0.size(), as_it_is.data()); };
    require_same(report, "scaling_attention_call: a scale of 1 changes no bit", "x0", scaled(1, false), as_it_is);
    if (!is_scaling || !differs(plain_x0)) {
        return; // Estimates tell nothing of attention.
    }
    auto const sharper = scaled(2, false);
    report.require(differs(sharper), "scaling_attention_call: attend multiplies logits by sources.scale(i)",
                   "the same x0 with logits times 2", "another one");
    require_same(report, "scaling_attention_call: scales hold by sources.pattern() as by the lists",
                 "with logits times 2, x0", sharper, scaled(2, true), tolerance);
}

/// The laws of variance_keeping_call on the calls of a trial; F_of(place) are the outputs of an ended call there.
template <denoiser Phi, class OutputOf>
void check_variance_laws(law_report& report, denoiser_trials<Phi> const& trials,
                         stack<typename Phi::real_type, 4> const& plain_x0, double tolerance, OutputOf const& F_of) {
    using features = typename Phi::features_type;
    using Real = typename Phi::real_type;
    std::vector<std::size_t> mirrored;
    for (std::size_t i = 0; i < trials.frames.size(); ++i) {
        mirrored.push_back(trials.frames.size() - 1 - i);
    }
    auto const mixed = [&](bool covers, bool keeps, kept_variance const& kept) {
        auto const mix = [&](auto& call) {
            using call_type = std::remove_cvref_t<decltype(call)>;
            attention_site const site = trials.phi->sites()[call.place().site.value];
            features const F_hat = plain_attention{}(call);
            doubled_rows<Real> const plan(mirrored, site.grid.size());
            auto const rows = covers ? plan.covered() : plan.uncovered();
            if constexpr (variance_keeping_call<call_type>) {
                if (keeps) {
                    return features(call.mix_keeping_variance(F_hat, F_of(call.place()), rows, Real(0.5), kept));
                }
            }
            return features(call.mix(F_hat, F_of(call.place()), rows, Real(0.5)));
        };
        return trials.estimate(mix);
    };
    auto const expected = mixed(true, false, {});
    require_same(report, "variance_keeping_call: variance_target::none gives what mix gives", "x0",
                 mixed(true, true, {}), expected);
    require_same(report, "variance_keeping_call: a most_gain of 1 gives what mix gives", "x0",
                 mixed(true, true, {variance_target::total, 1}), expected, tolerance);
    require_same(report, "variance_keeping_call: rows that are not covered are those of F_hat", "x0",
                 mixed(false, true, {variance_target::total, 2}), plain_x0);
}

} // namespace genrender::testing::detail

#include <genrender/core/end_header.inl>
