// SPDX-License-Identifier: MIT
// Tests of the UNet, with and without the ControlNet beside it, against diffusers.
#include <genrender/reference/unet.hpp>

#include "golden_case.hpp"
#include "golden_network.hpp"
#include "small_networks.hpp"

#include <genrender/reference/controlnet.hpp>
#include <genrender/reference/diffusers_folder.hpp>
#include <genrender/reference/safetensors_weights.hpp>

#include <doctest/doctest.h>

#include <algorithm>

using namespace genrender;

using namespace genrender::reference;
using namespace genrender::testing;

namespace {

/// Largest difference from what diffusers computed, as a share of its output's range.
template <class Real>
double difference_share(feature_maps<Real> output, golden_output const& golden) {
    auto const found = output.channels_first();
    auto const [frames, channels, height, width] = found.extents();
    auto const& expected = std::is_same_v<Real, float> ? golden.single : golden.precise;
    double largest = 0;
    for (std::size_t n = 0; n < expected.size(); ++n) {
        auto const i = n * golden.step;
        auto const value = found(0, i / (height * width), i / width % height, i % width);
        largest = std::max(largest, std::abs(static_cast<double>(value) - expected[n]));
    }
    return largest / golden.range;
}

} // namespace

TEST_SUITE("reference/unet") {
    TEST_CASE_TEMPLATE("outputs equal those of diffusers with and without the ControlNet", Real, float, double) {
        auto const bound = std::is_same_v<Real, float> ? 1e-5 : 1e-12;
        for (std::size_t c = 0; c < golden_cases().size(); ++c) {
            auto const& golden = golden_cases()[c];
            auto const& name = golden.name;
            CAPTURE(name);
            temporary_file const folder("golden");
            write_golden_folder(folder.path(), golden, golden_configs()[c]);
            diffusers_folder const files(folder.path());
            auto const config = files.config();
            auto unet_weights = files.template unet<Real>();
            auto control_weights = files.template controlnet<Real>();
            site_list sites(golden.grid);
            controlnet<Real> const control(config, control_weights, sites);
            unet<Real> const network(config, unet_weights, sites);

            auto const scale = config.hint_scale();
            std::array const frames{frame_index{0}};
            auto const prompt = golden_stack<Real, 2>(name + ".prompt", {golden.tokens, config.cross_attention_dim});
            plain_attention const plain;
            sequential_loop const loop;
            forward_pass<Real> pass{frames, 0, prompt.view(), plain, loop};
            auto const input = [](std::string const& of, grid_extents grid, std::size_t channels) {
                feature_maps<Real> maps(1, grid, channels);
                auto const values = golden_stack<Real, 4>(of, {1, channels, grid.height, grid.width});
                copy(maps.channels_first(), in_view<Real, 4>(values.view()));
                return maps;
            };
            auto const z = input(name + ".z", golden.grid, config.in_channels);
            auto const hint = input(name + ".hint", {scale * golden.grid.height, scale * golden.grid.width},
                                    config.conditioning_channels);
            auto const t = static_cast<Real>(golden.t);
            auto const alone = difference_share(network(pass, z, t), golden.alone);
            CHECK(alone <= bound);
            auto const embedded = control.embed(hint);
            auto const added = control(pass, z, t, {&embedded}, static_cast<Real>(golden.scale));
            auto const controlled = difference_share(network(pass, z, t, &added), golden.controlled);
            CHECK(controlled <= bound);
            MESSAGE(name, ": ", alone, " of the output's range, with the ControlNet ", controlled);
        }
    }

    TEST_CASE("the ControlNet of a golden network is heard") {
        for (auto const& golden : golden_cases()) {
            CHECK(std::abs(golden.alone.precise[0] - golden.controlled.precise[0]) > 1e-3 * golden.alone.range);
        }
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
            auto loaded = read_weights<float>(file.path());
            site_list more({4, 4});
            unet<float> const network(config, loaded, more);
        };
        auto const text = [&](std::string const& sentence) { return file.path() + ": " + sentence; };
        auto const to_q = std::string("up_blocks.1.attentions.1.transformer_blocks.0.attn1.to_q.weight");
        CHECK_NOTHROW(build([](auto&) {}));
        CHECK_THROWS_WITH_AS(build([&](auto& tensors) { tensors.erase(to_q); }),
                             text("1 tensors are missing: " + to_q + " [8, 8], expected none").c_str(), file_error);
        CHECK_THROWS_WITH_AS(
            build([&](auto& tensors) {
                tensors[to_q].shape = {4, 16};
            }),
            text("1 tensors have another shape: " + to_q + " is [4, 16] where [8, 8] is asked for, expected none")
                .c_str(),
            file_error);
        std::vector<float> const one{1.0f};
        CHECK_THROWS_WITH_AS(build([&](auto& tensors) {
                                 tensors["add_embedding.bias"] = {{1}, one};
                             }),
                             text("1 tensors have no place in the network: add_embedding.bias, expected none").c_str(),
                             file_error);
        // All at once.
        CHECK_THROWS_WITH_AS(
            build([&](auto& tensors) {
                tensors.erase(to_q);
                tensors["conv_in.bias"].shape = {2, 4};
                for (auto const* name : {"a", "b", "c", "d", "e", "f"}) {
                    tensors[name] = {{1}, one};
                }
            }),
            text("1 tensors are missing: " + to_q +
                 " [8, 8]; 1 tensors have another shape: conv_in.bias is [2, 4] where [8] is asked for; "
                 "6 tensors have no place in the network: a, b, c, d, e, ..., expected none")
                .c_str(),
            file_error);
    }
}
