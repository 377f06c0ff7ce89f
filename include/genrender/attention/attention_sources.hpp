// SPDX-License-Identifier: MIT
// What the frames of a stack attend to: lists of blocks, and what the lists amount to.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/error.hpp>
#include <genrender/core/finite.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace genrender {

/// Keys and values of one frame, as a part of what a query attends to: row `frame` of the stacks K and V.
template <class Features>
struct key_value_block {
    Features const* K = nullptr; ///< keys, a stack [frames, tokens, channels]; not owned
    Features const* V = nullptr; ///< values, of the same frames and tokens as K; not owned
    std::size_t frame = 0;       ///< entry of the frame axis of both
    /// [tokens] How many keys each key counts for, whole or not, above 0: its logarithm is added to the logits. Not owned;
    /// null for one each.
    float const* counts = nullptr;
};

/// What the lists of blocks of all frames amount to.
enum class attention_meaning : std::uint8_t {
    listed,        ///< nothing but what the lists say
    own,           ///< eq. 1: frame i attends to frame i of K and V
    stack,         ///< eq. 3: every frame attends to all frames of K and V
    own_and_joined ///< eq. 5: frame i attends to frame i of K and V, then to all frames of K_KF and V_KF but left_out[i]
};

/// The same as the lists of attention_sources in a few words, so that an engine can batch them.
template <class Features>
struct attention_pattern {
    attention_meaning meaning = attention_meaning::listed; ///< which of the members below are used
    Features const* K = nullptr;                           ///< keys of the stack's own frames; null if listed
    Features const* V = nullptr;                           ///< values of the same
    Features const* K_KF = nullptr;                        ///< keys of the joined frames; null unless some are joined
    Features const* V_KF = nullptr;                        ///< values of the same
    std::size_t joined = 0;                                ///< number of joined frames
    /// Per frame of the stack, the joined frame that it does not attend to, if any; empty if every frame attends to all.
    std::vector<std::optional<std::size_t>> left_out{};
};

/// What every frame of a stack attends to: one list of blocks a frame, read in order, as if their tokens stood in a row.
/// `pattern()` says the same at once where it can be said. It points to features, which it does not own.
template <class Features>
class attention_sources {
public:
    using block_list = std::vector<key_value_block<Features>>; ///< what one frame attends to
    using value_type = block_list;                             ///< the same, as containers call it

    /// Of no frame.
    attention_sources() = default;
    /// Empty lists of so many frames.
    explicit attention_sources(std::size_t frames) : lists_(frames) {}
    /// The same list for each of so many frames.
    attention_sources(std::size_t frames, block_list const& all) : lists_(frames, all) {}
    /// These lists, one a frame.
    attention_sources(std::initializer_list<block_list> lists) : lists_(lists) {}
    /// These lists, one a frame.
    attention_sources(std::vector<block_list> lists) : lists_(std::move(lists)) {}

    /// Frame i attends to frame i of K and V, stacks of so many frames.
    static attention_sources own(Features const& K, Features const& V, std::size_t frames) {
        attention_sources sources(frames);
        for (std::size_t i = 0; i < frames; ++i) {
            sources.lists_[i] = {{&K, &V, i}};
        }
        sources.pattern_ = {attention_meaning::own, &K, &V};
        return sources;
    }

    /// Every frame attends to frames 0, 1, ... of K and V, stacks of so many frames.
    static attention_sources stack(Features const& K, Features const& V, std::size_t frames) {
        block_list all(frames);
        for (std::size_t j = 0; j < frames; ++j) {
            all[j] = {&K, &V, j};
        }
        attention_sources sources(frames, all);
        sources.pattern_ = {attention_meaning::stack, &K, &V};
        return sources;
    }

    /// Frame i attends to frame i of K and V, and then to the `joined` frames of K_KF and V_KF but left_out[i].
    /// `left_out` has an entry for each of the stack's frames.
    static attention_sources own_and_joined(Features const& K, Features const& V, Features const& K_KF,
                                            Features const& V_KF, std::size_t joined,
                                            std::vector<std::optional<std::size_t>> left_out) {
        auto sources = own(K, V, left_out.size());
        bool leaves_out = false;
        for (std::size_t i = 0; i < left_out.size(); ++i) {
            for (std::size_t k = 0; k < joined; ++k) {
                if (k != left_out[i]) {
                    sources.lists_[i].push_back({&K_KF, &V_KF, k});
                }
            }
            leaves_out = leaves_out || left_out[i].has_value();
        }
        sources.pattern_ = {attention_meaning::own_and_joined, &K, &V, &K_KF, &V_KF, joined, {}};
        if (leaves_out) {
            sources.pattern_.left_out = std::move(left_out);
        }
        return sources;
    }

