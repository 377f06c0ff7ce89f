// SPDX-License-Identifier: MIT
// Tests of all parameters in one file.
#include <genrender/models/reference_weights.hpp>

#include "small_networks.hpp"

#include <genrender/models/reference_network.hpp>

#include <doctest/doctest.h>

using namespace genrender;
using namespace genrender::testing;

TEST_SUITE("models/reference_weights") {
    TEST_CASE_TEMPLATE("a network from a saved file is the seeded one to the bit", Real, float, double) {
        temporary_file const file("all.safetensors");
        auto const config = small_config();
        stack<float, 3> depth({1, 8, 8});
        depth(0, 3, 3) = 1;
        plain_attention const plain;
        auto const z = random_stack<Real, 4>({1, 4, 4, 4}, 1);
        auto const estimate = [&](reference_weights<Real>& all) {
            auto conditioning = all.conditioning(config, depth, "dots");
            reference_network<Real> const network(config, all.unet, all.controlnet, std::move(conditioning));
            stack<Real, 4> x0(z.extents());
            network(x0.view(), z.view(), Real(2), std::array{frame_index{0}}, plain);
            return x0;
        };
        auto seeded = reference_weights<Real>::seeded(5);
        auto const expected = estimate(seeded);
        seeded.save(file.path());
        auto loaded = reference_weights<Real>::from_file(file.path());
        auto const found = estimate(loaded);
        for (std::size_t e = 0; e < z.size(); ++e) {
            CHECK(found.data()[e] == expected.data()[e]);
        }
    }

    TEST_CASE("a tensor of none of the networks is named") {
        temporary_file const file("foreign.safetensors");
        std::vector<float> const one{1.0f};
        write_safetensors(file.path(), {{"unet.a", {{1}, one}}, {"vae.a", {{1}, one}}});
        CHECK_THROWS_WITH_AS(
            reference_weights<float>::from_file(file.path()),
            (file.path() + ": tensor vae.a belongs to no network, expected names that begin with unet., controlnet. or prompt.").c_str(),
            file_error);
    }
}
