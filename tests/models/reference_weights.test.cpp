// SPDX-License-Identifier: MIT
// One file holds the weights of all three networks.
#include <genrender/models/reference_weights.hpp>

#include <genrender/attention/plain_attention.hpp>
#include <genrender/models/reference_network.hpp>

#include <doctest/doctest.h>

#include <array>
#include <cstddef>
#include <cstdio>
#include <filesystem>
#include <string>

using namespace genrender;

namespace {

/// A file in the system's folder for such, removed at the end.
struct scratch_file {
    std::string path;
    explicit scratch_file(char const* name)
        : path((std::filesystem::temp_directory_path() / ("genrender_" + std::string(name))).string()) {}
    scratch_file(scratch_file const&) = delete;
    scratch_file& operator=(scratch_file const&) = delete;
    ~scratch_file() { std::remove(path.c_str()); }
};

stack<float, 4> estimate(reference_network<float> const& network) {
    std::array const frames{frame_index{0}};
    stack<float, 4> z({1, network.latent_channels(), network.latent_grid().height, network.latent_grid().width});
    for (std::size_t e = 0; e < z.size(); ++e) {
        z.data()[e] = static_cast<float>(normal_value(1, random_stream::test, {static_cast<std::uint32_t>(e), 0, 0}));
    }
    stack<float, 4> x0(z.extents());
    plain_attention const plain;
    network(x0.view(), z.view(), 1.0f, frames, plain);
    return x0;
}

reference_network<float> network_of(reference_weights<float>& source, stack<float, 3> const& hint) {
    unet_config const config;
    return {config, source.unet, source.controlnet, source.conditioning(config, hint.view(), "dots")};
}

} // namespace

TEST_SUITE("models/reference_weights") {
    TEST_CASE("weights that were saved give the same estimates to the bit") {
        scratch_file const file("reference_weights.safetensors");
        stack<float, 3> hint({1, 16, 16});
        hint(0, 3, 4) = 0.5f;
        auto seeded = reference_weights<float>::seeded(3);
        auto const expected = estimate(network_of(seeded, hint));
        seeded.save(file.path);
        auto loaded = reference_weights<float>::from_file(file.path);
        auto const found = estimate(network_of(loaded, hint));
        for (std::size_t e = 0; e < expected.size(); ++e) {
            REQUIRE(found.data()[e] == expected.data()[e]);
        }
    }
    TEST_CASE("a tensor of no network and a network that is missing are named") {
        scratch_file const file("stray.safetensors");
        std::array const one{1.0f};
        write_safetensors(file.path, {{"vae.scale", {{1}, one}}}, safetensors_storage::f32);
        CHECK_THROWS_WITH_AS(reference_weights<float>::from_file(file.path),
                             (file.path +
                              ": tensor vae.scale belongs to no network, expected names that begin with unet., "
                              "controlnet. or prompt.")
                                 .c_str(),
                             file_error);
        write_safetensors(file.path, {{"unet.odd", {{1}, one}}}, safetensors_storage::f32);
        auto loaded = reference_weights<float>::from_file(file.path);
        stack<float, 3> const hint({1, 16, 16});
        CHECK_THROWS_WITH_AS(
            network_of(loaded, hint),
            (file.path + ": there is no tensor prompt.token_embedding.weight, expected one of shape [9, 48]").c_str(),
            file_error);
    }
}
