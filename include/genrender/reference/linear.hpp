// SPDX-License-Identifier: MIT
// The fully connected layer: out = in W^T + b.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/parallel.hpp>
#include <genrender/core/strided_view.hpp>
#include <genrender/reference/panel_source.hpp>
#include <genrender/reference/weight_panels.hpp>
#include <genrender/reference/weights.hpp>

#include <cstddef>
#include <string>
#include <vector>

namespace genrender::reference {

/// A matrix W [out, in] and, unless it has none, a bias [out].
template <class Real>
class linear {
public:
    /// Takes `name.weight` and, if `has_bias`, `name.bias`.
    linear(weights<Real>& source, std::string const& name, std::size_t in, std::size_t out, bool has_bias = true)
        : linear(source, name, {out, in}, has_bias) {}

    /// Takes `name.weight` [out, in, 1, 1] and `name.bias`: the same map, written as a convolution.
    static linear of_1x1_convolution(weights<Real>& source, std::string const& name, std::size_t in, std::size_t out) {
        return {source, name, {out, in, 1, 1}, true};
    }

    /// Channels that it takes.
    std::size_t in_channels() const { return weights_.inputs(); }
    /// Channels that it gives.
    std::size_t out_channels() const { return weights_.outputs(); }

    /// Writes in W^T + b [tokens, out] for `in` [tokens, in]; rows of both contiguous. Tokens are shared out over
    /// `loop`. Throws shape_error if they do not fit.
    void operator()(strided_view<Real, 2> out, in_view<Real, 2> in, any_loop const& loop = {}) const {
        multiply(out, in, {bias_}, loop);
    }

    /// Adds in W^T + b to `out`: the last layer of a residual branch.
    void add_to(strided_view<Real, 2> out, in_view<Real, 2> in, any_loop const& loop = {}) const {
        multiply(out, in, {bias_, out}, loop);
    }

private:
    linear(weights<Real>& source, std::string const& name, std::vector<std::size_t> const& shape, bool has_bias) {
        weights_ = take_panels(source, name + ".weight", shape, shape[1], shape[0],
                               [&](std::size_t input, std::size_t output) { return output * shape[1] + input; });
        if (has_bias) {
            bias_ = source.take(name + ".bias", {shape[0]});
        }
    }

    void multiply(strided_view<Real, 2> out, in_view<Real, 2> in, product_terms<Real> const& terms,
                  any_loop const& loop) const {
        auto const tokens = in.extent(0);
        require_shape("linear", "in", in, {tokens, in_channels()});
        require_shape("linear", "out", out, {tokens, out_channels()});
        weights_.multiply(out, token_inputs<Real>::rows_of(in), terms, loop);
    }

    weight_panels<Real> weights_;
    std::vector<Real> bias_;
};

} // namespace genrender::reference

#include <genrender/core/end_header.inl>
