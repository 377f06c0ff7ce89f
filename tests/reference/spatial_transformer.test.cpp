// SPDX-License-Identifier: MIT
// Tests of the transformer between feature maps.
#include <genrender/reference/spatial_transformer.hpp>

#include "small_networks.hpp"

#include <doctest/doctest.h>

using namespace genrender;

using namespace genrender::reference;
using namespace genrender::testing;

TEST_SUITE("reference/spatial_transformer") {
    TEST_CASE_TEMPLATE("the block runs between two 1x1 convolutions beside the residual", Real, float, double) {
        auto const config = small_config();
        auto source = weights<Real>::seeded(1, "test");
        site_list sites({4, 6});
        spatial_transformer<Real> const transformer(config, source, sites, "a", 0, network_part::encoder);
        CHECK(sites.sites()[0].name == "a.transformer_blocks.0.attn1");
        group_norm<Real> const norm(source, "a.norm", 8, 4, Real(1e-6));
        transformer_block<Real> const block(config, source, sites, "a.transformer_blocks.0", 0, network_part::encoder);
        small_pass<Real> const small;
        auto const x = random_maps<Real>(2, {4, 6}, 8, 2);
        auto const conv = [&](in_view<Real, 2> in, std::string const& name) {
            return plain_conv2d<Real>(in, {4, 6}, source.take(name + ".weight", {8, 8, 1, 1}),
                                      source.take(name + ".bias", {8}), 1, 1);
        };
        feature_maps<Real> h(2, {4, 6}, 8);
        for (std::size_t i = 0; i < 2; ++i) {
            stack<Real, 2> normed({24, 8});
            norm(normed.view(), x[i]);
            copy(h[i], in_view<Real, 2>(conv(normed, "a.proj_in")));
        }
        block(small.pass, h);
        auto found = x;
        transformer(small.pass, found);
        for (std::size_t i = 0; i < 2; ++i) {
            auto expected = conv(h[i], "a.proj_out");
            add_scaled(expected.view(), x[i]);
            check_close<Real, 2>(found[i], expected);
        }
    }

    TEST_CASE_TEMPLATE("blocks follow each other and projections may be matrices", Real, float, double) {
        auto config = small_config();
        config.use_linear_projection = true;
        config.transformer_layers_per_block = 2;
        auto source = weights<Real>::seeded(1, "test");
        site_list sites({4, 6});
        spatial_transformer<Real> const transformer(config, source, sites, "a", 0, network_part::encoder);
        REQUIRE(sites.sites().size() == 2);
        CHECK(sites.sites()[1].name == "a.transformer_blocks.1.attn1");
        CHECK(source.taken().at("a.proj_in.weight") == std::vector<std::size_t>{8, 8});
        group_norm<Real> const norm(source, "a.norm", 8, 4, Real(1e-6));
        linear<Real> const proj_in(source, "a.proj_in", 8, 8);
        transformer_block<Real> const first(config, source, sites, "a.transformer_blocks.0", 0, network_part::encoder);
        transformer_block<Real> const second(config, source, sites, "a.transformer_blocks.1", 0, network_part::encoder);
        linear<Real> const proj_out(source, "a.proj_out", 8, 8);
        small_pass<Real> const small;
        auto const x = random_maps<Real>(2, {4, 6}, 8, 2);
        feature_maps<Real> h(2, {4, 6}, 8);
        for (std::size_t i = 0; i < 2; ++i) {
            stack<Real, 2> normed({24, 8});
            norm(normed.view(), x[i]);
            proj_in(h[i], normed);
        }
        first(small.pass, h);
        second(small.pass, h);
        auto found = x;
        auto expected = x;
        transformer(small.pass, found);
        for (std::size_t i = 0; i < 2; ++i) {
            proj_out.add_to(expected[i], h[i]);
            check_close<Real, 2>(found[i], expected[i]);
        }
    }
}
