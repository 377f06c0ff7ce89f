// SPDX-License-Identifier: MIT
// The matrix product of all layers: weights in panels two registers wide, features read where they lie.
#pragma once

#include <genrender/core/vector_lanes.hpp>
#include <genrender/core/parallel.hpp>
#include <genrender/core/strided_view.hpp>
#include <genrender/reference/feature_memory.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <span>

// A tile of the result, some tokens by one panel, stays in registers while all inputs pass: one load of weights serves
// all tokens of the tile, one number of a feature both registers of the panel. An output is one sum over the inputs in
// their order, whatever tile or thread it falls into. Convolutions need no gathered neighbourhoods: in a padded map a
// 3x3 neighbourhood is three runs of numbers, and those of neighbouring tokens share most of their cache lines.

namespace genrender::reference {

/// Where the inputs of output tokens lie: those of token t begin (t / width) row_stride + (t % width) token_stride
/// numbers after `first`, and are `runs` runs of `run_length` neighbouring numbers, run_stride apart.
template <class Real>
struct token_inputs {
    Real const* first;
    std::size_t width;
    std::ptrdiff_t token_stride;
    std::ptrdiff_t row_stride;
    std::size_t runs;
    std::size_t run_length;
    std::ptrdiff_t run_stride;

    /// Of a matrix [tokens, inputs] with contiguous rows.
    static token_inputs rows_of(strided_view<Real const, 2> const& in) {
        return {in.data(), std::max<std::size_t>(1, in.extent(0)), in.stride(0), 0, 1, in.extent(1), 0};
    }
};

/// What a product adds to its result.
template <class Real>
struct product_terms {
    std::span<Real const> bias{};           ///< [outputs], or nothing
    strided_view<Real const, 2> residual{}; ///< [tokens, outputs], or nothing; may be the result's own memory
};

/// A matrix [inputs, outputs].
template <class Real>
class weight_panels {
public:
    weight_panels() = default;

    /// Element (i, o) is `weight_of(i, o)`.
    template <class WeightOf>
    weight_panels(std::size_t inputs, std::size_t outputs, WeightOf const& weight_of)
        : inputs_(inputs), outputs_(outputs), weights_(inputs * ((outputs + lane - 1) / lane * lane)) {
        auto* to = weights_.data();
        for (std::size_t first = 0; first < outputs; first += panel) {
            auto const width = outputs - first > lane ? panel : lane;
            for (std::size_t i = 0; i < inputs; ++i) {
                for (std::size_t o = first; o < first + width; ++o) {
                    *to++ = o < outputs ? weight_of(i, o) : Real{0};
                }
            }
        }
    }

    std::size_t inputs() const { return inputs_; }
    std::size_t outputs() const { return outputs_; }

    /// Writes the product with the inputs of each token, and what is added to it, into `out` [tokens, outputs], whose
    /// rows are contiguous. Tokens are shared out over `loop`.
    template <parallel_loop Loop = sequential_loop>
    void multiply(strided_view<Real, 2> out, token_inputs<Real> const& in, product_terms<Real> const& terms = {},
                  Loop const& loop = Loop()) const {
        auto const tokens = out.extent(0);
        // The inputs of a chunk and one panel stay in the second cache while all panels pass over the chunk.
        constexpr std::size_t cached = std::size_t{1} << 17;
        auto const numbers = tokens * static_cast<std::size_t>(std::max<std::ptrdiff_t>(1, std::abs(in.token_stride)));
        auto const chunks = std::max((numbers + cached - 1) / cached, (tokens + 1023) / 1024);
        auto const chunk = ((tokens + chunks - 1) / std::max<std::size_t>(chunks, 1) + rows - 1) / rows * rows;
        constexpr auto columns = 4 * panel; // of a thread's share
        auto const shares = (outputs_ + columns - 1) / columns;
        loop(chunks * shares, [&](std::size_t i) {
            auto const begin = std::min(tokens, i / shares * chunk);
            auto const end = std::min(tokens, begin + chunk);
            auto first = i % shares * columns;
            for (auto const last = std::min(outputs_, first + columns); first < last; first += panel) {
                if (outputs_ - first > lane) {
                    run_panel<2>(out, in, terms, begin, end, first);
                } else {
                    run_panel<1>(out, in, terms, begin, end, first);
                }
            }
        });
    }

private:
    static constexpr auto lane = genrender::detail::lane_count<Real>;
    static constexpr auto panel = 2 * lane;
    /// Tokens of a tile: with two registers each they fill the register file but for weights and one number.
    static constexpr std::size_t rows = genrender::detail::many_vector_registers ? 12 : 6;

