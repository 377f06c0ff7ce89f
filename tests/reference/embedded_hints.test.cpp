// SPDX-License-Identifier: MIT
// Embedded hints: the same kept and made anew, and kept only where they fit.
#include <genrender/reference/embedded_hints.hpp>

#include "small_networks.hpp"

#include <doctest/doctest.h>

#include <array>
#include <cstddef>
#include <memory>

using namespace genrender;

using namespace genrender::reference;
using namespace genrender::testing;

namespace {

struct hinted {
    std::shared_ptr<controlnet<float> const> control;
    stack<float, 4> hint = random_stack<float, 4>({4, 3, 8, 8}, 3);

    hinted() {
        auto source = weights<float>::seeded(1, "test");
        site_list sites({4, 4});
        control = std::make_shared<controlnet<float> const>(small_config(), source, sites);
    }
    embedded_hints<float> keeping(std::size_t bytes) const { return {control, hint, bytes, sequential_loop{}}; }
};

} // namespace

TEST_SUITE("reference/embedded_hints") {
    TEST_CASE("as many are kept as fit") {
        hinted const world;
        constexpr std::size_t bytes = 16 * 8 * sizeof(float); // a grid of 4 x 4 with 8 channels
        CHECK(world.keeping(10 * bytes).kept_count() == 4);
        CHECK(world.keeping(4 * bytes).kept_count() == 4);
        CHECK(world.keeping(3 * bytes - 1).kept_count() == 2);
        CHECK(world.keeping(0).kept_count() == 1);
        CHECK(world.keeping(0).frame_count() == 4);
    }
    TEST_CASE("kept or made anew they are the ControlNet's to the bit") {
        hinted const world;
        auto const all = world.keeping(std::size_t{1} << 20);
        auto const one = world.keeping(0);
        std::array const frames{frame_index{3}, frame_index{0}, frame_index{2}};
        auto const a = all.at(frames, sequential_loop{});
        auto const b = one.at(frames, threaded_loop(2));
        REQUIRE(a.hints.size() == 3);
        REQUIRE(b.hints.size() == 3);
        for (std::size_t i = 0; i < 3; ++i) {
            feature_maps<float> pixels(1, {8, 8}, 3);
            copy(pixels.channels_first()[0], in_view<float, 3>(world.hint.view()[frames[i].value]));
            auto const expected = world.control->embed(pixels);
            for (std::size_t e = 0; e < expected.view().size(); ++e) {
                REQUIRE(a.hints[i]->view().data()[e] == expected.view().data()[e]);
                REQUIRE(b.hints[i]->view().data()[e] == expected.view().data()[e]);
            }
        }
    }
}
