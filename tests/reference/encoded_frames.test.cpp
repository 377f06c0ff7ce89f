// SPDX-License-Identifier: MIT
// What is kept of encoded frames is found for the same frames at the same z alone.
#include <genrender/reference/encoded_frames.hpp>

#include "small_networks.hpp"

#include <doctest/doctest.h>

#include <array>
#include <cstddef>
#include <vector>

using namespace genrender;

using namespace genrender::reference;
using namespace genrender::testing;

TEST_SUITE("reference/encoded_frames") {
    TEST_CASE("the entries of the frames asked for come in their order") {
        std::array const frames{frame_index{7}, frame_index{2}, frame_index{5}};
        auto const z = random_stack<float, 4>({3, 2, 2, 3}, 1);
        encoded_frames<float> kept(frames, z.view(), 0.5F, 2);
        CHECK_FALSE(kept.find(0, frames, z.view(), 0.5F));
        auto const skip = random_maps<float>(3, {2, 3}, 4, 2);
        auto const middle = random_maps<float>(3, {1, 2}, 5, 3);
        kept.put(1, {{{skip, skip}, middle}, {1, 2, 3}});
        CHECK_FALSE(kept.find(0, frames, z.view(), 0.5F));

        std::array const two{frame_index{5}, frame_index{7}};
        stack<float, 4> z_two({2, 2, 2, 3});
        copy(z_two.view()[0], in_view<float, 3>(z.view()[2]));
        copy(z_two.view()[1], in_view<float, 3>(z.view()[0]));
        auto const found = kept.find(1, two, z_two.view(), 0.5F);
        REQUIRE(found.has_value());
        CHECK(found->time == std::vector<float>{1, 2, 3});
        REQUIRE(found->maps.skips.size() == 2);
        CHECK(found->maps.skips[1].frames() == 2);
        CHECK(found->maps.skips[1][0](5, 3) == skip[2](5, 3));
        CHECK(found->maps.middle[1](1, 4) == middle[0](1, 4));
        CHECK(found->maps.middle.grid() == grid_extents{1, 2});
    }
    TEST_CASE("another z or sigma or frame or branch is not known") {
        std::array const frames{frame_index{1}};
        auto z = random_stack<float, 4>({1, 2, 2, 3}, 1);
        encoded_frames<float> kept(frames, z.view(), 0.5F, 1);
        kept.put(0, {{{}, random_maps<float>(1, {1, 2}, 5, 3)}, {}});
        CHECK(kept.find(0, frames, z.view(), 0.5F));
        CHECK_FALSE(kept.find(1, frames, z.view(), 0.5F));
        CHECK_FALSE(kept.find(0, frames, z.view(), 0.25F));
        CHECK_FALSE(kept.find(0, std::array{frame_index{2}}, z.view(), 0.5F));
        CHECK_FALSE(encoded_frames<float>{}.find(0, frames, z.view(), 0.5F));
        z(0, 1, 1, 2) += 1;
        CHECK_FALSE(kept.find(0, frames, z.view(), 0.5F));
    }
    TEST_CASE("bytes of a frame are those of the encoder's outputs") {
        auto const config = small_config();
        auto source = weights<double>::seeded(1, "test");
        site_list sites({4, 6});
        unet_encoder<double> const encoder(config, source, sites);
        small_pass<double> small;
        auto const encoded = encoder(small.pass, random_maps<double>(2, {4, 6}, 4, 2), 9.0);
        auto values = encoded.middle.view().size();
        for (auto const& skip : encoded.skips) {
            values += skip.view().size();
        }
        CHECK(encoded_bytes<double>(config, {4, 6}) == values / 2 * sizeof(double));
    }
}
