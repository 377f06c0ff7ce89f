// SPDX-License-Identifier: MIT
// One hot kernel on fixed inputs, for a machine that counts instructions: `instructions KERNEL`.
#include <genrender/attention/scaled_dot_product.hpp>
#include <genrender/blending/mix_rows.hpp>
#include <genrender/core/stack.hpp>
#include <genrender/maps/uv_maps.hpp>
#include <genrender/noise/initial_noise.hpp>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <string>
#include <vector>

using namespace genrender;

/// What is counted: everything from here to its return, and nothing that prepares it.
extern "C" [[gnu::noinline]] void counted(std::function<void()> const& kernel) { kernel(); }

namespace {

/// Values in [-1, 1] that are the same everywhere.
template <std::size_t Rank>
stack<float, Rank> filled(std::array<std::size_t, Rank> const& extents) {
    stack<float, Rank> values(extents);
    std::uint32_t state = 1;
    for (std::size_t i = 0; i < values.size(); ++i) {
        state = state * 1664525U + 1013904223U;
        values.data()[i] = static_cast<float>(state >> 8U) / 8388608.0f - 1;
    }
    return values;
}

/// The tokens of a frame and of two keyframes, heads as wide as those of Stable Diffusion's largest grid.
void count_scaled_dot_product() {
    constexpr std::size_t tokens = 200;
    constexpr std::size_t heads = 2;
    constexpr std::size_t channels = heads * 40;
    stack<float, 2> F({tokens, channels});
    auto const Q = filled<2>({tokens, channels});
    auto const K = filled<3>({3, tokens, channels});
    auto const V = filled<3>({3, tokens, channels});
    std::vector<key_value_view<float>> blocks;
    for (std::size_t b = 0; b < 3; ++b) {
        blocks.push_back({K.view()[b], V.view()[b]});
    }
    counted([&] { scaled_dot_product(F.view(), Q, blocks, heads); });
}

/// Three tokens of five keyframes for each token of a frame.
void count_mix_rows() {
    constexpr std::uint32_t tokens = 1024;
    constexpr std::size_t channels = 320;
    auto F = filled<2>({tokens, channels});
    auto const F_KF = filled<3>({5, tokens, channels});
    std::vector<std::uint32_t> offsets{0};
    std::vector<std::uint32_t> sources;
    for (std::uint32_t t = 0; t < tokens; ++t) {
        for (std::uint32_t k = 0; k < 3; ++k) {
            sources.push_back((t / 97 + k) % 5 * tokens + (t + 3 * k) % tokens);
        }
        offsets.push_back(static_cast<std::uint32_t>(sources.size()));
    }
    std::vector<float> const weights(sources.size(), 1.0f / 3);
    counted([&] { mix_rows(F.view(), F_KF, {offsets, sources, weights}, 0.7f); });
}

/// A frame with a round object that a texture lies on, and background around it.
void count_initial_noise() {
    constexpr std::size_t side = 128;
    uv_maps maps(1, {side, side});
    for (std::size_t row = 0; row < side; ++row) {
        for (std::size_t column = 0; column < side; ++column) {
            auto const x = (static_cast<float>(column) + 0.5f) / (side / 2) - 1;
            auto const y = (static_cast<float>(row) + 0.5f) / (side / 2) - 1;
            if (auto const r = x * x + y * y; r < 0.8f) {
                maps.uv(0, row, column, 0) = 0.5f + 0.3f * x + 0.1f * r;
                maps.uv(0, row, column, 1) = 0.5f + 0.2f * y - 0.1f * r;
                maps.coverage(0, row, column) = 1;
            }
        }
    }
    stack<float, 4> z({1, 4, 32, 32});
    std::vector<frame_index> const frames{{0}};
    counted([&] { initial_noise(z.view(), to_uv_view(maps), frames, {}); });
}

} // namespace

int main(int argc, char** argv) {
    std::string const kernel = argc == 2 ? argv[1] : "";
    if (kernel == "scaled_dot_product") {
        count_scaled_dot_product();
    } else if (kernel == "mix_rows") {
        count_mix_rows();
    } else if (kernel == "initial_noise") {
        count_initial_noise();
    } else {
        std::fprintf(stderr, "hot_kernels: kernel is '%s', expected scaled_dot_product, mix_rows or initial_noise\n",
                     kernel.c_str());
        return 2;
    }
    return 0;
}
