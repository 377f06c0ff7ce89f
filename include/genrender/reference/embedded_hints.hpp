// SPDX-License-Identifier: MIT
// The ControlNet's features of the depth of every frame: kept where they fit into memory, made anew where they do not.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/index.hpp>
#include <genrender/core/parallel.hpp>
#include <genrender/core/stack.hpp>
#include <genrender/reference/controlnet.hpp>
#include <genrender/reference/feature_maps.hpp>

#include <algorithm>
#include <cstddef>
#include <memory>
#include <span>
#include <utility>
#include <vector>

namespace genrender::reference {

/// Hints of an animation, embedded. An embedding depends on its frame alone.
template <class Real>
class embedded_hints {
public:
    /// Embeddings of the frames of a call; those that are kept are pointed to.
    struct of_call {
        std::vector<feature_maps<Real>> made;         ///< those that are not kept, made for this call
        std::vector<feature_maps<Real> const*> hints; ///< one a frame
    };

    embedded_hints() = default;

    /// For hints [frames, conditioning_channels, height, width] of a ControlNet. Embeddings of the first frames are
    /// made once and kept, as many as fit into `most_bytes`; at least one.
    embedded_hints(std::shared_ptr<controlnet<Real> const> control, stack<Real, 4> hint, std::size_t most_bytes,
                   any_loop const& loop)
        : control_(std::move(control)), hint_(std::move(hint)), frames_(hint_.extent(0)) {
        if (frames_ == 0) {
            return;
        }
        kept_.push_back(embed(0));
        auto const bytes = kept_.front().view().size() * sizeof(Real);
        kept_.resize(std::clamp<std::size_t>(most_bytes / bytes, 1, frames_));
        loop(kept_.size() - 1, [&](std::size_t i) { kept_[i + 1] = embed(i + 1); });
        if (kept_.size() == frames_) {
            hint_ = {};
        }
    }

    /// Number of frames.
    std::size_t frame_count() const { return frames_; }
    /// Number of frames whose embedding is kept.
    std::size_t kept_count() const { return kept_.size(); }

    /// The embeddings of frames below frame_count(). What is kept must outlive the result.
    of_call at(std::span<frame_index const> frames, any_loop const& loop) const {
        of_call result;
        result.made.resize(frames.size());
        result.hints.resize(frames.size());
        loop(frames.size(), [&](std::size_t i) {
            auto const frame = std::size_t{frames[i].value};
            if (frame < kept_.size()) {
                result.hints[i] = &kept_[frame];
            } else {
                result.made[i] = embed(frame);
                result.hints[i] = &result.made[i];
            }
        });
        return result;
    }

private:
    feature_maps<Real> embed(std::size_t frame) const {
        feature_maps<Real> pixels(1, {hint_.extent(2), hint_.extent(3)}, hint_.extent(1));
        copy(pixels.channels_first()[0], in_view<Real, 3>(hint_.view()[frame]));
        return control_->embed(pixels);
    }

    std::shared_ptr<controlnet<Real> const> control_;
    stack<Real, 4> hint_;
    std::size_t frames_ = 0;
    std::vector<feature_maps<Real>> kept_;
};

} // namespace genrender::reference

#include <genrender/core/end_header.inl>
