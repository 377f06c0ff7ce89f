// SPDX-License-Identifier: MIT
// LayerNorm (Ba et al. 2016) of feature maps whose channels lie side by side.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/instance.hpp>
#include <genrender/core/strided_view.hpp>
#include <genrender/core/vectors.hpp>
#include <genrender/reference/weights.hpp>

#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#define GENRENDER_KERNELS <genrender/reference/layer_norm.inl>
#include <genrender/core/each_target.inl>

namespace genrender::reference {

/// The channels of each token to mean 0 and variance 1; then scale and shift a channel.
template <class Real>
class layer_norm {
public:
    /// Takes `name.weight` and `name.bias` [channels].
    layer_norm(weights<Real>& source, std::string const& name, std::size_t channels, Real epsilon = Real(1e-5))
        : channels_(channels), epsilon_(epsilon), weight_(source.take(name + ".weight", {channels})),
          bias_(source.take(name + ".bias", {channels})) {
        // A register may read beyond the last channel.
        weight_.resize(channels + genrender::detail::most_lanes<Real>);
        bias_.resize(channels + genrender::detail::most_lanes<Real>);
    }

    /// Writes the result [tokens, channels]; rows of both are contiguous, `out` may be `in`. Throws shape_error if they
    /// do not fit.
    void operator()(strided_view<Real, 2> out, in_view<Real, 2> in) const;

private:
    std::size_t channels_;
    Real epsilon_;
    std::vector<Real> weight_;
    std::vector<Real> bias_;
};

template <class Real>
void layer_norm<Real>::operator()(strided_view<Real, 2> out, in_view<Real, 2> in) const {
    auto const channels = channels_;
    require_shape("layer_norm", "in", in, {in.extent(0), channels});
    require_shape("layer_norm", "out", out, in.extents());
    GENRENDER_KERNEL(internal, normalize_tokens<Real>)(out, in, weight_.data(), bias_.data(), epsilon_);
}

GENRENDER_CLASS_INSTANCE(layer_norm<float>);
GENRENDER_CLASS_INSTANCE(layer_norm<double>);

} // namespace genrender::reference

#include <genrender/core/end_header.inl>
