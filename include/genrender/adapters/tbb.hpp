// SPDX-License-Identifier: MIT
// A parallel loop over oneTBB's tasks.
#pragma once

#include <genrender/core/begin_header.inl>

#include <cstddef>

#include <tbb/parallel_for.h>

namespace genrender {

/// A model of parallel_loop that makes indices oneTBB's tasks, in the arena of whoever calls it: run it inside a
/// tbb::task_arena to bound its threads. Loops inside others share the arena.
class tbb_loop {
public:
    /// Runs body(i) once for every i below `count`. Throws what the first body threw that did; indices not yet begun are
    /// left out then.
    template <class Body>
    void operator()(std::size_t count, Body&& body) const {
        tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) { body(i); });
    }
};

} // namespace genrender

#include <genrender/core/end_header.inl>
