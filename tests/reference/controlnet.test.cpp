// SPDX-License-Identifier: MIT
// Tests of the ControlNet.
#include <genrender/reference/controlnet.hpp>

#include "small_networks.hpp"

#include <doctest/doctest.h>

using namespace genrender;

using namespace genrender::reference;
using namespace genrender::testing;

TEST_SUITE("reference/controlnet") {
    TEST_CASE_TEMPLATE("what it adds fits the skips of the UNet and scales with its factor", Real, float, double) {
        auto const config = small_config();
        auto source = weights<Real>::seeded(1, "test");
        site_list sites({4, 4});
        controlnet<Real> const control(config, source, sites);
        small_pass<Real> small;
        auto const z = random_maps<Real>(2, {4, 4}, 4, 2);
        auto const hint = control.embed(random_maps<Real>(1, {8, 8}, 3, 3));
        CHECK(hint.view().extents() == std::array<std::size_t, 3>{1, 16, 8});
        auto const full = control(small.pass, z, Real(9), {&hint, &hint}, Real(1));
        auto half = control(small.pass, z, Real(9), {&hint, &hint}, Real(0.5));
        REQUIRE(full.skips.size() == skip_channels(config).size());
        for (std::size_t s = 0; s < full.skips.size(); ++s) {
            CHECK(full.skips[s].channels() == skip_channels(config)[s]);
            add_scaled(half.skips[s][1], std::as_const(half.skips[s])[1]);
            check_close<Real, 2>(half.skips[s][1], full.skips[s][1]);
        }
        CHECK(full.middle.channels() == 12);
    }

    TEST_CASE_TEMPLATE("the hint passes its convolutions with SiLU between them", Real, float, double) {
        auto const config = small_config();
        auto source = weights<Real>::seeded(1, "test");
        hint_embedding<Real> const embed(config, source);
        auto const hint = random_maps<Real>(1, {8, 4}, 3, 3);
        auto const name = std::string("controlnet_cond_embedding");
        stack<Real, 2> h({32, 3});
        copy(h.view(), hint[0]);
        auto const step = [&](std::string const& conv, grid_extents grid, std::size_t in, std::size_t out,
                              std::size_t stride, bool last) {
            h = plain_conv2d<Real>(h, grid, source.take(name + conv + ".weight", {out, in, 3, 3}),
                                   source.take(name + conv + ".bias", {out}), 3, stride);
            for (std::size_t e = 0; e < h.size() && !last; ++e) {
                h.data()[e] = h.data()[e] / (1 + std::exp(-h.data()[e]));
            }
        };
        step(".conv_in", {8, 4}, 3, 3, 1, false);
        step(".blocks.0", {8, 4}, 3, 3, 1, false);
        step(".blocks.1", {8, 4}, 3, 5, 2, false);
        step(".conv_out", {4, 2}, 5, 8, 1, true);
        auto const embedded = embed(hint);
        check_close<Real const, 2>(embedded[0], h);
    }
}
