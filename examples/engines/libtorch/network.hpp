// SPDX-License-Identifier: MIT
// Stable Diffusion's UNet and ControlNet in ATen, as an engine has them: by the names of their tensors, not a word of genrender.
#pragma once

#include <ATen/ATen.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace engine {

using tensor = at::Tensor;
/// Gives F [frames, tokens, channels] of a self-attention module, before its matrix `to_out`: by its name, its normed input
/// f, W^Q, W^K, W^V and its number of heads.
using self_attention = std::function<tensor(std::string const& module, tensor const& f, tensor const& Q,
                                            tensor const& K, tensor const& V, std::int64_t heads)>;

inline tensor attention(tensor const& Q, tensor const& K, tensor const& V, std::int64_t heads) {
    auto const by_heads = [&](tensor const& x) { return x.unflatten(2, {heads, x.size(2) / heads}).transpose(1, 2); };
    return at::scaled_dot_product_attention(by_heads(Q), by_heads(K), by_heads(V)).transpose(1, 2).flatten(2);
}

/// What all modules of a run are told: the embedded time, the prompt [frames, words, channels], who runs self-attention.
struct context {
    tensor time;
    tensor prompt;
    self_attention run;
};

struct network {
    std::map<std::string, tensor> tensors;
    std::vector<std::int64_t> heads; // of each level, the finest first
    std::int64_t groups = 1;

