// SPDX-License-Identifier: MIT
// [GR alg. 1: Phi(z^i, D^i, c, f_KF, F_bar^i)] The processor of the injected pass: eq. 5, attention, eq. 6.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/attention/kept_variance.hpp>
#include <genrender/attention/key_counts.hpp>
#include <genrender/attention/length_correction.hpp>
#include <genrender/attention/plain_attention.hpp>
#include <genrender/blending/blend_plans.hpp>
#include <genrender/blending/point_counts.hpp>
#include <genrender/core/sparse_rows.hpp>
#include <genrender/injection/injection_settings.hpp>
#include <genrender/injection/pre_attention.hpp>
#include <genrender/keyframes/feature_bank.hpp>

#include <algorithm>
#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

namespace genrender {

/// Runs frames with the features of the keyframes. At places where the bank holds nothing the network stays as it is.
template <class Features, class Real>
class injector {
public:
    /// alpha of eq. 6 at a site.
    using alpha_function = std::function<Real(site_index)>;

    /// Injects from `bank`, recorded of `keyframes` in this order; both must outlive the injector. `plans` hold those of
    /// the frames of its calls; post-attention and counts of points alone read them. Logits are multiplied by `scale_of`.
    injector(
        feature_bank<Features> const& bank, std::span<frame_index const> keyframes, blend_plans<Real> plans,
        injection_settings settings = {}, alpha_function alpha = [](site_index) { return Real(paper_alpha); },
        logit_scale_function scale_of = {})
        : bank_(&bank), keyframes_(keyframes), plans_(std::move(plans)), settings_(settings), alpha_(std::move(alpha)),
          scale_of_(std::move(scale_of)) {}

    /// F_out of eq. 6, where F_hat attends over the sources of eq. 5. Throws value_error if the keyframe pass ran as a
    /// static graph, which gives no K_KF, and shape_error if K_KF or V_KF is of another number of frames than there are
    /// keyframes (injected_attention_sources); as attend_scaled and mixed_features do.
    template <attention_call Call>
    Features operator()(Call& call) const {
        auto const frames = call.frames();
        auto const* const kept = bank_->find(call.place());
        projected_features<Features> const own = projections_of(call, call.f());
        auto sources = own_attention_sources(own.K, own.V, frames.size());
        std::vector<std::vector<float>> counts;
        if (kept != nullptr && settings_.pre_attention) {
            require_value(kept->K_KF && kept->V_KF, "injector", "K_KF", "missing", "keyframes recorded by callbacks");
            std::vector<std::optional<std::size_t>> drops;
            for (auto const frame : frames) {
                drops.push_back(left_out(frame));
            }
            sources = injected_attention_sources(own.K, own.V, *kept->K_KF, *kept->V_KF, keyframes_.size(), drops);
            if (settings_.counts_points) {
                auto const of_frame = [this](site_index site, frame_index frame) {
                    return point_counts(plans_.rows(site, frame), keyframes_.size());
                };
                counts = count_keys(sources, call.place().site, frames, of_frame, drops);
            }
        }
        scale_by_length(sources, call.place().site, scale_of_);
        Features F_hat = attend_scaled(call, own.Q, sources);
        auto const alpha = kept != nullptr && settings_.post_attention ? alpha_(call.place().site) : Real(0);
        if (alpha == 0) {
            return F_hat;
        }
        auto const rows = plans_.rows(call.place().site, frames);
        return mixed_features<Call>(call, F_hat, *kept->F_KF, rows, alpha, settings_.variance);
    }

    /// Says what a call lacks that is none.
    template <class Call>
        requires(!attention_call<Call>)
    auto operator()(Call&) const { require_attention_call<Call>(); }

    /// Says that a call is no temporary.
    template <class Call>
    auto operator()(Call const&&) const {
        static_assert(std::is_void_v<Call>, GENRENDER_CALL_IS_LVALUE);
    }

    /// Where the bank holds nothing.
    bool is_plain_at(attention_place place) const { return bank_->find(place) == nullptr; }

    /// f_KF that frames join to their own features at a place (eq. 5); null where nothing is injected. For engines
    /// whose graph is static. Throws value_error if the keyframe pass ran with callbacks, which keep K_KF and V_KF
    /// instead.
    Features const* joined_features(attention_place place) const {
        auto const* const kept = bank_->find(place);
        if (kept == nullptr || !settings_.pre_attention) {
            return nullptr;
        }
        require_value(kept->f_KF.has_value(), "injector", "f_KF", "missing", "keyframes recorded by record_features");
        return &*kept->f_KF;
    }

    /// What the logits of each frame are multiplied by at a place; none if all by 1.
    std::vector<double> scales(attention_place place, std::span<frame_index const> frames) const {
        if (!scale_of_ || !settings_.pre_attention || is_plain_at(place)) {
            return {};
        }
        std::vector<double> scales;
        for (auto const frame : frames) {
            scales.push_back(scale_of_(place.site, 1 + keyframes_.size() - (left_out(frame) ? 1 : 0)));
        }
        auto const is_one = [](double scale) { return scale == 1.0; };
        return std::all_of(scales.begin(), scales.end(), is_one) ? std::vector<double>{} : scales;
    }

    /// Whether keys at a place do not count for one each.
    bool counts_keys(attention_place place) const {
        return settings_.counts_points && settings_.pre_attention && !is_plain_at(place);
    }

    /// F_KF that eq. 6 mixes in at a place; null where nothing is injected.
    Features const* blended_features(attention_place place) const {
        auto const* const kept = bank_->find(place);
        return kept != nullptr && settings_.post_attention ? &*kept->F_KF : nullptr;
    }

    /// The plan's rows of each frame at a site: F_bar^i = rows[i] * F_KF.
    std::vector<sparse_rows<Real>> rows_at(site_index site, std::span<frame_index const> frames) const {
        return plans_.rows(site, frames);
    }

    /// The variance that eq. 6 keeps.
    kept_variance const& variance() const { return settings_.variance; }

    /// alpha of eq. 6 at a site.
    Real alpha(site_index site) const { return alpha_(site); }

    /// The position in the drawn keyframes whose tokens a frame does not join, if there is one.
    std::optional<std::size_t> left_out(frame_index frame) const {
        auto const found = std::find(keyframes_.begin(), keyframes_.end(), frame);
        if (settings_.keeps_own_copy || found == keyframes_.end()) {
            return std::nullopt;
        }
        return static_cast<std::size_t>(found - keyframes_.begin());
    }

private:
    feature_bank<Features> const* bank_;
    std::span<frame_index const> keyframes_;
    blend_plans<Real> plans_;
    injection_settings settings_;
    alpha_function alpha_;
    logit_scale_function scale_of_;
};

} // namespace genrender

#include <genrender/core/end_header.inl>
