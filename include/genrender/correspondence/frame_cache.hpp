// SPDX-License-Identifier: MIT
// A cache of what is made of frames and costs too much memory to have of all: of those that were asked for last.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/index.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

namespace genrender {

/// Values that are made of single frames, those that were asked for last. May be used from several threads,
/// which wait long for each other only where they ask for the same frame.
template <class Value>
class frame_cache {
public:
    /// Of at most so many values, and one at least.
    explicit frame_cache(std::size_t most) : most_(std::max<std::size_t>(most, 1)) {}

    /// Makes room for so many, for one who asks for them in turn: with less room none would ever be found.
    void grow_to(std::size_t most) {
        std::lock_guard const lock(mutex_);
        most_ = std::max(most_, most);
    }

    /// The value of a frame, made by `make()` unless the cache has it; then the one that was asked for longest ago goes.
    /// What `make` throws goes to the caller, and the next one makes it anew.
    template <class Make>
    std::shared_ptr<Value const> of(frame_index frame, Make&& make) {
        auto const place = place_of(frame);
        std::lock_guard const lock(place->mutex);
        if (!place->value) {
            place->value = std::make_shared<Value const>(make());
        }
        return place->value;
    }

private:
    struct place_type {
        std::mutex mutex;
        std::shared_ptr<Value const> value;
    };
    struct entry {
        frame_index frame;
        std::uint64_t asked; ///< when, counted in questions
        std::shared_ptr<place_type> place;
    };

    std::shared_ptr<place_type> place_of(frame_index frame) {
        std::lock_guard const lock(mutex_);
        ++asked_;
        auto const known =
            std::find_if(entries_.begin(), entries_.end(), [&](entry const& e) { return e.frame == frame; });
        if (known != entries_.end()) {
            known->asked = asked_;
            return known->place;
        }
        auto place = std::make_shared<place_type>();
        if (entries_.size() < most_) {
            entries_.push_back({frame, asked_, place});
        } else {
            *std::min_element(entries_.begin(), entries_.end(), [](entry const& a, entry const& b) {
                return a.asked < b.asked;
            }) = {frame, asked_, place};
        }
        return place;
    }

    std::size_t most_;
    std::uint64_t asked_ = 0;
    std::vector<entry> entries_;
    std::mutex mutex_;
};

} // namespace genrender

#include <genrender/core/end_header.inl>
