// SPDX-License-Identifier: MIT
// GroupNorm (Wu and He 2018) of feature maps whose channels lie side by side, and the SiLU that follows it.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/instance.hpp>
#include <genrender/core/parallel.hpp>
#include <genrender/core/strided_view.hpp>
#include <genrender/core/vectors.hpp>
#include <genrender/reference/activation.hpp>
#include <genrender/reference/padded_map.hpp>
#include <genrender/reference/weights.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

namespace genrender::reference::internal {

/// What becomes of x: x scale + shift, by channel, with room for a register after the last channel.
template <class Real>
struct line_by_channel {
    std::vector<Real> scale;
    std::vector<Real> shift;
};

/// Channels whose moments one thread sums up at a time.
inline constexpr std::size_t moments_strip = 64;

} // namespace genrender::reference::internal

#define GENRENDER_KERNELS <genrender/reference/group_norm.inl>
#include <genrender/core/each_target.inl>

namespace genrender::reference {

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

    /// Writes the result [tokens, channels]; `out` may be `in`. Rows of both are contiguous. Tokens and channels are
    /// shared out over `loop`. Throws shape_error if they do not fit.
    void operator()(strided_view<Real, 2> out, in_view<Real, 2> in, any_loop const& loop = {}) const;

    /// Writes the SiLU of the result for `in` [tokens, channels] into a map with a ring, for a convolution. Throws
    /// shape_error if they do not fit.
    void with_silu(padded_map<Real>& out, in_view<Real, 2> in, any_loop const& loop = {}) const;

    /// Channels that it takes and gives.
    std::size_t channels() const { return weight_.size(); }

    /// What the moments of `in` [tokens, channels], whose rows are contiguous, make of each channel, for apply_silu a
    /// part at a time. Channels are shared out over `loop`. Throws shape_error if it does not fit.
    internal::line_by_channel<Real> line_of(in_view<Real, 2> in, any_loop const& loop = {}) const;

    /// Writes the SiLU of the result for some tokens of what the line is of; both [tokens, channels] with contiguous
    /// rows. Throws shape_error if they do not fit.
    void apply_silu(strided_view<Real, 2> out, in_view<Real, 2> in, internal::line_by_channel<Real> const& line) const {
        require_shape("group_norm", "in", in, {in.extent(0), weight_.size()});
        require_shape("group_norm", "out", out, in.extents());
        GENRENDER_KERNEL(internal, apply_line<true, Real>)(out, in, line.scale.data(), line.shift.data());
    }

private:
    /// Tokens that one thread takes at a time.
    static constexpr std::size_t block = 256;

    std::size_t groups_;
    Real epsilon_;
    std::vector<Real> weight_;
    std::vector<Real> bias_;
};

template <class Real>
void group_norm<Real>::operator()(strided_view<Real, 2> out, in_view<Real, 2> in, any_loop const& loop) const {
    auto const tokens = in.extent(0);
    require_shape("group_norm", "in", in, {tokens, weight_.size()});
    require_shape("group_norm", "out", out, in.extents());
    auto const line = line_of(in, loop);
    auto const apply = GENRENDER_KERNEL(internal, apply_line<false, Real>);
    loop((tokens + block - 1) / block, [&](std::size_t i) {
        auto const count = std::min(block, tokens - i * block);
        apply(out.slice(i * block, count), in.slice(i * block, count), line.scale.data(), line.shift.data());
    });
}

template <class Real>
void group_norm<Real>::with_silu(padded_map<Real>& out, in_view<Real, 2> in, any_loop const& loop) const {
    require_extents("group_norm", "channels of out", std::array{out.channels()}, std::array{weight_.size()});
    require_shape("group_norm", "in", in, {out.grid().size(), weight_.size()});
    auto const line = line_of(in, loop);
    auto const width = out.grid().width;
    auto const height = out.grid().height;
    auto const rows = std::max<std::size_t>(1, block / std::max<std::size_t>(width, 1));
    auto const apply = GENRENDER_KERNEL(internal, apply_line<true, Real>);
    loop((height + rows - 1) / rows, [&](std::size_t i) {
        for (std::size_t y = i * rows; y < std::min(height, (i + 1) * rows); ++y) {
            apply({out.row(y), {width, weight_.size()}}, in.slice(y * width, width), line.scale.data(),
                  line.shift.data());
        }
    });
}

template <class Real>
internal::line_by_channel<Real> group_norm<Real>::line_of(in_view<Real, 2> in, any_loop const& loop) const {
    require_shape("group_norm", "in", in, {in.extent(0), weight_.size()});
    auto const channels = weight_.size();
    auto const tokens = in.extent(0);
    std::vector<double> sum(channels);
    std::vector<double> squares(channels);
    auto const add_moments = GENRENDER_KERNEL(internal, add_moments<Real>);
    constexpr auto strip = internal::moments_strip;
    loop(tokens == 0 ? 0 : (channels + strip - 1) / strip, [&](std::size_t i) {
        add_moments(sum.data(), squares.data(), in, i * strip, std::min(channels, (i + 1) * strip));
    });

    constexpr auto room = genrender::detail::most_lanes<Real>;
    internal::line_by_channel<Real> line{std::vector<Real>(channels + room), std::vector<Real>(channels + room)};
    auto const size = channels / groups_;
    auto const count = static_cast<double>(tokens);
    for (std::size_t first = 0; first < channels && tokens > 0; first += size) {
        double mean = 0;
        for (std::size_t c = first; c < first + size; ++c) {
            mean += static_cast<double>(in(0, c)) + sum[c] / count;
        }
        mean /= static_cast<double>(size);
        double variance = 0;
        for (std::size_t c = first; c < first + size; ++c) {
            auto const apart = static_cast<double>(in(0, c)) + sum[c] / count - mean;
            variance += (squares[c] - sum[c] * sum[c] / count) / count + apart * apart;
        }
        variance = std::max(variance, 0.0) / static_cast<double>(size);
        auto const spread = std::sqrt(variance + static_cast<double>(epsilon_));
        for (std::size_t c = first; c < first + size; ++c) {
            auto const factor = static_cast<double>(weight_[c]) / spread;
            line.scale[c] = static_cast<Real>(factor);
            line.shift[c] = static_cast<Real>(static_cast<double>(bias_[c]) - mean * factor);
        }
    }
    return line;
}

GENRENDER_CLASS_INSTANCE(group_norm<float>);
GENRENDER_CLASS_INSTANCE(group_norm<double>);

} // namespace genrender::reference

#include <genrender/core/end_header.inl>
