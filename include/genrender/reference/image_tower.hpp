// SPDX-License-Identifier: MIT
// The half of a small CLIP that sees: convolutions and a gate that says where a picture's subjects are, to one vector.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/error.hpp>
#include <genrender/core/parallel.hpp>
#include <genrender/core/stack.hpp>
#include <genrender/core/strided_view.hpp>
#include <genrender/reference/activation.hpp>
#include <genrender/reference/conv2d.hpp>
#include <genrender/reference/feature_maps.hpp>
#include <genrender/reference/group_norm.hpp>
#include <genrender/reference/linear.hpp>
#include <genrender/reference/weights.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace genrender::reference {

/// What an image_tower is built from; the defaults are the embedder of examples/miniature.
struct image_tower_config {
    std::vector<std::size_t> block_out_channels{24, 48, 48, 96, 96, 96}; ///< of each convolution
    std::vector<std::size_t> strides{2, 2, 1, 2, 1, 1};                  ///< of each convolution
    std::size_t norm_num_groups = 8; ///< of each GroupNorm, a divisor of its channels
    double norm_eps = 1e-5;          ///< of each GroupNorm
    std::size_t hidden_size = 128;   ///< channels between the two last matrices
    std::size_t projection_dim = 64; ///< length of the vector
};

/// Throws value_error unless a tower can be built: a stride for each convolution, no zero, groups that divide all
/// channels, an epsilon above 0.
inline void require_config(image_tower_config const& config) {
    auto const function = "image_tower_config";
    auto const blocks = config.block_out_channels.size();
    require_value(blocks > 0, function, "block_out_channels", "empty", "a number for each convolution");
    require_value(config.strides.size() == blocks, function, "numbers of strides", config.strides.size(),
                  (std::to_string(blocks) + ", as many as block_out_channels has").c_str());
    require_value(config.norm_num_groups > 0, function, "norm_num_groups", config.norm_num_groups, "above 0");
    require_value(config.hidden_size > 0, function, "hidden_size", config.hidden_size, "above 0");
    require_value(config.projection_dim > 0, function, "projection_dim", config.projection_dim, "above 0");
    require_value(config.norm_eps > 0 && config.norm_eps < 1, function, "norm_eps", config.norm_eps,
                  "a number in (0, 1)");
    for (std::size_t i = 0; i < blocks; ++i) {
        require_value(config.strides[i] > 0, function, "strides", config.strides[i], "above 0");
        auto const channels = config.block_out_channels[i];
        require_value(channels > 0 && channels % config.norm_num_groups == 0, function, "block_out_channels", channels,
                      ("a multiple of the " + std::to_string(config.norm_num_groups) + " of norm_num_groups").c_str());
    }
}

/// Convolutions of 3 x 3 pixels with GroupNorm and SiLU, each added to what came in where that has its shape; then a
/// gate, which says of every place how much of it belongs to the subjects. The mean over these, beside the mean over all
/// places, passes two matrices with SiLU between them.
template <class Real>
class image_tower {
public:
    /// Takes `image.blocks.N.conv`, `image.blocks.N.norm`, `image.gate`, `image.hidden` and `image.projection`. Throws
    /// value_error if the config cannot be built, file_error if a tensor is missing or misshapen.
    image_tower(image_tower_config const& config, weights<Real>& source)
        : config_((require_config(config), config)), blocks_(take_blocks(config, source)),
          gate_(source, "image.gate", features(), 1),
          hidden_(source, "image.hidden", 2 * features(), config.hidden_size),
          projection_(source, "image.projection", config.hidden_size, config.projection_dim) {}

    /// The architecture that it is of.
    image_tower_config const& config() const { return config_; }

    /// The vector [projection_dim] of an image [3, height, width] with values in [0, 1], of any length. Work is shared
    /// out over `loop`. Throws shape_error unless there are three channels and pixels.
    std::vector<Real> operator()(strided_view<Real const, 3> image, any_loop const& loop = {}) const {
        auto const x = convolved(image, loop);
        auto means = means_of(x[0], loop);
        auto hidden = stack<Real, 2>::uninitialized({1, config_.hidden_size});
        hidden_(hidden.view(), means, loop);
        silu(std::span<Real>(hidden.data(), hidden.size()));
        std::vector<Real> vector(config_.projection_dim);
        projection_(strided_view<Real, 2>(vector.data(), {1, vector.size()}), hidden, loop);
        return vector;
    }

