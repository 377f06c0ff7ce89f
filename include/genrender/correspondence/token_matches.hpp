// SPDX-License-Identifier: MIT
// Which tokens of a frame show what the tokens of another show, kept from step to step as far as memory goes.
#pragma once

#include <genrender/core/index.hpp>

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

namespace genrender {

/// For every token of one frame, the token of another frame that shows the same surface point.
struct token_matches {
    std::vector<std::uint32_t> tokens;  ///< 0 where none does
    std::vector<std::uint8_t> is_shown; ///< 1 where one does
    std::vector<double> qualities;      ///< how well, see graded_correspondence_map; 0 where none does

    /// None for any token.
    explicit token_matches(std::size_t count) : tokens(count), is_shown(count), qualities(count) {}

    std::size_t byte_count() const {
        return sizeof(*this) + tokens.size() * (sizeof(std::uint32_t) + sizeof(std::uint8_t) + sizeof(double));
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
            if (auto const known = kept_.find(frames); known != kept_.end()) {
                return known->second;
            }
        }
        // Made without the lock: two threads may make the same, which is the same.
        auto const made = std::make_shared<token_matches const>(make());
        std::lock_guard const lock(mutex_);
        if (bytes_ + made->byte_count() <= most_bytes_ && kept_.emplace(frames, made).second) {
            bytes_ += made->byte_count();
        }
        return made;
    }

    /// Bytes of all that is kept.
    std::size_t byte_count() const {
        std::lock_guard const lock(mutex_);
        return bytes_;
    }

private:
    std::size_t most_bytes_;
    std::size_t bytes_ = 0;
    std::map<std::pair<frame_index, frame_index>, std::shared_ptr<token_matches const>> kept_;
    mutable std::mutex mutex_;
};

} // namespace genrender
