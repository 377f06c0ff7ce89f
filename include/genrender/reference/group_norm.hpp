// SPDX-License-Identifier: MIT
// GroupNorm (Wu and He 2018) of feature maps whose channels lie side by side, and the SiLU that follows it.
#pragma once

#include <genrender/core/vector_lanes.hpp>
#include <genrender/core/parallel.hpp>
#include <genrender/core/strided_view.hpp>
#include <genrender/reference/activation.hpp>
#include <genrender/reference/padded_map.hpp>
#include <genrender/reference/weights.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <string>
#include <type_traits>
#include <vector>

namespace genrender::reference {

namespace internal {

using namespace genrender::detail;

/// One register of doubles, of numbers that lie at `from`.
template <class Real>
GENRENDER_ALWAYS_INLINE inline lanes<double> load_doubles(Real const* from) {
    if constexpr (std::is_same_v<Real, double>) {
        return load(from);
    } else if constexpr (lane_count<double> == 1) {
        return spread(static_cast<double>(*from));
    } else {
#if defined(__GNUC__)
        typedef Real half __attribute__((vector_size(lane_count<double> * sizeof(Real))));
        half numbers;
        std::memcpy(&numbers, from, sizeof numbers);
        return __builtin_convertvector(numbers, lanes<double>);
#endif
    }
}

} // namespace internal

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
    template <parallel_loop Loop = sequential_loop>
    void operator()(strided_view<Real, 2> out, in_view<Real, 2> in, Loop const& loop = Loop()) const {
        auto const tokens = in.extent(0);
        require_shape("group_norm", "in", in, {tokens, weight_.size()});
        require_shape("group_norm", "out", out, in.extents());
        auto const line = line_of(in, loop);
        loop((tokens + block - 1) / block, [&](std::size_t i) {
            for (std::size_t token = i * block; token < std::min(tokens, (i + 1) * block); ++token) {
                apply(out[token].data(), in[token].data(), line, [](auto y) GENRENDER_ALWAYS_INLINE { return y; });
            }
        });
    }

    /// Writes the SiLU of the result for `in` [tokens, channels] into a map with a ring, for a convolution. Throws
    /// shape_error if they do not fit.
    template <parallel_loop Loop = sequential_loop>
    void with_silu(padded_map<Real>& out, in_view<Real, 2> in, Loop const& loop = Loop()) const {
        require_extents("group_norm", "channels of out", std::array{out.channels()}, std::array{weight_.size()});
        require_shape("group_norm", "in", in, {out.grid().size(), weight_.size()});
        auto const line = line_of(in, loop);
        auto const width = out.grid().width;
        auto const height = out.grid().height;
        auto const rows = std::max<std::size_t>(1, block / std::max<std::size_t>(width, 1));
        loop((height + rows - 1) / rows, [&](std::size_t i) {
            for (std::size_t y = i * rows; y < std::min(height, (i + 1) * rows); ++y) {
                for (std::size_t x = 0; x < width; ++x) {
                    apply(out.row(y) + x * weight_.size(), in[y * width + x].data(), line,
                          [](auto value) GENRENDER_ALWAYS_INLINE { return internal::silu_of<Real>(value); });
                }
            }
        });
    }

private:
    /// Tokens that one thread takes at a time.
    static constexpr std::size_t block = 256;

    /// What becomes of x: x scale + shift, by channel.
    struct line_by_channel {
        std::vector<Real> scale;
        std::vector<Real> shift;
    };

    template <class Function>
    static void apply(Real* to, Real const* from, line_by_channel const& line, Function const& then) {
        auto const channels = line.scale.size() - padding;
        internal::each_register(to, from, channels, [&](std::size_t c, auto x) GENRENDER_ALWAYS_INLINE {
            return then(x * genrender::detail::load(line.scale.data() + c) +
                        genrender::detail::load(line.shift.data() + c));
        });
    }

    template <class Loop>
    line_by_channel line_of(strided_view<Real const, 2> const& in, Loop const& loop) const {
        auto const channels = weight_.size();
        auto const tokens = in.extent(0);
        std::vector<double> sum(channels);
        std::vector<double> squares(channels);
        loop(tokens == 0 ? 0 : (channels + strip - 1) / strip, [&](std::size_t i) {
            auto const first = i * strip;
            auto c = first;
            if (first + strip <= channels) {
                add_registers<strip / lane>(sum.data(), squares.data(), in, first);
                return;
            }
            for (; c + 4 * lane <= channels; c += 4 * lane) {
                add_registers<4>(sum.data(), squares.data(), in, c);
            }
            for (; c + lane <= channels; c += lane) {
                add_registers<1>(sum.data(), squares.data(), in, c);
            }
            add_channels(sum.data(), squares.data(), in, c);
        });

        line_by_channel line{std::vector<Real>(channels + padding), std::vector<Real>(channels + padding)};
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

    // Sums of each channel and of its squares in double, in one pass: of what is left after the channel's first value,
    // so that the squares do not drown in the mean.

    static constexpr auto lane = genrender::detail::lane_count<double>;
    /// Channels whose sums are in registers at once.
    static constexpr std::size_t strip = (genrender::detail::many_vector_registers ? 8 : 4) * lane;
    /// Numbers after the last that a register may read.
    static constexpr std::size_t padding = genrender::detail::lane_count<Real>;

    template <std::size_t N>
    static void add_registers(double* sum, double* squares, strided_view<Real const, 2> const& in, std::size_t first) {
        using genrender::detail::unrolled;
        genrender::detail::lanes<double> base[N];
        genrender::detail::lanes<double> sums[N]{};
        genrender::detail::lanes<double> products[N]{};
        unrolled<N>([&](auto i)
                        GENRENDER_ALWAYS_INLINE { base[i] = internal::load_doubles(in.data() + first + i * lane); });
        for (std::size_t token = 0; token < in.extent(0); ++token) {
            auto const* const x = in[token].data() + first;
            unrolled<N>([&](auto i) GENRENDER_ALWAYS_INLINE {
                auto const rest = internal::load_doubles(x + i * lane) - base[i];
                sums[i] += rest;
                products[i] += rest * rest;
            });
        }
        unrolled<N>([&](auto i) GENRENDER_ALWAYS_INLINE {
            genrender::detail::store(sum + first + i * lane, sums[i]);
            genrender::detail::store(squares + first + i * lane, products[i]);
        });
    }

    static void add_channels(double* sum, double* squares, strided_view<Real const, 2> const& in, std::size_t first) {
        for (std::size_t token = 0; token < in.extent(0); ++token) {
            for (std::size_t c = first; c < in.extent(1); ++c) {
                auto const rest = static_cast<double>(in(token, c)) - static_cast<double>(in(0, c));
                sum[c] += rest;
                squares[c] += rest * rest;
            }
        }
    }

    std::size_t groups_;
    Real epsilon_;
    std::vector<Real> weight_;
    std::vector<Real> bias_;
};

} // namespace genrender::reference
