// SPDX-License-Identifier: MIT
// Which tokens of a frame show what the tokens of another show, kept from step to step as far as memory goes.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/chunked_memory.hpp>
#include <genrender/core/index.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <memory_resource>
#include <mutex>
#include <utility>
#include <vector>

namespace genrender {

/// For every token of one frame, the token of another frame that shows the same surface point.
struct token_matches {
    std::pmr::vector<std::uint32_t> tokens;  ///< 0 where none does
    std::pmr::vector<std::uint8_t> is_shown; ///< 1 where one does
    std::pmr::vector<float> qualities;       ///< how well, see graded_correspondence_map; 0 where none does

    /// None for any token.
    explicit token_matches(std::size_t count) : tokens(count), is_shown(count), qualities(count) {}
    /// A copy in some memory.
    token_matches(token_matches const& from, std::pmr::memory_resource* memory)
        : tokens(from.tokens, memory), is_shown(from.is_shown, memory), qualities(from.qualities, memory) {}

    /// Bytes of the matches of so many tokens and of keeping them.
    static constexpr std::size_t bytes_of(std::size_t count) {
        constexpr std::size_t of_keeping = 48; // pair of frames, links
        return sizeof(token_matches) + of_keeping +
               count * (sizeof(std::uint32_t) + sizeof(std::uint8_t) + sizeof(float));
    }
};

/// Matches of pairs of frames, which never change in a run and are asked for again whenever a frame is drawn as a
/// keyframe again. Keeps those that came first, up to a number of bytes; may be used from several threads.
class kept_matches {
public:
    explicit kept_matches(std::size_t most_bytes) : most_bytes_(most_bytes) {}

    /// The matches of a pair, made by `make()` unless they are kept.
    template <class Make>
    std::shared_ptr<token_matches const> of(frame_index from, frame_index to, Make&& make) {
        std::pair const frames(from, to);
        {
            std::lock_guard const lock(mutex_);
            if (auto const known = kept_->pairs.find(frames); known != kept_->pairs.end()) {
                return {kept_, &known->second};
            }
        }
        // Made without the lock: two threads may make the same, which is the same.
        auto made = std::make_shared<token_matches const>(make());
        auto const bytes = token_matches::bytes_of(made->tokens.size());
        std::lock_guard const lock(mutex_);
        if (bytes_ + bytes > most_bytes_) {
            return made;
        }
        auto const [place, is_new] = kept_->pairs.try_emplace(frames, *made, &kept_->memory);
        bytes_ += is_new ? bytes : 0;
        return {kept_, &place->second};
    }

    /// Bytes of all that is kept.
    std::size_t byte_count() const {
        std::lock_guard const lock(mutex_);
        return bytes_;
    }

    /// Bytes for `pairs` pairs of so many tokens where at most `most_bytes` may be kept, in whole chunks of memory.
    static constexpr std::size_t expected_bytes(std::size_t pairs, std::size_t tokens, std::size_t most_bytes) {
        auto const a_pair = token_matches::bytes_of(tokens);
        auto const bytes = std::min(pairs, most_bytes / a_pair) * a_pair;
        constexpr auto chunk = chunked_memory::chunk_bytes;
        return (bytes + chunk - 1) / chunk * chunk;
    }

private:
    struct store {
        chunked_memory memory;
        std::pmr::map<std::pair<frame_index, frame_index>, token_matches> pairs{&memory};
    };

    std::size_t most_bytes_;
    std::size_t bytes_ = 0;
    std::shared_ptr<store> kept_ = std::make_shared<store>();
    mutable std::mutex mutex_;
};

} // namespace genrender

#include <genrender/core/end_header.inl>
