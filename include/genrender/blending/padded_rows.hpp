// SPDX-License-Identifier: MIT
// A plan's rows as arrays of a fixed width with alpha folded in, as static graphs and devices take them.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/error.hpp>
#include <genrender/core/finite.hpp>
#include <genrender/core/sparse_rows.hpp>
#include <genrender/core/strided_view.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

namespace genrender {

/// The memory that padded rows of a call are written to, an engine's own or that of padded_rows:
///     F_out[i, t] = own[i, t] * F_hat[i, t] + sum over w of weights[i, t, w] * F_KF[index[i, t, w]]
/// with F_KF read as [keyframes * tokens, channels]. It has the values of what `mix` is handed.
template <class Real>
struct padded_rows_view {
    strided_view<std::int32_t, 3> index; ///< [frames, tokens, width] row of F_KF; 0 in an entry that is not used
    strided_view<Real, 3> weights;       ///< [frames, tokens, width] alpha times the plan's; 0 in an entry not used
    strided_view<Real, 2> own;           ///< [frames, tokens] 1 - alpha, or 1 where no keyframe covers the token
};

/// Padded rows of the frames of a call, in memory of its own; every array is row-major without gaps and may be written.
template <class Real>
struct padded_rows {
    std::size_t frames = 0;          ///< of the call
    std::size_t tokens = 0;          ///< of a frame
    std::size_t width = 0;           ///< W, entries of every row
    std::vector<std::int32_t> index; ///< [frames, tokens, width], as in padded_rows_view
    std::vector<Real> weights;       ///< [frames, tokens, width], as in padded_rows_view
    std::vector<Real> own;           ///< [frames, tokens], as in padded_rows_view

    /// The arrays with their axes.
    padded_rows_view<Real> view() {
        return {{index.data(), {frames, tokens, width}},
                {weights.data(), {frames, tokens, width}},
                {own.data(), {frames, tokens}}};
    }
};

/// Entries of the longest row of a plan; 0 if it covers nothing.
template <class Real>
std::size_t row_width(sparse_rows<Real> const& rows) {
    std::size_t width = 0;
    for (std::size_t t = 0; t < rows.row_count(); ++t) {
        width = std::max<std::size_t>(width, rows.offsets[t + 1] - rows.offsets[t]);
    }
    return width;
}

namespace detail {

/// The number of a row of F_KF as engines count.
inline std::int32_t int32_row(char const* function, std::uint32_t source) {
    require_value(source <= static_cast<std::uint32_t>(std::numeric_limits<std::int32_t>::max()), function,
                  "rows.sources", source, "rows of features that an int32 counts");
    return static_cast<std::int32_t>(source);
}

} // namespace detail

/// Writes the rows of a call as `mix` is handed them, one plan a frame. Throws shape_error if `out` is of other frames
/// or tokens, value_error if a row has more entries than `out` is wide, a source is beyond int32 or alpha is not finite.
template <class Real>
void write_padded_rows(padded_rows_view<Real> const& out, std::type_identity_t<std::span<sparse_rows<Real> const>> rows,
                       std::type_identity_t<Real> alpha) {
    constexpr auto here = "write_padded_rows";
    require_value(is_finite(alpha), here, "alpha", alpha, "a finite number");
    auto const tokens = rows.empty() ? 0 : rows.front().row_count();
    auto const width = out.index.extent(2);
    require_shape(here, "index", out.index, {rows.size(), tokens, width});
    require_shape(here, "weights", out.weights, {rows.size(), tokens, width});
    require_shape(here, "own", out.own, {rows.size(), tokens});
    for (std::size_t i = 0; i < rows.size(); ++i) {
        require_extents(here, "rows", std::array{rows[i].row_count()}, std::array{tokens});
        for (std::size_t t = 0; t < tokens; ++t) {
            std::size_t const first = rows[i].offsets[t];
            std::size_t const count = rows[i].offsets[t + 1] - first;
            if (count > width) {
                throw value_error(std::string(here) + ": rows[" + std::to_string(i) + "] has a row of " +
                                  std::to_string(count) + " entries, expected at most the width " +
                                  std::to_string(width));
            }
            out.own(i, t) = count > 0 ? 1 - alpha : Real{1};
            for (std::size_t w = 0; w < width; ++w) {
                out.index(i, t, w) = w < count ? detail::int32_row(here, rows[i].sources[first + w]) : 0;
                out.weights(i, t, w) = w < count ? alpha * rows[i].weights[first + w] : Real{0};
            }
        }
    }
}

/// The rows of a call as `mix` is handed them, `width` entries each; without a width as many as the longest row has.
/// Throws as write_padded_rows does. For one frame: `make_padded_rows(std::span(&rows, 1), alpha)`.
template <class Real>
padded_rows<Real> make_padded_rows(std::span<sparse_rows<Real> const> rows, std::type_identity_t<Real> alpha,
                                   std::optional<std::size_t> width = std::nullopt) {
    padded_rows<Real> result;
    result.frames = rows.size();
    result.tokens = rows.empty() ? 0 : rows.front().row_count();
    for (auto const& one : rows) {
        result.width = std::max(result.width, row_width(one));
    }
    result.width = width.value_or(result.width);
    result.index.resize(result.frames * result.tokens * result.width);
    result.weights.resize(result.index.size());
    result.own.resize(result.frames * result.tokens);
    write_padded_rows<Real>(result.view(), rows, alpha);
    return result;
}

/// The same of a vector of rows, as feature_inputs has it.
template <class Real>
padded_rows<Real> make_padded_rows(std::vector<sparse_rows<Real>> const& rows, std::type_identity_t<Real> alpha,
                                   std::optional<std::size_t> width = std::nullopt) {
    return make_padded_rows<Real>(std::span<sparse_rows<Real> const>(rows), alpha, width);
}

/// Replaces F [frames, tokens, channels] by F_out as padded_rows_view defines it, with F_KF [keyframes, tokens,
/// channels]: the definition in plain loops, which equals mix_rows up to rounding. Throws shape_error for other extents,
/// value_error for an index beyond F_KF.
template <class Real>
void mix_padded_rows(strided_view<Real, 3> F, in_view<Real, 3> F_KF, padded_rows_view<Real> const& rows) {
    constexpr auto here = "mix_padded_rows";
    auto const [frames, tokens, channels] = F.extents();
    auto const width = rows.index.extent(2);
    require_shape(here, "F_KF", F_KF, {F_KF.extent(0), F_KF.extent(1), channels});
    require_shape(here, "index", rows.index, {frames, tokens, width});
    require_shape(here, "weights", rows.weights, {frames, tokens, width});
    require_shape(here, "own", rows.own, {frames, tokens});
    auto const of_frame = F_KF.extent(1);
    for (std::size_t i = 0; i < frames; ++i) {
        for (std::size_t t = 0; t < tokens; ++t) {
            for (std::size_t c = 0; c < channels; ++c) {
                F(i, t, c) *= rows.own(i, t);
            }
            for (std::size_t w = 0; w < width; ++w) {
                auto const index = rows.index(i, t, w);
                require_value(index >= 0 && static_cast<std::size_t>(index) < F_KF.extent(0) * of_frame, here, "index",
                              index, "a row of the features' keyframes and tokens");
                auto const source = static_cast<std::size_t>(index);
                for (std::size_t c = 0; c < channels; ++c) {
                    F(i, t, c) += rows.weights(i, t, w) * F_KF(source / of_frame, source % of_frame, c);
                }
            }
        }
    }
}

} // namespace genrender

#include <genrender/core/end_header.inl>
