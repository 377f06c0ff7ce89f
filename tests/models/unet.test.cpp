// SPDX-License-Identifier: MIT
// Tests of the UNet, with and without the ControlNet beside it, against diffusers.
#include <genrender/models/unet.hpp>

#include "golden.hpp"
#include "small_networks.hpp"

#include <genrender/models/controlnet.hpp>

#include <doctest/doctest.h>

#include <algorithm>

using namespace genrender;
using namespace genrender::testing;

namespace {

/// Numbers in [-1, 1): the scrambled sum (Steele et al. 2014, splitmix64) of a hash of the name and the index.
std::vector<float> golden_values(std::string const& name, std::size_t count) {
    std::uint64_t begin = 0xCBF29CE484222325U;
    for (auto const letter : name) {
        begin = (begin ^ static_cast<unsigned char>(letter)) * 0x100000001B3U;
    }
    std::vector<float> values(count);
    for (std::size_t i = 0; i < count; ++i) {
        auto x = begin + i * 0x9E3779B97F4A7C15U;
        x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9U;
        x = (x ^ (x >> 27)) * 0x94D049BB133111EBU;
        x ^= x >> 31;
        values[i] = static_cast<float>(x >> 40) * 0x1p-23f - 1;
    }
    return values;
}

/// Writes a file with every tensor that a network takes, filled as make_golden.py fills them.
template <class Network>
void write_golden_weights(std::string const& path, unet_config const& config, std::string const& prefix) {
    auto shapes = weights<float>::seeded(1, "");
    site_list sites({8, 12});
    Network const network(config, shapes, sites);
    std::map<std::string, std::vector<float>> values;
    std::map<std::string, safetensors_source> sources;
    for (auto const& [name, shape] : shapes.taken()) {
        std::size_t count = 1;
        for (auto const extent : shape) {
            count *= extent;
        }
        auto& x = values[name] = golden_values(prefix + name, count);
        auto const fan_in = static_cast<double>(count / shape[0]);
        auto const scale = static_cast<float>(std::exp2(std::floor(std::log2(std::sqrt(3 / fan_in)))));
        for (auto& value : x) {
            value = shape.size() > 1 ? scale * value : 0.25f * value + (name.ends_with("weight") ? 1.0f : 0.0f);
        }
        sources[name] = {shape, x};
    }
    write_safetensors(path, sources);
}

unet_config golden_config() {
    unet_config config;
    config.in_channels = config.out_channels = 4;
    config.block_out_channels = {8, 12, 16};
    config.level_has_attention = {true, true, false};
    config.layers_per_block = 2;
    config.attention_head_dim = {2, 3, 4};
    config.cross_attention_dim = 6;
    config.norm_num_groups = 4;
    config.conditioning_embedding_out_channels = {4, 6};
    return config;
}

template <class Real, std::size_t Rank>
stack<Real, Rank> golden_stack(std::string const& name, std::array<std::size_t, Rank> const& extents) {
    stack<Real, Rank> result(extents);
    auto const values = golden_values(name, result.size());
    std::copy(values.begin(), values.end(), result.data());
    return result;
}

} // namespace

TEST_SUITE("models/unet") {
    TEST_CASE_TEMPLATE("outputs equal those of diffusers with and without the ControlNet", Real, float, double) {
        temporary_file const unet_file("golden-unet.safetensors");
        temporary_file const control_file("golden-control.safetensors");
        auto const config = golden_config();
        write_golden_weights<unet<float>>(unet_file.path(), config, "unet.");
        write_golden_weights<controlnet<float>>(control_file.path(), config, "controlnet.");
        auto unet_weights = weights<Real>::from_file(unet_file.path());
        auto control_weights = weights<Real>::from_file(control_file.path());
        site_list sites({8, 12});
        controlnet<Real> const control(config, control_weights, sites);
        unet<Real> const network(config, unet_weights, sites);

        std::array const frames{frame_index{0}};
        auto const prompt = golden_stack<Real, 2>("prompt", {5, 6});
        plain_attention const plain;
        sequential_loop const loop;
        forward_pass<Real, plain_attention const, sequential_loop> pass{frames, 0, prompt.view(), &plain, &loop};
        feature_maps<Real> z(1, {8, 12}, 4);
        feature_maps<Real> hint(1, {16, 24}, 3);
        copy(z.channels_first(), in_view<Real, 4>(golden_stack<Real, 4>("z", {1, 4, 8, 12}).view()));
        copy(hint.channels_first(), in_view<Real, 4>(golden_stack<Real, 4>("hint", {1, 3, 16, 24}).view()));
        auto const check = [](feature_maps<Real> output, auto const& expected) {
            auto const view = output.channels_first();
            for (std::size_t n = 0; n < expected.size(); ++n) {
                // diffusers makes the sinusoids of time in single precision whatever the rest is.
                CHECK(static_cast<double>(view(0, n / 8, n % 8, 0)) ==
                      doctest::Approx(expected[n]).epsilon(std::is_same_v<Real, float> ? 1e-4 : 5e-6));
            }
        };
        check(network(pass, z, Real(417.5)), golden::unet_output);
        auto const embedded = control.embed(hint);
        auto const added = control(pass, z, Real(417.5), {&embedded}, Real(0.75));
        check(network(pass, z, Real(417.5), &added), golden::controlled_output);
    }

    TEST_CASE("tensors that are missing or misshapen or left over are named") {
        temporary_file const file("incomplete.safetensors");
        auto const config = small_config();
        auto source = weights<float>::seeded(1, "unet");
        site_list sites({4, 4});
        unet<float> const whole(config, source, sites);
        auto const build = [&](auto change) {
            auto values = source.values();
            std::map<std::string, safetensors_source> sources;
            for (auto const& [name, elements] : values) {
                sources[name] = {source.taken().at(name), elements};
            }
            change(sources);
            write_safetensors(file.path(), sources);
            auto loaded = weights<float>::from_file(file.path());
            site_list more({4, 4});
            unet<float> const network(config, loaded, more);
        };
        auto const text = [&](std::string const& sentence) { return file.path() + ": " + sentence; };
        auto const to_q = std::string("up_blocks.1.attentions.1.transformer_blocks.0.attn1.to_q.weight");
        CHECK_NOTHROW(build([](auto&) {}));
        CHECK_THROWS_WITH_AS(build([&](auto& tensors) { tensors.erase(to_q); }),
                             text("there is no tensor " + to_q + ", expected one of shape [8, 8]").c_str(), file_error);
        CHECK_THROWS_WITH_AS(build([&](auto& tensors) {
                                 tensors[to_q].shape = {4, 16};
                             }),
                             text("tensor " + to_q + " is [4, 16], expected [8, 8]").c_str(), file_error);
        std::vector<float> const one{1.0f};
        CHECK_THROWS_WITH_AS(build([&](auto& tensors) {
                                 tensors["add_embedding.bias"] = {{1}, one};
                             }),
                             text("1 tensors have no place in the network: add_embedding.bias, expected none").c_str(),
                             file_error);
    }
}