    tensor get(std::string const& name) const { return tensors.count(name) > 0 ? tensors.at(name) : tensor(); }
    tensor weight(std::string const& name) const { return tensors.at(name + ".weight"); }
    bool has(std::string const& name) const { return tensors.count(name + ".weight") > 0; }
    tensor conv(tensor const& x, std::string const& name, std::int64_t stride = 1) const {
        return at::conv2d(x, weight(name), get(name + ".bias"), stride, weight(name).size(2) / 2);
    }
    tensor linear(tensor const& x, std::string const& name) const {
        return at::linear(x, weight(name).flatten(1), get(name + ".bias"));
    }
    tensor norm(tensor const& x, std::string const& name, double eps = 1e-5) const {
        return at::group_norm(x, groups, weight(name), get(name + ".bias"), eps);
    }
    tensor layer_norm(tensor const& x, std::string const& name) const {
        return at::layer_norm(x, {x.size(2)}, weight(name), get(name + ".bias"));
    }
    tensor resnet(tensor const& x, context const& in, std::string const& name) const {
        auto const time = linear(in.time, name + ".time_emb_proj").unsqueeze(-1).unsqueeze(-1);
        auto const h = conv(at::silu(norm(x, name + ".norm1")), name + ".conv1") + time;
        auto const y = conv(at::silu(norm(h, name + ".norm2")), name + ".conv2");
        return y + (has(name + ".conv_shortcut") ? conv(x, name + ".conv_shortcut") : x);
    }
    tensor transformer(tensor const& x, context const& in, std::string const& name, std::int64_t number) const {
        auto h = linear(norm(x, name + ".norm", 1e-6).flatten(2).transpose(1, 2), name + ".proj_in");
        for (int i = 0; has(name + ".transformer_blocks." + std::to_string(i) + ".norm1"); ++i) {
            auto const block = name + ".transformer_blocks." + std::to_string(i);
            auto const self = block + ".attn1";
            auto const F = in.run(self, layer_norm(h, block + ".norm1"), weight(self + ".to_q"), weight(self + ".to_k"),
                                  weight(self + ".to_v"), number);
            h = h + linear(F, self + ".to_out.0");
            auto const cross = block + ".attn2";
            auto const Q = linear(layer_norm(h, block + ".norm2"), cross + ".to_q");
            auto const K = linear(in.prompt, cross + ".to_k");
            h = h + linear(attention(Q, K, linear(in.prompt, cross + ".to_v"), number), cross + ".to_out.0");
            auto const parts = linear(layer_norm(h, block + ".norm3"), block + ".ff.net.0.proj").chunk(2, -1);
            h = h + linear(parts[0] * at::gelu(parts[1]), block + ".ff.net.2");
        }
        return x + linear(h, name + ".proj_out").transpose(1, 2).unflatten(2, {x.size(2), x.size(3)});
    }
    /// A resnet of a block, and the attention behind it if there is one.
    tensor layer(tensor const& x, context const& in, std::string const& block, int i, std::size_t level) const {
        auto const h = resnet(x, in, block + ".resnets." + std::to_string(i));
        auto const behind = block + ".attentions." + std::to_string(i);
        return has(behind + ".norm") ? transformer(h, in, behind, heads[level]) : h;
    }
    tensor embedded_time(double t) const {
        auto const half = weight("time_embedding.linear_1").size(1) / 2;
        auto const step = -std::log(10000.0) / static_cast<double>(half);
        auto const angles = at::arange(half, weight("conv_in").options()).mul(step).exp() * t;
        auto const waves = at::cat({angles.cos(), angles.sin()}).unsqueeze(0);
        return at::silu(linear(at::silu(linear(waves, "time_embedding.linear_1")), "time_embedding.linear_2"));
    }
    /// The way down, the middle last.
    std::vector<tensor> encode(tensor const& z, context const& in, tensor const& hint = {}) const {
        std::vector<tensor> maps{hint.defined() ? conv(z, "conv_in") + hint : conv(z, "conv_in")};
        for (std::size_t level = 0; level < heads.size(); ++level) {
            auto const block = "down_blocks." + std::to_string(level);
            for (int i = 0; has(block + ".resnets." + std::to_string(i) + ".conv1"); ++i) {
                maps.push_back(layer(maps.back(), in, block, i, level));
            }
            if (has(block + ".downsamplers.0.conv")) {
                maps.push_back(conv(maps.back(), block + ".downsamplers.0.conv", 2));
            }
        }
        auto const middle = layer(maps.back(), in, "mid_block", 0, heads.size() - 1);
        maps.push_back(resnet(middle, in, "mid_block.resnets.1"));
        return maps;
    }
    tensor decode(std::vector<tensor> maps, context const& in) const {
        auto h = std::exchange(maps.back(), {});
        maps.pop_back();
        for (std::size_t number = 0; number < heads.size(); ++number) {
            auto const block = "up_blocks." + std::to_string(number);
            for (int i = 0; has(block + ".resnets." + std::to_string(i) + ".conv1"); ++i) {
                h = layer(at::cat({h, maps.back()}, 1), in, block, i, heads.size() - 1 - number);
                maps.pop_back();
            }
            if (has(block + ".upsamplers.0.conv")) {
                h = conv(at::upsample_nearest2d(h, {2 * h.size(2), 2 * h.size(3)}), block + ".upsamplers.0.conv");
            }
        }
        return conv(at::silu(norm(h, "conv_norm_out")), "conv_out");
    }
    /// Of a ControlNet: the features of a hint, which depend on nothing else, and what to add to the maps of a UNet.
    tensor embedded_hint(tensor const& hint) const {
        std::string const name = "controlnet_cond_embedding.";
        auto h = at::silu(conv(hint, name + "conv_in"));
        for (int i = 0; has(name + "blocks." + std::to_string(i)); ++i) {
            h = at::silu(conv(h, name + "blocks." + std::to_string(i), 1 + i % 2));
        }
        return conv(h, name + "conv_out");
    }
    std::vector<tensor> control(tensor const& z, context const& in, tensor const& hint) const {
        auto maps = encode(z, in, hint);
        for (std::size_t i = 0; i + 1 < maps.size(); ++i) {
            maps[i] = conv(maps[i], "controlnet_down_blocks." + std::to_string(i));
        }
        maps.back() = conv(maps.back(), "controlnet_mid_block");
        return maps;
    }
};

/// The output of the UNet for c_in z at time t, a prompt [1, words, channels] and embedded hints.
inline tensor predict(network const& unet, network const& control, tensor const& z, double t, tensor const& prompt,
                      tensor const& hints, self_attention const& run) {
    auto const own = [](auto const&, tensor const& f, tensor const& Q, tensor const& K, tensor const& V, auto heads) {
        return attention(at::linear(f, Q), at::linear(f, K), at::linear(f, V), heads);
    };
    auto const words = prompt.expand({z.size(0), -1, -1});
    auto const added = control.control(z, {control.embedded_time(t), words, own}, hints);
    context const in{unet.embedded_time(t), words, run};
    auto maps = unet.encode(z, in);
    for (std::size_t i = 0; i < maps.size(); ++i) {
        maps[i] = maps[i] + added[i];
    }
    return unet.decode(std::move(maps), in);
}

} // namespace engine
