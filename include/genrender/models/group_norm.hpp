// SPDX-License-Identifier: MIT
// GroupNorm (Wu and He 2018) of feature maps whose channels lie side by side.
#pragma once

#include <genrender/core/strided_view.hpp>
#include <genrender/models/weights.hpp>

#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

namespace genrender {

/// Each group of neighbouring channels, over all tokens of a frame, to mean 0 and variance 1; then scale and shift a
/// channel.
template <class Real>
class group_norm {
public:
    /// Takes `name.weight` and `name.bias` [channels].
    group_norm(weights<Real>& source, std::string const& name, std::size_t channels, std::size_t groups, Real epsilon)
        : groups_(groups), epsilon_(epsilon), weight_(source.take(name + ".weight", {channels})),
          bias_(source.take(name + ".bias", {channels})) {
        require_value(groups > 0 && channels % groups == 0, "group_norm", "groups", groups,
                      "a divisor of the channels");
    }

    /// Writes the result [tokens, channels]; `out` may be `in`. Throws shape_error if they do not fit.
    void operator()(strided_view<Real, 2> out, in_view<Real, 2> in) const {
        auto const channels = weight_.size();
        auto const tokens = in.extent(0);
        require_shape("group_norm", "in", in, {tokens, channels});
        require_shape("group_norm", "out", out, in.extents());
        // Two passes, for the variance of what is left after the mean; sums in double, a channel at a time.
        auto const size = channels / groups_;
        auto const count = static_cast<double>(size * tokens);
        std::vector<double> mean(channels);
        std::vector<double> variance(channels);
        for (std::size_t token = 0; token < tokens; ++token) {
            auto const x = in[token].row();
            for (std::size_t c = 0; c < channels; ++c) {
                mean[c] += static_cast<double>(x[c]);
            }
        }
        share_by_group(mean, count);
        for (std::size_t token = 0; token < tokens; ++token) {
            auto const x = in[token].row();
            for (std::size_t c = 0; c < channels; ++c) {
                auto const centred = static_cast<double>(x[c]) - mean[c];
                variance[c] += centred * centred;
            }
        }
        share_by_group(variance, count);

        std::vector<Real> scale(channels);
        std::vector<Real> shift(channels);
        for (std::size_t c = 0; c < channels; ++c) {
            auto const factor =
                static_cast<double>(weight_[c]) / std::sqrt(variance[c] + static_cast<double>(epsilon_));
            scale[c] = static_cast<Real>(factor);
            shift[c] = static_cast<Real>(static_cast<double>(bias_[c]) - mean[c] * factor);
        }
        for (std::size_t token = 0; token < tokens; ++token) {
            auto const x = in[token].row();
            auto const y = out[token].row();
            for (std::size_t c = 0; c < channels; ++c) {
                y[c] = x[c] * scale[c] + shift[c];
            }
        }
    }

private:
    /// Replaces sums of channels by the mean over their group of `count` elements.
    void share_by_group(std::vector<double>& sums, double count) const {
        auto const size = sums.size() / groups_;
        for (std::size_t first = 0; first < sums.size(); first += size) {
            double sum = 0;
            for (std::size_t c = first; c < first + size; ++c) {
                sum += sums[c];
            }
            for (std::size_t c = first; c < first + size; ++c) {
                sums[c] = sum / count;
            }
        }
    }

    std::size_t groups_;
    Real epsilon_;
    std::vector<Real> weight_;
    std::vector<Real> bias_;
};

} // namespace genrender
