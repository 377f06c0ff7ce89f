// SPDX-License-Identifier: MIT
// [GR sec. 4: TokenFlow*] The processor that skips self-attention and takes over the keyframes' outputs instead.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/attention/plain_attention.hpp>
#include <genrender/blending/blend_plans.hpp>
#include <genrender/injection/feature_io.hpp>
#include <genrender/keyframes/feature_bank.hpp>

#include <cstddef>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

namespace genrender {

/// Runs frames with the outputs of the keyframes in place of their own self-attention: F^i = rows[i] * F_KF. At places
/// where the bank holds nothing the network stays as it is.
template <class Features, class Real>
class token_propagation {
public:
    /// Propagates from `bank`, which must outlive the processor. `plans` hold those of the frames of its calls, which
    /// cover every token.
    token_propagation(feature_bank<Features> const& bank, blend_plans<Real> plans)
        : bank_(&bank), plans_(std::move(plans)) {}

    /// F = rows * F_KF. Throws value_error if rows leave a token uncovered.
    template <attention_call Call>
    Features operator()(Call& call) const {
        auto const* const kept = bank_->find(call.place());
        if (kept == nullptr) {
            return plain_attention{}(call);
        }
        // V only lends its extents, those of F: every token of it is replaced.
        return call.mix(call.value(call.f()), *kept->F_KF, rows_at(call.place().site, call.frames()), Real{1});
    }

    /// Where the bank holds nothing.
    bool is_plain_at(attention_place place) const { return bank_->find(place) == nullptr; }

    /// F_KF that is taken over at a place; null where the network stays as it is.
    Features const* propagated_features(attention_place place) const {
        auto const* const kept = bank_->find(place);
        return kept == nullptr ? nullptr : &*kept->F_KF;
    }

    /// The plan's rows of each frame at a site.
    std::vector<sparse_rows<Real>> rows_at(site_index site, std::span<frame_index const> frames) const {
        auto rows = plans_.rows(site, frames);
        for (auto const& one : rows) {
            for (std::size_t t = 0; t < one.row_count(); ++t) {
                require_value(one.is_covered(t), "token_propagation", "rows", "empty at a token",
                              "a plan that covers every token");
            }
        }
        return rows;
    }

private:
    feature_bank<Features> const* bank_;
    blend_plans<Real> plans_;
};

/// The extra inputs of propagation for a static graph: eq. 6 with alpha = 1 replaces what its attention gave.
template <class Features, class Real>
feature_inputs<Features, Real> inputs_at(token_propagation<Features, Real> const& pass, attention_place place,
                                         std::span<frame_index const> frames, graph_abilities = {}) {
    feature_inputs<Features, Real> inputs;
    inputs.F_KF = pass.propagated_features(place);
    if (inputs.F_KF != nullptr) {
        inputs.rows = pass.rows_at(place.site, frames);
        inputs.alpha = 1;
    }
    return inputs;
}

/// Propagation asks for no outputs: does nothing.
template <class Features, class Real>
void record_features(token_propagation<Features, Real> const&, attention_place, std::type_identity_t<Features> const&,
                     std::type_identity_t<Features> const&) {}

} // namespace genrender

#include <genrender/core/end_header.inl>
