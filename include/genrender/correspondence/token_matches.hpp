// SPDX-License-Identifier: MIT
// Which tokens of a frame show what the tokens of another show, and a cache of that for the steps of a run.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/index.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <list>
#include <memory>
#include <memory_resource>
#include <mutex>
#include <utility>
#include <vector>

namespace genrender {

/// A token that shows a surface point.
struct token_match {
    token_index token; ///< the token
    float quality = 0; ///< how well: the share of the cell that is the object's, times pixels a unit of area
};

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

    /// Bytes of the matches of so many tokens and of their place in a cache.
    static constexpr std::size_t bytes_of(std::size_t count) {
        constexpr std::size_t of_place = 48; // pair of frames, links
        return sizeof(token_matches) + of_place +
               count * (sizeof(std::uint32_t) + sizeof(std::uint8_t) + sizeof(float));
    }
};

/// Matches of pairs of frames, which never change in a run and are asked for again whenever a frame is drawn as a
/// keyframe again. A cache of those that came first, up to a number of bytes; may be used from several threads.
class match_cache {
public:
    /// Bytes of a chunk of memory, about: it holds the matches of whole pairs, of one at least.
    static constexpr std::size_t chunk_bytes = std::size_t{512} << 10;

    /// Keeps at most so many bytes of matches.
    explicit match_cache(std::size_t most_bytes) : most_bytes_(most_bytes) {}

    /// The matches of a pair, made by `make()` unless they are in the cache.
    template <class Make>
    std::shared_ptr<token_matches const> of(frame_index from, frame_index to, Make&& make) {
        frame_pair const frames(from, to);
        {
            std::lock_guard const lock(mutex_);
            if (auto const* const known = store_->find(frames)) {
                return {store_, known};
            }
        }
        // Made without the lock: two threads may make the same, which is the same.
        auto made = std::make_shared<token_matches const>(make());
        auto const bytes = token_matches::bytes_of(made->tokens.size());
        std::lock_guard const lock(mutex_);
        if (bytes_ + bytes > most_bytes_) {
            return made;
        }
        if (auto const* const known = store_->find(frames)) {
            return {store_, known};
        }
        auto const* const stored = store_->add(frames, *made, bytes);
        bytes_ += bytes;
        return {store_, stored};
    }

    /// Bytes of all matches in the cache.
    std::size_t byte_count() const {
        std::lock_guard const lock(mutex_);
        return bytes_;
    }

    /// Bytes for `pairs` pairs of so many tokens where the cache may have `most_bytes`, in whole chunks of memory.
    static constexpr std::size_t expected_bytes(std::size_t pairs, std::size_t tokens, std::size_t most_bytes) {
        auto const a_pair = token_matches::bytes_of(tokens);
        auto const bytes = std::min(pairs, most_bytes / a_pair) * a_pair;
        return (bytes + chunk_bytes - 1) / chunk_bytes * chunk_bytes;
    }

private:
    using frame_pair = std::pair<frame_index, frame_index>;

    /// Matches are small and stay. Allocated one by one between larger blocks that are freed, they would leave holes
    /// that nothing fits in, and a run of many frames would grow by them; so they lie in chunks, apart from the rest.
    struct store {
        /// Matches and the pair of frames that they are of.
        struct link {
            frame_pair frames;            ///< from, to
            token_matches const* matches; ///< in a chunk
        };
        std::list<std::pmr::monotonic_buffer_resource> chunks;
        std::size_t left = 0;    ///< bytes of the last chunk
        std::vector<link> links; ///< rising by frames

        std::vector<link>::iterator place_of(frame_pair const& frames) {
            return std::lower_bound(links.begin(), links.end(), frames,
                                    [](link const& one, frame_pair const& other) { return one.frames < other; });
        }

        token_matches const* find(frame_pair const& frames) {
            auto const place = place_of(frames);
            return place != links.end() && place->frames == frames ? place->matches : nullptr;
        }

        /// Copies matches of so many bytes. What a chunk holds ends with it and needs no destructor.
        token_matches const* add(frame_pair const& frames, token_matches const& matches, std::size_t bytes) {
            if (bytes > left) {
                left = std::max<std::size_t>(1, chunk_bytes / bytes) * bytes;
                chunks.emplace_back(left);
            }
            left -= bytes;
            std::pmr::polymorphic_allocator<> memory(&chunks.back());
            auto const* const stored = memory.new_object<token_matches>(matches, memory.resource());
            links.insert(place_of(frames), {frames, stored});
            return stored;
        }
    };

    std::size_t most_bytes_;
    std::size_t bytes_ = 0;
    std::shared_ptr<store> store_ = std::make_shared<store>();
    mutable std::mutex mutex_;
};

} // namespace genrender

#include <genrender/core/end_header.inl>