    template <std::size_t Width>
    void run_panel(strided_view<Real, 2> const& out, token_inputs<Real> const& in, product_terms<Real> const& terms,
                   std::size_t begin, std::size_t end, std::size_t first) const {
        Real bias[panel] = {};
        if (!terms.bias.empty()) {
            std::copy_n(terms.bias.data() + first, std::min(panel, outputs_ - first), bias);
        }
        auto token = begin;
        for (; token + rows <= end; token += rows) {
            run_tile<rows, Width>(out, in, terms, bias, token, first);
        }
        for (; token + 4 <= end; token += 4) {
            run_tile<4, Width>(out, in, terms, bias, token, first);
        }
        for (; token < end; ++token) {
            run_tile<1, Width>(out, in, terms, bias, token, first);
        }
    }

    template <std::size_t Rows, std::size_t Width>
    void run_tile(strided_view<Real, 2> const& out, token_inputs<Real> const& in, product_terms<Real> const& terms,
                  Real const* bias, std::size_t token, std::size_t first) const {
        using genrender::detail::unrolled;
        using vector = genrender::detail::lanes<Real>;
        Real const* at[Rows];
        auto column = token % in.width;
        auto const* row_begin = in.first + static_cast<std::ptrdiff_t>(token / in.width) * in.row_stride;
        unrolled<Rows>([&](auto r) GENRENDER_ALWAYS_INLINE {
            at[r] = row_begin + static_cast<std::ptrdiff_t>(column) * in.token_stride;
            if (++column == in.width) {
                column = 0;
                row_begin += in.row_stride;
            }
        });
        vector sum[Rows][Width];
        unrolled<Width>([&](auto w) GENRENDER_ALWAYS_INLINE {
            auto const b = genrender::detail::load(bias + w * lane);
            unrolled<Rows>([&](auto r) GENRENDER_ALWAYS_INLINE { sum[r][w] = b; });
        });
        auto const* weights = weights_.data() + first * inputs_;
        for (std::size_t run = 0; run < in.runs; ++run) {
            for (std::size_t i = 0; i < in.run_length; ++i, weights += Width * lane) {
                vector weight[Width];
                unrolled<Width>(
                    [&](auto w) GENRENDER_ALWAYS_INLINE { weight[w] = genrender::detail::load(weights + w * lane); });
                unrolled<Rows>([&](auto r) GENRENDER_ALWAYS_INLINE {
                    auto const x = genrender::detail::spread(at[r][i]);
                    unrolled<Width>([&](auto w) GENRENDER_ALWAYS_INLINE { sum[r][w] += x * weight[w]; });
                });
            }
            unrolled<Rows>([&](auto r) GENRENDER_ALWAYS_INLINE { at[r] += in.run_stride; });
        }

        auto const count = std::min(Width * lane, outputs_ - first);
        unrolled<Rows>([&](auto r) GENRENDER_ALWAYS_INLINE {
            auto* const to = out[token + r].data() + first;
            auto const* const residual =
                terms.residual.data() == nullptr ? nullptr : terms.residual[token + r].data() + first;
            if (count == Width * lane) {
                unrolled<Width>([&](auto w) GENRENDER_ALWAYS_INLINE {
                    genrender::detail::store(
                        to + w * lane,
                        residual == nullptr ? sum[r][w] : sum[r][w] + genrender::detail::load(residual + w * lane));
                });
            } else {
                Real part[Width * lane];
                unrolled<Width>([&](auto w)
                                    GENRENDER_ALWAYS_INLINE { genrender::detail::store(part + w * lane, sum[r][w]); });
                for (std::size_t o = 0; o < count; ++o) {
                    to[o] = residual == nullptr ? part[o] : part[o] + residual[o];
                }
            }
        });
    }

    std::size_t inputs_ = 0;
    std::size_t outputs_ = 0;
    feature_memory<Real> weights_;
};

} // namespace genrender::reference
