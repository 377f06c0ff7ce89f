// SPDX-License-Identifier: MIT
// Tests of the autoencoder against diffusers.
#include <genrender/reference/autoencoder_kl.hpp>

#include "golden_network.hpp"
#include "small_networks.hpp"

#include <genrender/reference/autoencoder_config_file.hpp>
#include <genrender/reference/safetensors_weights.hpp>

#include <genrender/core/parallel.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <fstream>
#include <functional>
#include <map>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

using namespace genrender;

using namespace genrender::reference;
using namespace genrender::testing;

TEST_SUITE("reference/autoencoder_kl") {
    /// An autoencoder of diffusers: what it is, its tensors and their shapes by name.
    struct vae_model {
        autoencoder_config config;
        std::map<std::string, std::vector<float>> values;
        std::map<std::string, safetensors_source> sources;
    };

    vae_model model_of(nlohmann::json const& golden) {
        temporary_file const file("config.json");
        std::ofstream(file.path()) << golden.at("config");
        vae_model model{read_autoencoder_config(config_file(file.path())), {}, {}};
        auto shapes = weights<float>::seeded(1, "");
        autoencoder_kl<float> const network(model.config, shapes);
        model.values = golden_tensors(shapes.taken(), golden.at("name").get<std::string>() + ".");
        for (auto const& [name, shape] : shapes.taken()) {
            model.sources[name] = {shape, model.values.at(name)};
        }
        return model;
    }

    template <class Real>
    autoencoder_kl<Real> built(vae_model const& model, std::string const& path,
                               autoencoder_parts parts = autoencoder_parts::both) {
        write_safetensors(path, model.sources);
        auto source = read_weights<Real>(path);
        return {model.config, source, parts};
    }

    template <class Real>
    std::vector<Real> numbers_of(stack<Real, 3> const& maps) {
        return {maps.data(), maps.data() + maps.size()};
    }

    /// What goes into a golden case.
    template <class Real>
    struct vae_inputs {
        stack<Real, 3> z;
        stack<Real, 3> picture;

        vae_inputs(nlohmann::json const& golden, autoencoder_config const& config) {
            auto const name = golden.at("name").get<std::string>();
            auto const grid = golden.at("grid").get<std::array<std::size_t, 2>>();
            z = golden_stack<Real, 3>(name + ".z", {config.latent_channels, grid[0], grid[1]});
            picture = golden_stack<Real, 3>(name + ".picture", {3, config.scale() * grid[0], config.scale() * grid[1]});
        }
    };

    TEST_CASE_TEMPLATE("pictures and latents equal those of diffusers", Real, float, double) {
        auto const bound = std::is_same_v<Real, float> ? 1e-5 : 1e-12;
        auto const file = golden_file("autoencoder.json");
        for (auto const& golden : file.at("cases")) {
            auto const model = model_of(golden);
            temporary_file const weights_file("vae.safetensors");
            auto const vae = built<Real>(model, weights_file.path());
            vae_inputs<Real> const in(golden, model.config);
            auto const decoded =
                difference_share(numbers_of(vae.decode(in.z)), read_golden_output(golden.at("decoded")));
            auto const latent = vae.encode(in.picture);
            auto const mean = difference_share(numbers_of(latent.mean), read_golden_output(golden.at("mean")));
            auto const log_variance =
                difference_share(numbers_of(latent.log_variance), read_golden_output(golden.at("log_variance")));
            CHECK(decoded <= bound);
            CHECK(mean <= bound);
            CHECK(log_variance <= bound);
            MESSAGE(golden.at("name").get<std::string>(), ": ", decoded, " of the picture's range, ", mean,
                    " of the mean's, ", log_variance, " of the log variance's");
        }
    }

    TEST_CASE_TEMPLATE("stripes of any height and threads give the whole map's numbers to the bit", Real, float,
                       double) {
        auto const file = golden_file("autoencoder.json");
        for (auto const& golden : file.at("cases")) {
            auto const model = model_of(golden);
            temporary_file const weights_file("vae.safetensors");
            auto const vae = built<Real>(model, weights_file.path());
            vae_inputs<Real> const in(golden, model.config);
            auto const whole = numbers_of(vae.decode(in.z, {{}, std::size_t{1} << 40}));
            auto const latent = vae.encode(in.picture, {{}, std::size_t{1} << 40});
            for (std::size_t const bytes : {1U, 4000U, 11000U, 40000U}) {
                for (auto const& loop : {any_loop{}, any_loop(threaded_loop(3))}) {
                    CHECK(numbers_of(vae.decode(in.z, {loop, bytes})) == whole);
                    auto const striped = vae.encode(in.picture, {loop, bytes});
                    CHECK(numbers_of(striped.mean) == numbers_of(latent.mean));
                    CHECK(numbers_of(striped.log_variance) == numbers_of(latent.log_variance));
                }
            }
        }
    }

    TEST_CASE("old names of the attention's matrices are understood") {
        auto const golden = golden_file("autoencoder.json").at("cases").at(0);
        auto model = model_of(golden);
        temporary_file const file("vae.safetensors");
        auto const now = built<float>(model, file.path());
        vae_inputs<float> const in(golden, model.config);
        auto const expected = numbers_of(now.decode(in.z));
        auto const mean = numbers_of(now.encode(in.picture).mean);
        for (std::string const part : {"encoder", "decoder"}) {
            for (auto const& [name, before] :
                 {std::pair{".to_q.", ".query."}, std::pair{".to_k.", ".key."}, std::pair{".to_v.", ".value."},
                  std::pair{".to_out.0.", ".proj_attn."}}) {
                for (std::string const tensor : {"weight", "bias"}) {
                    auto const at = part + ".mid_block.attentions.0";
                    auto renamed = model.sources.extract(at + name + tensor);
                    REQUIRE(!renamed.empty());
                    renamed.key() = at + before + tensor;
                    model.sources.insert(std::move(renamed));
                }
            }
        }
        temporary_file const old_file("old.safetensors");
        auto const old = built<float>(model, old_file.path());
        CHECK(numbers_of(old.decode(in.z)) == expected);
        CHECK(numbers_of(old.encode(in.picture).mean) == mean);
    }

    TEST_CASE("a decoder alone decodes and leaves the encoder's tensors in the file") {
        auto const golden = golden_file("autoencoder.json").at("cases").at(0);
        auto model = model_of(golden);
        temporary_file const file("vae.safetensors");
        auto const both = built<float>(model, file.path());
        auto const half = built<float>(model, file.path(), autoencoder_parts::decoder);
        vae_inputs<float> const in(golden, model.config);
        CHECK(numbers_of(half.decode(in.z)) == numbers_of(both.decode(in.z)));
        CHECK_THROWS_WITH_AS(half.encode(in.picture),
                             "autoencoder_kl: encoder is not loaded, expected autoencoder_parts::both", value_error);
        std::vector<float> const one{1.0f};
        model.sources["loss.logvar"] = {{1}, one};
        CHECK_THROWS_WITH_AS(
            built<float>(model, file.path(), autoencoder_parts::decoder),
            (file.path() + ": 1 tensors have no place in the network: loss.logvar, expected none").c_str(), file_error);
    }

    TEST_CASE("a missing or misshapen or surplus tensor is named") {
        auto const golden = golden_file("autoencoder.json").at("cases").at(0);
        temporary_file const file("vae.safetensors");
        auto const build = [&](std::function<void(std::map<std::string, safetensors_source>&)> const& change) {
            auto model = model_of(golden);
            change(model.sources);
            built<float>(model, file.path());
        };
        auto const text = [&](std::string const& sentence) { return file.path() + ": " + sentence; };
        std::string const to_q = "decoder.mid_block.attentions.0.to_q.weight";
        CHECK_THROWS_WITH_AS(build([&](auto& tensors) { tensors.erase(to_q); }),
                             text("there is no tensor " + to_q + ", expected one of shape [32, 32]").c_str(),
                             file_error);
        std::string const quant = "quant_conv.weight";
        CHECK_THROWS_WITH_AS(build([&](auto& tensors) {
                                 tensors[quant].shape = {8, 8};
                             }),
                             text("tensor quant_conv.weight is [8, 8], expected [8, 8, 1, 1]").c_str(), file_error);
        std::vector<float> const one{1.0f};
        CHECK_THROWS_WITH_AS(
            build([&](auto& tensors) {
                tensors["decoder.up_blocks.3.upsamplers.0.conv.bias"] = {{1}, one};
            }),
            text("1 tensors have no place in the network: decoder.up_blocks.3.upsamplers.0.conv.bias, expected none")
                .c_str(),
            file_error);
    }

    TEST_CASE("inputs that do not fit are told") {
        auto const golden = golden_file("autoencoder.json").at("cases").at(0);
        temporary_file const file("vae.safetensors");
        auto const vae = built<float>(model_of(golden), file.path());
        CHECK(vae.config().scale() == 8);
        CHECK_THROWS_WITH_AS(vae.decode(stack<float, 3>({3, 2, 2})),
                             "autoencoder_kl: z is [3, 2, 2], expected [4, 2, 2]", shape_error);
        CHECK_THROWS_WITH_AS(vae.decode(stack<float, 3>({4, 2, 0})),
                             "autoencoder_kl: z is empty, expected at least one token", value_error);
        CHECK_THROWS_WITH_AS(vae.encode(stack<float, 3>({1, 16, 16})),
                             "autoencoder_kl: picture is [1, 16, 16], expected [3, 16, 16]", shape_error);
        CHECK_THROWS_WITH_AS(vae.encode(stack<float, 3>({3, 16, 20})),
                             "autoencoder_config: width of the picture is 20, expected a multiple of 8 above 0",
                             value_error);
    }
}
