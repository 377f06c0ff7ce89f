// SPDX-License-Identifier: MIT
// Tiles of a matrix product, with the vectors of one target.
//
// A tile of the result, some tokens by one panel, stays in registers while all inputs pass: one load of weights serves
// all tokens of the tile, one number of a feature both registers of the panel. An output is one sum over the inputs in
// their order, whatever tile or thread it falls into. Convolutions need no gathered neighbourhoods: in a padded map a
// 3x3 neighbourhood is three runs of numbers, and those of neighbouring tokens share most of their cache lines.

namespace genrender::reference::internal::GENRENDER_TARGET {

using namespace genrender::detail::GENRENDER_TARGET_NAME;

/// Tokens of a tile: with two registers each they fill the register file but for weights and one number.
inline constexpr std::size_t panel_rows = many_vector_registers ? 12 : 6;

/// How the target's tiles are made.
template <class Real>
panel_layout layout_of_panels() {
    return {lane_count<Real>, panel_rows};
}

/// A tile of `Rows` tokens by a panel of `Width` registers.
template <std::size_t Rows, std::size_t Width, class Real, class Stored>
void run_tile(panel_weights<Stored> const& weights_of, strided_view<Real, 2> const& out, token_inputs<Real> const& in,
              product_terms<Real> const& terms, Real const* bias, std::size_t token, std::size_t first) {
    using vector = lanes<Real>;
    constexpr auto lane = lane_count<Real>;
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
        auto const b = load(bias + w * lane);
        unrolled<Rows>([&](auto r) GENRENDER_ALWAYS_INLINE { sum[r][w] = b; });
    });
    auto const* weights = weights_of.data + first * weights_of.inputs;
    for (std::size_t run = 0; run < in.runs; ++run) {
        for (std::size_t i = 0; i < in.run_length; ++i, weights += Width * lane) {
            vector weight[Width];
            unrolled<Width>([&](auto w)
                                GENRENDER_ALWAYS_INLINE { weight[w] = load_widened<Real>(weights + w * lane); });
            unrolled<Rows>([&](auto r) GENRENDER_ALWAYS_INLINE {
                auto const x = spread(at[r][i]);
                unrolled<Width>([&](auto w) GENRENDER_ALWAYS_INLINE { sum[r][w] += x * weight[w]; });
            });
        }
        unrolled<Rows>([&](auto r) GENRENDER_ALWAYS_INLINE { at[r] += in.run_stride; });
    }

    auto const count = std::min(Width * lane, weights_of.outputs - first);
    unrolled<Rows>([&](auto r) GENRENDER_ALWAYS_INLINE {
        auto* const to = out[token + r].data() + first;
        auto const* const residual =
            terms.residual.data() == nullptr ? nullptr : terms.residual[token + r].data() + first;
        if (count == Width * lane) {
            unrolled<Width>([&](auto w) GENRENDER_ALWAYS_INLINE {
                store(to + w * lane, residual == nullptr ? sum[r][w] : sum[r][w] + load(residual + w * lane));
            });
        } else {
            Real part[Width * lane];
            unrolled<Width>([&](auto w) GENRENDER_ALWAYS_INLINE { store(part + w * lane, sum[r][w]); });
            for (std::size_t o = 0; o < count; ++o) {
                to[o] = residual == nullptr ? part[o] : part[o] + residual[o];
            }
        }
    });
}

/// Tokens [begin, end) by the panel that begins at output `first`.
template <std::size_t Width, class Real, class Stored>
void run_panel(panel_weights<Stored> const& weights_of, strided_view<Real, 2> const& out, token_inputs<Real> const& in,
               product_terms<Real> const& terms, std::size_t begin, std::size_t end, std::size_t first) {
    constexpr auto lane = lane_count<Real>;
    Real bias[2 * lane] = {};
    if (!terms.bias.empty()) {
        std::copy_n(terms.bias.data() + first, std::min(2 * lane, weights_of.outputs - first), bias);
    }
    auto token = begin;
    for (; token + panel_rows <= end; token += panel_rows) {
        run_tile<panel_rows, Width>(weights_of, out, in, terms, bias, token, first);
    }
    for (; token + 4 <= end; token += 4) {
        run_tile<4, Width>(weights_of, out, in, terms, bias, token, first);
    }
    for (; token < end; ++token) {
        run_tile<1, Width>(weights_of, out, in, terms, bias, token, first);
    }
}

/// Writes outputs [first, last) of tokens [begin, end), `first` being where a panel begins.
template <class Real, class Stored>
void multiply_panels(panel_weights<Stored> weights_of, strided_view<Real, 2> out, token_inputs<Real> const& in,
                     product_terms<Real> const& terms, std::size_t begin, std::size_t end, std::size_t first,
                     std::size_t last) {
    constexpr auto lane = lane_count<Real>;
    for (; first < last; first += 2 * lane) {
        if (weights_of.outputs - first > lane) {
            run_panel<2>(weights_of, out, in, terms, begin, end, first);
        } else {
            run_panel<1>(weights_of, out, in, terms, begin, end, first);
        }
    }
}

} // namespace genrender::reference::internal::GENRENDER_TARGET
