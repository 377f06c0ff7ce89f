// SPDX-License-Identifier: MIT
// Tests of the transformer between feature maps.
#include <genrender/models/spatial_transformer.hpp>

#include "small_networks.hpp"

#include <doctest/doctest.h>

using namespace genrender;
using namespace genrender::testing;

TEST_SUITE("models/spatial_transformer") {
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
}
