// SPDX-License-Identifier: MIT
// A self-attention module made of three small matrices, which counts how often each is applied.
#pragma once

#include <genrender/core/stack.hpp>
#include <genrender/core/strided_view.hpp>

#include <genrender/testing/random_stack.hpp>

#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace genrender::testing {

/// Projections W f with W [channels, channels]; `queries`, `keys` and `values` count the frames that were projected.
template <class Real>
struct matrix_module {
    stack<Real, 2> W_Q;
    stack<Real, 2> W_K;
    stack<Real, 2> W_V;
    std::size_t head_count = 1;
    mutable std::atomic<std::size_t> queries{0};
    mutable std::atomic<std::size_t> keys{0};
    mutable std::atomic<std::size_t> values{0};

    /// Matrices of zeros.
    explicit matrix_module(std::size_t channels)
        : W_Q({channels, channels}), W_K({channels, channels}), W_V({channels, channels}) {}

    /// Random matrices whose entries have variance 1 / channels, so that features keep their size.
    matrix_module(std::size_t channels, std::size_t heads, std::uint64_t seed) : matrix_module(channels) {
        head_count = heads;
        for (auto* const W : {&W_Q, &W_K, &W_V}) {
            *W = random_stack<Real, 2>({channels, channels}, ++seed);
            for (std::size_t e = 0; e < W->size(); ++e) {
                W->data()[e] /= std::sqrt(static_cast<Real>(channels));
            }
        }
    }

    std::size_t heads() const { return head_count; }
    void query(strided_view<Real, 2> out, strided_view<Real const, 2> f) const {
        ++queries;
        apply(out, f, W_Q);
    }
    void key(strided_view<Real, 2> out, strided_view<Real const, 2> f) const {
        ++keys;
        apply(out, f, W_K);
    }
    void value(strided_view<Real, 2> out, strided_view<Real const, 2> f) const {
        ++values;
        apply(out, f, W_V);
    }

private:
    static void apply(strided_view<Real, 2> out, strided_view<Real const, 2> f, stack<Real, 2> const& W) {
        for (std::size_t t = 0; t < f.extent(0); ++t) {
            for (std::size_t c = 0; c < f.extent(1); ++c) {
                out(t, c) = 0;
                for (std::size_t k = 0; k < f.extent(1); ++k) {
                    out(t, c) += W(c, k) * f(t, k);
                }
            }
        }
    }
};

} // namespace genrender::testing
