// SPDX-License-Identifier: MIT
// Stable Diffusion's UNet and ControlNet in ATen, as an engine has them: by the names of their tensors, not a word of genrender.
#pragma once

#include <ATen/ATen.h>

#include <cmath>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace engine {

using tensor = at::Tensor;
/// Gives the output of a self-attention module, before its matrix `to_out`, for its normed input [frames, tokens, channels].
using self_attention = std::function<tensor(std::string const& module, tensor const& f)>;

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
    std::vector<std::int64_t> heads; // of each level
    std::int64_t groups = 1;

    bool has(std::string const& name) const { return tensors.count(name + ".weight") > 0; }
    tensor const& weight(std::string const& name) const { return tensors.at(name + ".weight"); }
    tensor bias(std::string const& name) const {
        return tensors.count(name + ".bias") > 0 ? tensors.at(name + ".bias") : tensor();
    }
    std::int64_t last_level() const { return static_cast<std::int64_t>(heads.size()) - 1; }
    /// Of the block that a module is in: 0 is the finest.
    std::int64_t level_of(std::string const& module) const {
        auto const number = module[0] == 'm' ? last_level() : std::stoll(module.substr(module.find('.') + 1));
        return module[0] == 'u' ? last_level() - number : number;
    }
    std::int64_t heads_of(std::string const& module) const { return heads[static_cast<std::size_t>(level_of(module))]; }

    tensor conv(tensor const& x, std::string const& name, std::int64_t stride = 1) const {
        return at::conv2d(x, weight(name), bias(name), stride, weight(name).size(2) / 2);
    }
    tensor linear(tensor const& x, std::string const& name) const {
        return at::linear(x, weight(name).flatten(1), bias(name));
    }
    tensor norm(tensor const& x, std::string const& name, double eps = 1e-5) const {
        return at::group_norm(x, groups, weight(name), bias(name), eps);
    }
    tensor layer_norm(tensor const& x, std::string const& name) const {
        return at::layer_norm(x, {x.size(2)}, weight(name), bias(name));
    }
    tensor resnet(tensor const& x, context const& in, std::string const& name) const {
        auto const time = linear(in.time, name + ".time_emb_proj").unsqueeze(-1).unsqueeze(-1);
        auto const h = conv(at::silu(norm(x, name + ".norm1")), name + ".conv1") + time;
        auto const y = conv(at::silu(norm(h, name + ".norm2")), name + ".conv2");
        return y + (has(name + ".conv_shortcut") ? conv(x, name + ".conv_shortcut") : x);
    }
    tensor transformer(tensor const& x, context const& in, std::string const& name) const {
        auto h = linear(norm(x, name + ".norm", 1e-6).flatten(2).transpose(1, 2), name + ".proj_in");
        for (int i = 0; has(name + ".transformer_blocks." + std::to_string(i) + ".norm1"); ++i) {
            auto const block = name + ".transformer_blocks." + std::to_string(i);
            h = h + linear(in.run(block + ".attn1", layer_norm(h, block + ".norm1")), block + ".attn1.to_out.0");
            auto const Q = linear(layer_norm(h, block + ".norm2"), block + ".attn2.to_q");
            auto const K = linear(in.prompt, block + ".attn2.to_k");
            auto const F = attention(Q, K, linear(in.prompt, block + ".attn2.to_v"), heads_of(name));
            h = h + linear(F, block + ".attn2.to_out.0");
            auto const parts = linear(layer_norm(h, block + ".norm3"), block + ".ff.net.0.proj").chunk(2, -1);
            h = h + linear(parts[0] * at::gelu(parts[1]), block + ".ff.net.2");
        }
        return x + linear(h, name + ".proj_out").transpose(1, 2).unflatten(2, {x.size(2), x.size(3)});
    }
    /// A resnet of a block, and the attention behind it if there is one.
    tensor layer(tensor const& x, context const& in, std::string const& block, int i) const {
        auto const h = resnet(x, in, block + ".resnets." + std::to_string(i));
        auto const behind = block + ".attentions." + std::to_string(i);
        return has(behind + ".norm") ? transformer(h, in, behind) : h;
    }
    tensor embedded_time(double t) const {
        auto const half = weight("time_embedding.linear_1").size(1) / 2;
        auto const angles =
            at::arange(half, weight("conv_in").options()).mul(-std::log(10000.0) / static_cast<double>(half)).exp() * t;
        auto const waves = at::cat({angles.cos(), angles.sin()}).unsqueeze(0);
        return at::silu(linear(at::silu(linear(waves, "time_embedding.linear_1")), "time_embedding.linear_2"));
    }
    /// The way down, the middle last.
    std::vector<tensor> encode(tensor const& z, context const& in, tensor const& hint = {}) const {
        std::vector<tensor> maps{hint.defined() ? conv(z, "conv_in") + hint : conv(z, "conv_in")};
        for (std::int64_t level = 0; level <= last_level(); ++level) {
            auto const block = "down_blocks." + std::to_string(level);
            for (int i = 0; has(block + ".resnets." + std::to_string(i) + ".conv1"); ++i) {
                maps.push_back(layer(maps.back(), in, block, i));
            }
            if (has(block + ".downsamplers.0.conv")) {
                maps.push_back(conv(maps.back(), block + ".downsamplers.0.conv", 2));
            }
        }
        maps.push_back(resnet(layer(maps.back(), in, "mid_block", 0), in, "mid_block.resnets.1"));
        return maps;
    }
    tensor decode(std::vector<tensor> maps, context const& in) const {
        auto h = std::exchange(maps.back(), {});
        maps.pop_back();
        for (std::int64_t number = 0; number <= last_level(); ++number) {
            auto const block = "up_blocks." + std::to_string(number);
            for (int i = 0; has(block + ".resnets." + std::to_string(i) + ".conv1"); ++i) {
                h = layer(at::cat({h, maps.back()}, 1), in, block, i);
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

/// The output of the UNet for c_in z at time t.
inline tensor predict(network const& unet, network const& control, tensor const& z, double t, tensor const& prompt,
                      tensor const& hint, self_attention const& run) {
    self_attention const own = [&](std::string const& name, tensor const& f) {
        auto const project = [&](char const* part) { return control.linear(f, name + part); };
        return attention(project(".to_q"), project(".to_k"), project(".to_v"), control.heads_of(name));
    };
    auto const words = prompt.expand({z.size(0), -1, -1});
    auto const added = control.control(z, {control.embedded_time(t), words, own}, hint);
    context const in{unet.embedded_time(t), words, run};
    auto maps = unet.encode(z, in);
    for (std::size_t i = 0; i < maps.size(); ++i) {
        maps[i] = maps[i] + added[i];
    }
    return unet.decode(std::move(maps), in);
}

} // namespace engine
