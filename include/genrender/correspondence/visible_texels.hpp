// SPDX-License-Identifier: MIT
// [GR sec. 3.2] Which texels a frame sees and which of its tokens show them, found in constant time.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/index.hpp>

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

namespace genrender {

/// The visible texels of one frame: a bit per slot with counts of the bits before each word, so that the entries of a
/// slot are found by its rank and invisible slots cost one bit.
class visible_texels {
public:
    /// A token that shows a texel, with its share.
    struct entry {
        token_index token; ///< the token
        double weight = 1; ///< its share, in (0, 1]
    };

    /// Collects samples texel by texel.
    class builder {
    public:
        /// Of texels numbered from 0 to below `slots`.
        explicit builder(std::size_t slots) : nearest_(slots) {}

        /// Offers a sample of `token` at squared `distance` from the texel's centre. The nearest sample wins, the first
        /// offered at equal distance; with `average` all samples inside the texel share it, and outside ones stand in
        /// only if there are none.
        void offer(std::uint32_t slot, token_index token, double distance, bool is_inside, bool average) {
            auto& best = nearest_[slot];
            // A texel's own sample beats any that is borrowed from a neighbour.
            if (std::pair(!is_inside, distance) < std::pair(!best.is_inside, best.distance)) {
                best = {token, distance, is_inside};
            }
            if (average && is_inside) {
                inside_.push_back({slot, token});
            }
        }

        /// The finished table.
        visible_texels finish() && {
            visible_texels table(nearest_.size());
            std::sort(inside_.begin(), inside_.end());
            auto sample = inside_.begin();
            for (std::uint32_t slot = 0; slot < nearest_.size(); ++slot) {
                if (nearest_[slot].distance == unseen) {
                    continue;
                }
                table.mark(slot);
                auto const first = sample;
                while (sample != inside_.end() && sample->first == slot) {
                    ++sample;
                }
                if (first == sample) {
                    table.entries_.push_back({nearest_[slot].token, 1});
                } else {
                    for (auto run = first; run != sample;) {
                        auto const next = std::upper_bound(run, sample, *run);
                        table.entries_.push_back(
                            {run->second, static_cast<double>(next - run) / static_cast<double>(sample - first)});
                        run = next;
                    }
                }
                table.offsets_.push_back(static_cast<std::uint32_t>(table.entries_.size()));
            }
            table.count_ranks();
            return table;
        }

    private:
        // A number, since compilers may assume that nothing is infinite.
        static constexpr double unseen = (std::numeric_limits<double>::max)();

        struct nearest_sample {
            token_index token;
            double distance = unseen;
            bool is_inside = false;
        };
        std::vector<nearest_sample> nearest_;
        std::vector<std::pair<std::uint32_t, token_index>> inside_;
    };

    visible_texels() = default;

    /// The tokens that show a slot; empty where the frame does not see it.
    std::span<entry const> entries(std::uint32_t slot) const {
        auto const word = slot / 64;
        auto const bit = std::uint64_t{1} << (slot % 64);
        if ((words_[word] & bit) == 0) {
            return {};
        }
        auto const rank = ranks_[word] + static_cast<std::uint32_t>(std::popcount(words_[word] & (bit - 1)));
        return std::span(entries_).subspan(offsets_[rank], offsets_[rank + 1] - offsets_[rank]);
    }

    /// Tokens of the slot that most tokens show; 0 where the frame sees none.
    std::size_t most_entries() const {
        std::size_t most = 0;
        for (std::size_t rank = 0; rank + 1 < offsets_.size(); ++rank) {
            most = std::max<std::size_t>(most, offsets_[rank + 1] - offsets_[rank]);
        }
        return most;
    }

private:
    explicit visible_texels(std::size_t slots) : words_((slots + 63) / 64) {}

    void mark(std::uint32_t slot) { words_[slot / 64] |= std::uint64_t{1} << (slot % 64); }

    void count_ranks() {
        ranks_.reserve(words_.size());
        std::uint32_t rank = 0;
        for (auto const word : words_) {
            ranks_.push_back(rank);
            rank += static_cast<std::uint32_t>(std::popcount(word));
        }
    }

    std::vector<std::uint64_t> words_;
    std::vector<std::uint32_t> ranks_;
    std::vector<std::uint32_t> offsets_{0};
    std::vector<entry> entries_;
};

} // namespace genrender

#include <genrender/core/end_header.inl>
