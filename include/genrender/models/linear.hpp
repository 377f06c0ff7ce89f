// SPDX-License-Identifier: MIT
// The fully connected layer: out = in W^T + b.
#pragma once

#include <genrender/core/linalg.hpp>
#include <genrender/models/weights.hpp>

#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

namespace genrender {

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

    std::size_t in_channels() const { return static_cast<std::size_t>(weight_.cols()); }
    std::size_t out_channels() const { return static_cast<std::size_t>(weight_.rows()); }

    /// Writes in W^T + b [tokens, out] for `in` [tokens, in]; rows of both contiguous. Throws shape_error if they do
    /// not fit.
    void operator()(strided_view<Real, 2> out, in_view<Real, 2> in) const {
        require_fit(out, in);
        to_matrix(out).noalias() = to_matrix(in) * weight_.transpose();
        add_bias(out);
    }

    /// Adds in W^T + b to `out`: the last layer of a residual branch.
    void add_to(strided_view<Real, 2> out, in_view<Real, 2> in) const {
        require_fit(out, in);
        to_matrix(out).noalias() += to_matrix(in) * weight_.transpose();
        add_bias(out);
    }

private:
    linear(weights<Real>& source, std::string const& name, std::vector<std::size_t> const& shape, bool has_bias) {
        // Asked for before there is memory for it, so that a wrong config is told by name.
        auto const values = source.take(name + ".weight", shape);
        weight_.resize(static_cast<Eigen::Index>(shape[0]), static_cast<Eigen::Index>(shape[1]));
        std::copy(values.begin(), values.end(), weight_.data());
        if (has_bias) {
            bias_ = source.take(name + ".bias", {shape[0]});
        }
    }

    void require_fit(strided_view<Real, 2> out, in_view<Real, 2> in) const {
        require_shape("linear", "in", in, {in.extent(0), in_channels()});
        require_shape("linear", "out", out, {in.extent(0), out_channels()});
    }

    void add_bias(strided_view<Real, 2> out) const {
        if (bias_.empty()) {
            return;
        }
        for (std::size_t token = 0; token < out.extent(0); ++token) {
            auto const row = out[token].row();
            for (std::size_t c = 0; c < row.size(); ++c) {
                row[c] += bias_[c];
            }
        }
    }

    matrix<Real> weight_;
    std::vector<Real> bias_;
};

} // namespace genrender
