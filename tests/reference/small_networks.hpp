// SPDX-License-Identifier: MIT
// Networks small enough to be run a hundred times, and layers written out the long way to compare with.
#pragma once

#include <genrender/testing/random_stack.hpp>

#include <genrender/attention/plain_attention.hpp>
#include <genrender/reference/feature_maps.hpp>
#include <genrender/reference/forward_pass.hpp>
#include <genrender/reference/unet_config.hpp>
#include <genrender/reference/weights.hpp>

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include <unistd.h>

namespace genrender::testing {

using namespace genrender::reference;

/// Two levels of 8 and 12 channels, attention at the finer one and the bottom, for 4 latent channels.
inline unet_config small_config() {
    unet_config config;
    config.in_channels = 4;
    config.out_channels = 4;
    config.block_out_channels = {8, 12};
    config.level_has_attention = {true, false};
    config.layers_per_block = 1;
    config.attention_head_dim = {2, 3};
    config.cross_attention_dim = 6;
    config.norm_num_groups = 4;
    config.conditioning_channels = 3;
    config.conditioning_embedding_out_channels = {3, 5};
    config.prediction_type = prediction::clean;
    return config;
}

/// Rounding errors of a sum of some hundred products.
template <class Real>
double tolerance() {
    return 300 * static_cast<double>(std::numeric_limits<Real>::epsilon());
}

template <class Real, std::size_t Rank>
void check_close(strided_view<Real, Rank> a, strided_view<std::type_identity_t<Real> const, Rank> b) {
    REQUIRE(a.extents() == b.extents());
    if constexpr (Rank == 1) {
        for (std::size_t i = 0; i < a.extent(0); ++i) {
            REQUIRE(std::abs(static_cast<double>(a(i) - b(i))) <= tolerance<std::remove_const_t<Real>>());
        }
    } else {
        for (std::size_t i = 0; i < a.extent(0); ++i) {
            check_close<Real, Rank - 1>(a[i], b[i]);
        }
    }
}

/// Random features, the same for the same seed.
template <class Real>
feature_maps<Real> random_maps(std::size_t frames, grid_extents grid, std::size_t channels, std::uint64_t seed) {
    feature_maps<Real> maps(frames, grid, channels);
    copy(maps.view(), in_view<Real, 3>(random_stack<Real, 3>({frames, grid.size(), channels}, seed).view()));
    return maps;
}

/// A pass over two frames with plain attention, one thread, a prompt of three tokens and time features of a network.
template <class Real>
struct small_pass {
    std::array<frame_index, 2> frames{frame_index{0}, frame_index{1}};
    stack<Real, 2> prompt = random_stack<Real, 2>({3, 6}, 11);
    plain_attention processor{};
    sequential_loop loop{};
    forward_pass<Real> pass{frames, 0, prompt.view(), processor, loop};

    explicit small_pass(unet_config const& config = small_config()) {
        auto const time = random_stack<Real, 1>({config.time_channels()}, 12);
        pass.time.assign(time.data(), time.data() + time.size());
    }
};

/// in W^T + b, one sum after the other.
template <class Real>
stack<Real, 2> plain_linear(in_view<Real, 2> in, std::vector<Real> const& weight, std::vector<Real> const& bias,
                            std::size_t out_channels) {
    stack<Real, 2> out({in.extent(0), out_channels});
    for (std::size_t token = 0; token < in.extent(0); ++token) {
        for (std::size_t o = 0; o < out_channels; ++o) {
            double sum = bias.empty() ? 0.0 : static_cast<double>(bias[o]);
            for (std::size_t i = 0; i < in.extent(1); ++i) {
                sum += static_cast<double>(weight[o * in.extent(1) + i]) * static_cast<double>(in(token, i));
            }
            out(token, o) = static_cast<Real>(sum);
        }
    }
    return out;
}

/// A convolution by its definition, weight [out, in, kernel, kernel].
template <class Real>
stack<Real, 2> plain_conv2d(in_view<Real, 2> in, grid_extents grid, std::vector<Real> const& weight,
                            std::vector<Real> const& bias, std::size_t kernel, std::size_t stride) {
    auto const ins = in.extent(1);
    auto const outs = bias.size();
    auto const radius = static_cast<int>(kernel / 2);
    auto const height = (grid.height - 1) / stride + 1;
    auto const width = (grid.width - 1) / stride + 1;
    stack<Real, 2> out({height * width, outs});
    for (std::size_t y = 0; y < height; ++y) {
        for (std::size_t x = 0; x < width; ++x) {
            for (std::size_t o = 0; o < outs; ++o) {
                auto sum = static_cast<double>(bias[o]);
                for (std::size_t i = 0; i < ins; ++i) {
                    for (std::size_t tap = 0; tap < kernel * kernel; ++tap) {
                        auto const row = static_cast<int>(y * stride + tap / kernel) - radius;
                        auto const column = static_cast<int>(x * stride + tap % kernel) - radius;
                        if (row >= 0 && column >= 0 && row < static_cast<int>(grid.height) &&
                            column < static_cast<int>(grid.width)) {
                            auto const token =
                                static_cast<std::size_t>(row) * grid.width + static_cast<std::size_t>(column);
                            sum += static_cast<double>(weight[(o * ins + i) * kernel * kernel + tap]) *
                                   static_cast<double>(in(token, i));
                        }
                    }
                }
                out(y * width + x, o) = static_cast<Real>(sum);
            }
        }
    }
    return out;
}

/// The name of a file or folder that is removed with the object.
class temporary_file {
public:
    explicit temporary_file(std::string const& name) {
        static std::size_t count = 0;
        auto const unique = std::to_string(::getpid()) + "-genrender-" + std::to_string(count++) + "-" + name;
        path_ = (std::filesystem::temp_directory_path() / unique).string();
    }
    temporary_file(temporary_file const&) = delete;
    temporary_file& operator=(temporary_file const&) = delete;
    ~temporary_file() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    std::string const& path() const { return path_; }

private:
    std::string path_;
};

} // namespace genrender::testing
