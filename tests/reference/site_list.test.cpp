// SPDX-License-Identifier: MIT
// Tests of the list of self-attention modules.
#include <genrender/reference/site_list.hpp>

#include <doctest/doctest.h>

using namespace genrender;

using namespace genrender::reference;

TEST_SUITE("reference/site_list") {
    TEST_CASE("sites are numbered as they come and their grid is halved with the level") {
        site_list sites({16, 24});
        sites.begin(network_kind::control);
        CHECK(sites.add("a.attn1", network_part::encoder, 1, 64).value == 0);
        sites.begin(network_kind::denoising);
        CHECK(sites.add("b.attn1", network_part::middle, 3, 96).value == 1);
        auto const found = sites.sites();
        CHECK(found.size() == 2);
        CHECK(found[0].name == "a.attn1");
        CHECK(found[0].network == network_kind::control);
        CHECK(found[0].grid == grid_extents{8, 12});
        CHECK(found[0].channels == 64);
        CHECK(found[1].network == network_kind::denoising);
        CHECK(found[1].part == network_part::middle);
        CHECK(found[1].grid == grid_extents{2, 3});
    }
}
