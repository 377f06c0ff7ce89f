// SPDX-License-Identifier: MIT
// [GR alg. 1: Phi as a static graph] Which of an engine's graphs a call takes, and the arrays that it reads.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/attention/attention_site.hpp>
#include <genrender/core/error.hpp>
#include <genrender/core/plan_key.hpp>
#include <genrender/core/sparse_rows.hpp>
#include <genrender/core/strided_view.hpp>
#include <genrender/injection/feature_io.hpp>
#include <genrender/sampling/run_shapes.hpp>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

namespace genrender {

/// What a graph does at the places that take part in a run.
enum class graph_pass : std::uint8_t {
    plain,    ///< eq. 1: every frame is left to itself
    keyframe, ///< eq. 3, and features are recorded
    injected  ///< eqs. 5 and 6 with what was recorded
};

/// The pass that a processor runs, and by that the graph that a call takes. Throws as inputs_at does for an engine of
/// these abilities.
template <class Features, class Real, class Processor>
graph_pass graph_pass_of(Processor const& processor, run_shapes const& shapes, std::span<frame_index const> frames,
                         graph_abilities able = {}) {
    for (auto const place : shapes.places) {
        auto const in = inputs_for<Features, Real>(processor, place, frames, able);
        if (in.is_recorded || in.attends_to_stack) {
            return graph_pass::keyframe;
        }
        if (in.f_KF != nullptr || in.F_KF != nullptr) {
            return graph_pass::injected;
        }
    }
    return graph_pass::plain;
}

/// Throws value_error unless the inputs of a place are what a graph of a pass was built for by the shapes of the run.
template <class Features, class Real>
void require_inputs(feature_inputs<Features, Real> const& in, graph_pass pass, run_shapes const& shapes,
                    std::span<frame_index const> frames) {
    auto const is_injected = pass == graph_pass::injected;
    auto const is_keyframe = pass == graph_pass::keyframe;
    require_value((in.f_KF != nullptr) == (is_injected && shapes.joins_keyframes) &&
                      (in.F_KF != nullptr) == (is_injected && shapes.mixes_rows) &&
                      in.attends_to_stack == (is_keyframe && shapes.attends_to_stack),
                  "require_inputs", "in", "of another pass", "what shapes and pass say of every place");
    require_value(!is_keyframe || frames.size() == shapes.keyframes, "require_inputs", "frames.size()", frames.size(),
                  "as many keyframes in every step as shapes say");
    require_value(in.scales.empty() || in.scales.size() == frames.size(), "require_inputs", "in.scales.size()",
                  in.scales.size(), "one for each frame");
}

/// Writes what eq. 5 adds to the products of queries and keys, out [frames, tokens (1 + m)]: minus infinity along the
/// keyframe that a frame leaves out, 0 elsewhere. Throws value_error if a keyframe lies beyond `out`.
template <class Real>
void write_left_out(strided_view<Real, 2> out, std::span<std::optional<std::size_t> const> left_out,
                    std::size_t tokens) {
    for (std::size_t i = 0; i < out.extent(0); ++i) {
        auto const left = i < left_out.size() ? left_out[i] : std::nullopt;
        require_value(!left || (*left + 2) * tokens <= out.extent(1), "write_left_out", "left_out", left.value_or(0),
                      "a keyframe of those that are joined");
        for (std::size_t t = 0; t < out.extent(1); ++t) {
            out(i, t) = left && t / tokens == *left + 1 ? -std::numeric_limits<Real>::infinity() : Real{0};
        }
    }
}

/// Remembers which rows of a call were uploaded last, so that equal ones need not be again.
template <class Real>
class uploaded_rows {
public:
    /// Whether the rows of a call and alpha are those of the last `set`; false for rows without keys.
    bool holds(std::span<sparse_rows<Real> const> rows, Real alpha) const {
        auto const keys = keys_of(rows);
        return !keys.empty() && keys == keys_ && alpha == alpha_;
    }
    /// The rows that were uploaded now.
    void set(std::span<sparse_rows<Real> const> rows, Real alpha) {
        keys_ = keys_of(rows);
        alpha_ = alpha;
    }

private:
    /// Keys of all rows; none if one has none.
    static std::vector<plan_key> keys_of(std::span<sparse_rows<Real> const> rows) {
        std::vector<plan_key> keys;
        for (auto const& one : rows) {
            if (!one.key) {
                return {};
            }
            keys.push_back(*one.key);
        }
        return keys;
    }

    std::vector<plan_key> keys_;
    Real alpha_ = 0;
};

} // namespace genrender

#include <genrender/core/end_header.inl>
