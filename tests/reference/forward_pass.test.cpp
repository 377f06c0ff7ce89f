// SPDX-License-Identifier: MIT
// Tests of what a run hands to its layers.
#include <genrender/reference/forward_pass.hpp>

#include "small_networks.hpp"

#include <doctest/doctest.h>

#include <cstddef>
#include <utility>
#include <vector>

using namespace genrender;

using namespace genrender::reference;
using namespace genrender::testing;

TEST_SUITE("reference/forward_pass") {
    TEST_CASE("every frame is visited once and results have all frames") {
        small_pass<float> const small;
        std::vector<int> visits(2);
        small.pass.each_frame([&](std::size_t i) { ++visits[i]; });
        CHECK(visits == std::vector<int>{1, 1});
        auto const maps = small.pass.maps({3, 2}, 4);
        CHECK(maps.view().extents() == std::array<std::size_t, 3>{2, 6, 4});
    }

    TEST_CASE("threads share out frames if there are some and else the tokens of the frame") {
        small_pass<float> const small;
        std::size_t shared = 0;
        auto pass = small.pass;
        pass.loop = [&shared](std::size_t count, loop_body body) {
            ++shared;
            sequential_loop{}(count, body);
        };
        auto const shares_of = [&](auto const& run) {
            std::vector<int> visits(3);
            shared = 0;
            run([&](std::size_t i) { ++visits[i]; });
            return std::pair(shared, visits);
        };
        CHECK(shares_of([&](auto body) { pass.tokens()(3, body); }) == std::pair(std::size_t{0}, std::vector{1, 1, 1}));
        CHECK(shares_of([&](auto body) { pass.each_frame(body); }) == std::pair(std::size_t{1}, std::vector{1, 1, 0}));
        pass.frames = pass.frames.first(1);
        CHECK(shares_of([&](auto body) { pass.tokens()(3, body); }) == std::pair(std::size_t{1}, std::vector{1, 1, 1}));
        CHECK(shares_of([&](auto body) { pass.each_frame(body); }) == std::pair(std::size_t{0}, std::vector{1, 0, 0}));
    }

    TEST_CASE("a processor of any type runs and says where it is plain") {
        small_pass<float> const small;
        auto const f = host_features<float>::allocate({2, 3, 8});
        auto source = weights<float>::seeded(1, "unet");
        attention_matrices<float> const module(source, "attn1", 8, 8, 2);
        reference::any_processor<float>::call_type call({{4}, 1}, small.frames, f, module);
        std::size_t runs = 0;
        auto counted = [&runs](auto& of) mutable {
            ++runs;
            return of.f();
        };
        reference::any_processor<float> const erased(counted);
        CHECK(erased(call).view().data() == f.view().data());
        CHECK(runs == 1);
        CHECK_FALSE(erased.is_plain_at(call.place()));
        plain_attention const plain;
        CHECK(reference::any_processor<float>(plain).is_plain_at(call.place()));
    }
}
