// SPDX-License-Identifier: MIT
// [GR alg. 1: f_KF, F_KF] The keyframes' features of one step, by attention site and guidance branch.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/attention/attention_site.hpp>
#include <genrender/core/error.hpp>

#include <atomic>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace genrender {

/// Features of all keyframes at one place; each a stack [keyframes, tokens, channels] in the drawn order.
template <class Features>
struct keyframe_features {
    std::optional<Features> f_KF; ///< input of the module; recorded where the engine's graph projects it itself
    std::optional<Features> K_KF; ///< W^K f_KF and
    std::optional<Features> V_KF; ///< W^V f_KF, projected once a step; recorded where the processor runs the module
    std::optional<Features> F_KF; ///< output of the module
};

/// Holds one keyframe_features per site and branch. Different places may be filled at the same time. The library's
/// methods have ended the bank of an evaluation, and with it every handle that an engine gave out for it, before the
/// keyframe pass of the next evaluation begins; run_shapes::banks counts those alive at a time. An engine may therefore
/// write the features of a place over those of the pass before.
template <class Features>
class feature_bank {
public:
    /// Empty, with a place for each guidance branch of each site.
    feature_bank(std::size_t sites, std::size_t branches)
        : sites_(sites), branches_(branches), places_(sites * branches),
          asked_(new std::atomic<bool>[sites * branches]()) {}

    /// Keeps the features of a place, replacing earlier ones. Throws value_error if the place does not exist.
    void put(attention_place place, keyframe_features<Features> features) {
        places_[position(place)] = std::move(features);
    }

    /// The features of a place; null where nothing was recorded.
    keyframe_features<Features> const* find(attention_place place) const {
        auto const& entry = places_[position(place)];
        return entry ? &*entry : nullptr;
    }

    /// Notes that a static graph has asked what to put out at a place. Throws value_error if the place does not exist.
    void note_question(attention_place place) { asked_.get()[position(place)] = true; }

    /// Whether a static graph has asked what to put out at a place, and so owes its features.
    bool was_asked(attention_place place) const { return asked_.get()[position(place)]; }

private:
    std::size_t position(attention_place place) const {
        auto const at = place.site.value * branches_ + place.branch;
        if (place.branch >= branches_ || at >= places_.size()) {
            throw value_error("feature_bank: place is site " + std::to_string(place.site.value) + " branch " +
                              std::to_string(place.branch) + ", expected " + std::to_string(sites_) + " sites with " +
                              std::to_string(branches_) + " branches");
        }
        return at;
    }

    std::size_t sites_;
    std::size_t branches_;
    std::vector<std::optional<keyframe_features<Features>>> places_;
    std::shared_ptr<std::atomic<bool>[]> asked_; // of copies, too
};

} // namespace genrender

#include <genrender/core/end_header.inl>
