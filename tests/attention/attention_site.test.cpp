// SPDX-License-Identifier: MIT
// Sites and places: their defaults and their order.
#include <genrender/attention/attention_site.hpp>

#include <doctest/doctest.h>

#include <concepts>
#include <map>

using namespace genrender;

TEST_SUITE("attention/attention_site") {
    TEST_CASE("a site is one of the denoiser's decoder unless it says otherwise") {
        attention_site const site;
        CHECK(site.network == network_kind::denoising);
        CHECK(site.part == network_part::decoder);
        CHECK(site.grid.size() == 0);
        CHECK(site.channels == 0);
    }

    TEST_CASE("places differ by site and by branch") {
        attention_place const first{{2}, 0};
        CHECK(first == attention_place{{2}, 0});
        CHECK(first != attention_place{{2}, 1});
        CHECK(first != attention_place{{1}, 0});
        CHECK(attention_place{}.site.value == 0);
        CHECK(attention_place{}.branch == 0);
        std::map<attention_place, int> places{{{{0}, 1}, 1}, {{{1}, 0}, 2}, {{{0}, 1}, 3}};
        CHECK(places.size() == 2);
        CHECK(places.begin()->first.site == site_index{0});
    }

    TEST_CASE("a site's number is no frame and no token") {
        CHECK_FALSE(std::convertible_to<frame_index, site_index>);
        CHECK_FALSE(std::convertible_to<site_index, token_index>);
        CHECK_FALSE(std::convertible_to<std::uint32_t, site_index>);
    }
}