    /// What the last convolution says of each place of an image, before the gate: [channels, rows, columns], a row and a
    /// column for as many pixels as the product of the strides. Takes and throws what the other call does.
    stack<Real, 3> feature_map(strided_view<Real const, 3> image, any_loop const& loop = {}) const {
        auto x = convolved(image, loop);
        auto map = stack<Real, 3>::uninitialized({features(), x.grid().height, x.grid().width});
        copy(map.view(), x.channels_first()[0]);
        return map;
    }

private:
    struct block {
        conv2d<Real> conv;
        group_norm<Real> norm;
        bool adds;
    };

    std::size_t features() const { return config_.block_out_channels.back(); }

    feature_maps<Real> convolved(strided_view<Real const, 3> image, any_loop const& loop) const {
        require_shape("image_tower", "image", image,
                      {3, std::max<std::size_t>(1, image.extent(1)), std::max<std::size_t>(1, image.extent(2))});
        feature_maps<Real> x(1, {image.extent(1), image.extent(2)}, 3);
        copy(x.channels_first()[0], image);
        auto const values = [](feature_maps<Real>& maps) { return std::span(maps[0].data(), maps[0].size()); };
        for (auto& value : values(x)) {
            value = 2 * value - 1;
        }
        for (auto const& [conv, norm, adds] : blocks_) {
            feature_maps<Real> y(1, conv.out_grid(x.grid()), conv.out_channels());
            conv(y[0], x[0], x.grid(), loop);
            norm(y[0], y[0], loop);
            silu(values(y));
            if (adds) {
                auto const before = values(x);
                std::transform(before.begin(), before.end(), values(y).begin(), values(y).begin(),
                               [](Real a, Real b) { return a + b; });
            }
            x = std::move(y);
        }
        return x;
    }

    static std::vector<block> take_blocks(image_tower_config const& config, weights<Real>& source) {
        std::vector<block> blocks;
        std::size_t in = 3;
        for (std::size_t i = 0; i < config.strides.size(); ++i) {
            auto const name = "image.blocks." + std::to_string(i);
            auto const out = config.block_out_channels[i];
            blocks.push_back({conv2d<Real>(source, name + ".conv", in, out, 3, config.strides[i]),
                              group_norm<Real>(source, name + ".norm", out, config.norm_num_groups,
                                               static_cast<Real>(config.norm_eps)),
                              config.strides[i] == 1 && in == out});
            in = out;
        }
        return blocks;
    }

    /// The mean of the rows that the gate weighs, then that of all rows [1, 2 features]; sums in double.
    stack<Real, 2> means_of(strided_view<Real const, 2> rows, any_loop const& loop) const {
        auto const tokens = rows.extent(0);
        auto const channels = features();
        auto scores = stack<Real, 2>::uninitialized({tokens, 1});
        gate_(scores.view(), rows, loop);
        std::vector<double> sums(2 * channels);
        double shares = 0;
        for (std::size_t t = 0; t < tokens; ++t) {
            auto const share = 1 / (1 + std::exp(-static_cast<double>(scores(t, 0))));
            shares += share;
            for (std::size_t c = 0; c < channels; ++c) {
                auto const x = static_cast<double>(rows(t, c));
                sums[c] += share * x;
                sums[channels + c] += x;
            }
        }
        stack<Real, 2> means({1, 2 * channels});
        for (std::size_t c = 0; c < channels; ++c) {
            means(0, c) = static_cast<Real>(sums[c] / std::max(shares, 1e-30));
            means(0, channels + c) = static_cast<Real>(sums[channels + c] / static_cast<double>(tokens));
        }
        return means;
    }

    image_tower_config config_;
    std::vector<block> blocks_;
    linear<Real> gate_;
    linear<Real> hidden_;
    linear<Real> projection_;
};

} // namespace genrender::reference

#include <genrender/core/end_header.inl>
