// SPDX-License-Identifier: MIT
// LayerNorm (Ba et al. 2016) of feature maps whose channels lie side by side.
#pragma once

#include <genrender/core/vector_lanes.hpp>
#include <genrender/core/strided_view.hpp>
#include <genrender/reference/activation.hpp>
#include <genrender/reference/weights.hpp>

#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

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
        weight_.resize(channels + genrender::detail::lane_count<Real>);
        bias_.resize(channels + genrender::detail::lane_count<Real>);
    }

    /// Writes the result [tokens, channels]; rows of both are contiguous, `out` may be `in`. Throws shape_error if they
    /// do not fit.
    void operator()(strided_view<Real, 2> out, in_view<Real, 2> in) const {
        auto const channels = channels_;
        require_shape("layer_norm", "in", in, {in.extent(0), channels});
        require_shape("layer_norm", "out", out, in.extents());
        for (std::size_t token = 0; token < in.extent(0); ++token) {
            auto const* const x = in[token].data();
            auto const mean = sum_of(x, channels, [](auto value) GENRENDER_ALWAYS_INLINE { return value; }) /
                              static_cast<Real>(channels);
            auto const squares = sum_of(x, channels, [&](auto value) GENRENDER_ALWAYS_INLINE {
                auto const rest = value - mean;
                return rest * rest;
            });
            auto const factor = 1 / std::sqrt(squares / static_cast<Real>(channels) + epsilon_);
            internal::each_register(out[token].data(), x, channels,
                                    [&](std::size_t c, auto value) GENRENDER_ALWAYS_INLINE {
                                        return (value - mean) * factor * genrender::detail::load(weight_.data() + c) +
                                               genrender::detail::load(bias_.data() + c);
                                    });
        }
    }

private:
    /// The sum of f(value): one sum a lane, then over the lanes, then over the values that fill no register.
    template <class Function>
    static Real sum_of(Real const* values, std::size_t count, Function const& f) {
        constexpr auto n = genrender::detail::lane_count<Real>;
        genrender::detail::lanes<Real> sums{};
        std::size_t i = 0;
        for (; i + n <= count; i += n) {
            sums += f(genrender::detail::load(values + i));
        }
        Real parts[n];
        genrender::detail::store(parts, sums);
        for (auto half = n / 2; half > 0; half /= 2) {
            for (std::size_t lane = 0; lane < half; ++lane) {
                parts[lane] += parts[lane + half];
            }
        }
        for (; i < count; ++i) {
            parts[0] += f(values[i]);
        }
        return parts[0];
    }

    std::size_t channels_;
    Real epsilon_;
    std::vector<Real> weight_;
    std::vector<Real> bias_;
};

} // namespace genrender::reference
