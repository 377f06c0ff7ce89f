// SPDX-License-Identifier: MIT
// What the keys of each frame count for where several of them show one surface point, and which calls can count.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/attention/attention_call.hpp>
#include <genrender/core/index.hpp>

#include <cassert>
#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace genrender {

/// What each key that a frame attends to at a site counts for, block after block, as many numbers a block.
using key_count_function = std::function<std::vector<float>(site_index site, frame_index frame)>;

/// Sets what the keys of every frame's blocks count for, and gives the numbers, which the blocks point to. A frame that
/// leaves out the joined block left_out[i] has numbers for it all the same; its own block is the first then. Does
/// nothing without a function.
template <class Features>
[[nodiscard]] std::vector<std::vector<float>>
count_keys(attention_sources<Features>& sources, site_index site, std::span<frame_index const> frames,
           key_count_function const& counts_of, std::span<std::optional<std::size_t> const> left_out = {}) {
    std::vector<std::vector<float>> all;
    for (std::size_t i = 0; counts_of && i < frames.size(); ++i) {
        auto const blocks = std::as_const(sources)[i].size();
        auto const drops = !left_out.empty() && left_out[i].has_value();
        auto const dropped = drops ? *left_out[i] : blocks; // behind the last block where none is
        auto const& counts = all.emplace_back(counts_of(site, frames[i]));
        auto const tokens = counts.size() / (blocks + (drops ? 1 : 0));
        assert(tokens * (blocks + (drops ? 1 : 0)) == counts.size() && "count_keys: a number is given for every key");
        for (std::size_t b = 0; b < blocks; ++b) {
            auto const place = b > dropped ? b + 1 : b;
            sources.set_counts(i, b, counts.data() + place * tokens);
        }
    }
    return all;
}

/// An attention_call that counts keys, an optional capability: others are refused where keys do not count for one.
///
/// expression          | type | meaning
/// --------------------|------|----------------------------------------------------------------------------------
/// `Call::counts_keys` | bool | a constant, true: `attend(Q, sources)` adds log(counts[t]) to the logits of key t of
///                     |      | every block that has counts
template <class Call>
concept counting_attention_call = attention_call<Call> && static_cast<bool>(Call::counts_keys);

} // namespace genrender

#include <genrender/core/end_header.inl>
