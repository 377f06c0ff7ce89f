// SPDX-License-Identifier: MIT
// [GR sec. 4: Pix2Video*] The processor in which every frame attends to the anchor and to the previous frame.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/attention/length_correction.hpp>
#include <genrender/attention/plain_attention.hpp>
#include <genrender/core/error.hpp>
#include <genrender/keyframes/feature_bank.hpp>
#include <genrender/keyframes/recorder.hpp>

#include <cstddef>
#include <optional>
#include <string>
#include <utility>

namespace genrender {

/// Keys and values that the stacks run so far leave to the next one. A handle keeps its whole stack, so with the one
/// that runs three stacks are in memory, however long the animation is.
template <class Features>
struct earlier_frames {
    std::optional<feature_bank<Features>> anchor;   ///< of the stack that begins with frame 0, the anchor
    std::optional<feature_bank<Features>> previous; ///< of the stack before; its last entry is the frame before
    std::size_t previous_count = 0;                 ///< frames of the stack before
    std::size_t done = 0;                           ///< frames of all stacks, and so the frame that comes next

    /// Adds a stack of `count` frames that has run.
    void add(feature_bank<Features> stack, std::size_t count) {
        if (!anchor) {
            anchor = stack;
        }
        previous = std::move(stack);
        previous_count = count;
        done += count;
    }
};

/// Runs consecutive frames of an animation in one stack: frame i attends to keys and values of frame 0 and of frame i -
/// 1 at the same site, branch and diffusion step, in this order, and not to its own. They are projections of those
/// frames' features f, which their own attention at earlier sites has shaped, so one stack after the other gives what
/// all frames together would. Frame 0 attends to itself, frame 1 to frame 0 once: a second copy of all keys would not
/// change the softmax. At places that the filter leaves out the network stays as it is.
template <class Features>
class previous_frame_attention {
public:
    /// Keeps the stack's K and V in `kept`, for those after it. Everything is referred to and must outlive the
    /// processor. Logits are multiplied by `scale_of`.
    previous_frame_attention(earlier_frames<Features> const& earlier, feature_bank<Features>& kept,
                             place_filter takes_part, logit_scale_function scale_of = {})
        : earlier_(&earlier), kept_(&kept), takes_part_(std::move(takes_part)), scale_of_(std::move(scale_of)) {}

    /// F of eq. 1 over the sources above. Throws value_error unless the stack holds the frames that come next, in their
    /// order, and the stacks before ran this place.
    template <attention_call Call>
    Features operator()(Call& call) const {
        auto const frames = call.frames();
        if (!takes_part_(call.place())) {
            return plain_attention{}(call);
        }
        for (std::size_t i = 0; i < frames.size(); ++i) {
            auto const next = earlier_->done + i;
            require_value(frames[i].value == next, "previous_frame_attention", "frames", frames[i].value,
                          (std::to_string(next) + ", the frame that comes next").c_str());
        }
        projected_features<Features> const projected = projections_of(call, call.f());
        keyframe_features<Features> own;
        own.K_KF = projected.K;
        own.V_KF = projected.V;

        key_value_block<Features> anchor{&*own.K_KF, &*own.V_KF, 0};
        auto previous = anchor;
        if (earlier_->previous) {
            anchor = block_of(*earlier_->anchor, call.place(), 0);
            previous = block_of(*earlier_->previous, call.place(), earlier_->previous_count - 1);
        }
        attention_sources<Features> sources(frames.size());
        for (std::size_t i = 0; i < frames.size(); ++i) {
            sources[i] = {anchor};
            if (frames[i].value > 1) {
                sources[i].push_back(previous);
            }
            previous = {&*own.K_KF, &*own.V_KF, i};
        }
        scale_by_length(sources, call.place().site, scale_of_);
        Features F = attend_scaled(call, projected.Q, sources);
        kept_->put(call.place(), std::move(own));
        return F;
    }

private:
    /// Refuses an engine that left out the place in a call before.
    static key_value_block<Features> block_of(feature_bank<Features> const& earlier, attention_place place,
                                              std::size_t frame) {
        auto const* const kept = earlier.find(place);
        require_value(kept != nullptr, "previous_frame_attention", "K of the frames before", "missing",
                      "the denoiser to run its processor at every site in every call");
        return {&*kept->K_KF, &*kept->V_KF, frame};
    }

    earlier_frames<Features> const* earlier_;
    feature_bank<Features>* kept_;
    place_filter takes_part_;
    logit_scale_function scale_of_;
};

} // namespace genrender

#include <genrender/core/end_header.inl>
