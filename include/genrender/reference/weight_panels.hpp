// SPDX-License-Identifier: MIT
// The matrix product of all layers: weights in panels two registers wide, features read where they lie.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/half_precision.hpp>
#include <genrender/core/half_storage.hpp>
#include <genrender/core/instance.hpp>
#include <genrender/core/parallel.hpp>
#include <genrender/core/stack.hpp>
#include <genrender/core/strided_view.hpp>
#include <genrender/core/vectors.hpp>
#include <genrender/reference/weight_storage.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <span>
#include <type_traits>
#include <utility>
#include <variant>

namespace genrender::reference {

/// Where the inputs of output tokens lie: those of token t begin (t / width) row_stride + (t % width) token_stride
/// numbers after `first`, and are `runs` runs of `run_length` neighbouring numbers, run_stride apart.
template <class Real>
struct token_inputs {
    Real const* first;           ///< first number of the first token
    std::size_t width;           ///< tokens in a row
    std::ptrdiff_t token_stride; ///< numbers from a token to the next in its row
    std::ptrdiff_t row_stride;   ///< numbers from a row's first token to the next row's
    std::size_t runs;            ///< runs that a token's numbers are of
    std::size_t run_length;      ///< numbers of a run
    std::ptrdiff_t run_stride;   ///< numbers from a run to the next

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

namespace internal {

/// What the tiles of a vector target look like.
struct panel_layout {
    std::size_t lanes; ///< outputs of a register; a panel has two
    std::size_t rows;  ///< tokens of a tile
};

/// Weights in panels: of two registers of outputs after the other, inputs by outputs; the last one may have one.
template <class Stored>
struct panel_weights {
    Stored const* data;
    std::size_t inputs;
    std::size_t outputs;
};

} // namespace internal

} // namespace genrender::reference

#define GENRENDER_KERNELS <genrender/reference/weight_panels.inl>
#include <genrender/core/each_target.inl>

namespace genrender::reference {

/// A matrix [inputs, outputs], laid out for the vector target that is chosen when it is made, at which its products run
/// whatever is chosen later.
template <class Real>
class weight_panels {
public:
    weight_panels() = default;

    /// Element (i, o) is `weight_of(i, o)`, rounded to what it is kept in.
    template <class WeightOf>
    weight_panels(std::size_t inputs, std::size_t outputs, WeightOf const& weight_of,
                  weight_storage storage = weight_storage::real)
        : target_(chosen_vector_target()), layout_(GENRENDER_KERNEL_OF(target_, internal, layout_of_panels<Real>)()),
          inputs_(inputs), outputs_(outputs) {
        if (storage == weight_storage::float16) {
            fill<kept<float16_bits>>([&](std::size_t i, std::size_t o) {
                return float16_bits{half_of_float(static_cast<float>(weight_of(i, o)))};
            });
        } else if (storage == weight_storage::bfloat16) {
            fill<kept<bfloat16_bits>>([&](std::size_t i, std::size_t o) {
                return bfloat16_bits{bfloat16_of_float(static_cast<float>(weight_of(i, o)))};
            });
        } else {
            fill<Real>(weight_of);
        }
    }

    /// Extents without weights, of which no product can be asked.
    static weight_panels of_extents(std::size_t inputs, std::size_t outputs) {
        weight_panels result;
        result.inputs_ = inputs;
        result.outputs_ = outputs;
        return result;
    }

    /// Bytes of memory that the weights take.
    std::size_t bytes() const {
        return std::visit([]<class Stored>(stack<Stored, 1> const& weights) { return weights.size() * sizeof(Stored); },
                          weights_);
    }
    /// Numbers of a token that it takes.
    std::size_t inputs() const { return inputs_; }
    /// Numbers of a token that it gives.
    std::size_t outputs() const { return outputs_; }

    /// Writes the product with the inputs of each token, and what is added to it, into `out` [tokens, outputs], whose
    /// rows are contiguous. Tokens are shared out over `loop`.
    void multiply(strided_view<Real, 2> out, token_inputs<Real> const& in, product_terms<Real> const& terms = {},
                  any_loop const& loop = {}) const;

private:
    /// What a product reads: 16 bits where it computes in float; one in double, which nobody would run for its memory,
    /// reads their values in double.
    template <class Bits>
    using kept = std::conditional_t<std::is_same_v<Real, float>, Bits, Real>;
    using kept_weights =
        std::conditional_t<std::is_same_v<Real, float>,
                           std::variant<stack<Real, 1>, stack<float16_bits, 1>, stack<bfloat16_bits, 1>>,
                           std::variant<stack<Real, 1>>>;

    template <class Stored, class WeightOf>
    void fill(WeightOf const& weight_of) {
        auto const lane = layout_.lanes;
        auto const panel = 2 * lane;
        auto weights = stack<Stored, 1>::uninitialized({inputs_ * ((outputs_ + lane - 1) / lane * lane)});
        auto* to = weights.data();
        for (std::size_t first = 0; first < outputs_; first += panel) {
            auto const width = outputs_ - first > lane ? panel : lane;
            for (std::size_t i = 0; i < inputs_; ++i) {
                for (std::size_t o = first; o < first + width; ++o) {
                    *to++ = o < outputs_ ? static_cast<Stored>(weight_of(i, o)) : Stored{};
                }
            }
        }
        weights_ = std::move(weights);
    }

    vector_target target_ = vector_target::baseline;
    internal::panel_layout layout_{1, 1};
    std::size_t inputs_ = 0;
    std::size_t outputs_ = 0;
    kept_weights weights_;
};

template <class Real>
void weight_panels<Real>::multiply(strided_view<Real, 2> out, token_inputs<Real> const& in,
                                   product_terms<Real> const& terms, any_loop const& loop) const {
    auto const tokens = out.extent(0);
    // The inputs of a chunk and one panel stay in the second cache while all panels pass over the chunk.
    constexpr std::size_t cached = std::size_t{1} << 17;
    auto const numbers = tokens * static_cast<std::size_t>(std::max<std::ptrdiff_t>(1, std::abs(in.token_stride)));
    auto const chunks = std::max((numbers + cached - 1) / cached, (tokens + 1023) / 1024);
    auto const rows = layout_.rows;
    auto const chunk = ((tokens + chunks - 1) / std::max<std::size_t>(chunks, 1) + rows - 1) / rows * rows;
    auto const columns = 8 * layout_.lanes; // of a thread's share
    auto const shares = (outputs_ + columns - 1) / columns;
    std::visit(
        [&]<class Stored>(stack<Stored, 1> const& weights) {
            auto const multiply_panels = GENRENDER_KERNEL_OF(target_, internal, multiply_panels<Real, Stored>);
            loop(chunks * shares, [&](std::size_t i) {
                auto const begin = std::min(tokens, i / shares * chunk);
                auto const end = std::min(tokens, begin + chunk);
                auto const first = i % shares * columns;
                multiply_panels({weights.data(), inputs_, outputs_}, out, in, terms, begin, end, first,
                                std::min(outputs_, first + columns));
            });
        },
        weights_);
}

GENRENDER_CLASS_INSTANCE(weight_panels<float>);
GENRENDER_CLASS_INSTANCE(weight_panels<double>);

} // namespace genrender::reference

#include <genrender/core/end_header.inl>