    /// What the lists amount to. Lists that were written to since they were made are attention_meaning::listed.
    attention_pattern<Features> const& pattern() const { return pattern_; }

    /// What the logits of frame i are multiplied by, beside the 1 / sqrt(d) of eq. 1; 1 unless set_scales was called.
    double scale(std::size_t i) const { return scales_.empty() ? 1.0 : scales_[i]; }
    /// Whether the logits of some frame are multiplied by other than 1.
    bool is_scaled() const { return !scales_.empty(); }
    /// The scales of all frames; none if all are 1.
    std::span<double const> scales() const { return scales_; }
    /// Sets the scale of every frame; lists and pattern stay. Throws shape_error for other than one a frame, value_error
    /// for one that is not finite and above 0.
    void set_scales(std::vector<double> scales) {
        require_extents("attention_sources", "scales", std::array{scales.size()}, std::array{lists_.size()});
        for (auto const scale : scales) {
            require_value(is_finite(scale) && scale > 0, "attention_sources", "scales", scale, "finite and above 0");
        }
        auto const is_one = [](double scale) { return scale == 1.0; };
        scales_ = std::all_of(scales.begin(), scales.end(), is_one) ? std::vector<double>{} : std::move(scales);
    }

    /// Whether some key does not count for one, which the pattern does not say.
    bool counts_keys() const {
        return std::any_of(lists_.begin(), lists_.end(), [](block_list const& blocks) {
            return std::any_of(blocks.begin(), blocks.end(), [](auto const& block) { return block.counts != nullptr; });
        });
    }
    /// Sets what the keys of a block of frame i count for; lists and pattern stay.
    void set_counts(std::size_t i, std::size_t block, float const* counts) { lists_[i][block].counts = counts; }

    /// Number of frames.
    std::size_t size() const { return lists_.size(); }
    /// Whether there is no frame.
    bool empty() const { return lists_.empty(); }
    /// What frame i attends to.
    block_list const& operator[](std::size_t i) const { return lists_[i]; }
    /// What frame i attends to, to be written: the pattern is forgotten.
    block_list& operator[](std::size_t i) { return written()[i]; }
    /// What the first frame attends to.
    block_list const& front() const { return lists_.front(); }
    /// What the last frame attends to.
    block_list const& back() const { return lists_.back(); }
    /// What the first frame attends to, to be written: the pattern is forgotten.
    block_list& front() { return written().front(); }
    /// What the last frame attends to, to be written: the pattern is forgotten.
    block_list& back() { return written().back(); }
    /// The first frame's list.
    auto begin() const { return lists_.begin(); }
    /// The first frame's list, to be written: the pattern is forgotten.
    auto begin() { return written().begin(); }
    /// Past the last frame's list.
    auto end() const { return lists_.end(); }
    /// Past the last frame's list, to be written: the pattern is forgotten.
    auto end() { return written().end(); }
    /// Adds the list of one more frame, of scale 1: the pattern is forgotten.
    void push_back(block_list list) {
        written().push_back(std::move(list));
        scales_.resize(scales_.empty() ? 0 : lists_.size(), 1.0);
    }

    /// The same of other features: `of(x)` gives a pointer to what stands for `*x`. Pattern and scales are kept.
    template <class Other, class Of>
    attention_sources<Other> of_features(Of const& of) const {
        auto const other = [&](Features const* x) { return x != nullptr ? of(*x) : nullptr; };
        attention_sources<Other> sources(lists_.size());
        sources.scales_ = scales_;
        for (std::size_t i = 0; i < lists_.size(); ++i) {
            for (auto const& block : lists_[i]) {
                sources.lists_[i].push_back({other(block.K), other(block.V), block.frame, block.counts});
            }
        }
        auto const& [meaning, K, V, K_KF, V_KF, joined, left_out] = pattern_;
        sources.pattern_ = {meaning, other(K), other(V), other(K_KF), other(V_KF), joined, left_out};
        return sources;
    }

    /// All lists, for engines that read nothing else.
    operator std::vector<block_list> const&() const { return lists_; }

private:
    template <class Other>
    friend class attention_sources;

    std::vector<block_list>& written() {
        pattern_ = {};
        return lists_;
    }

    std::vector<block_list> lists_;
    attention_pattern<Features> pattern_;
    std::vector<double> scales_; // one a frame; none if all are 1
};

} // namespace genrender

#include <genrender/core/end_header.inl>
