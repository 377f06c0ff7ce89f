// SPDX-License-Identifier: MIT
// Features of an engine of C are given back once, and its operations are asked as the header of C says.
#include <genrender/c/engine_call.hpp>

#include <doctest/doctest.h>

#include <array>
#include <cstdint>

TEST_SUITE("c/engine_call") {
    using namespace genrender;
    using genrender::c::engine_call;
    using genrender::c::engine_error;
    using genrender::c::engine_features;

    namespace {

    // An engine whose features are numbers.
    struct number_engine {
        int values[8] = {0, 1, 2, 3, 4, 5, 6, 7};
        int released = 0;
        std::size_t blocks_seen = 0;
        float scale_seen = 0; ///< of the second frame
        genrender_engine table{};
        number_engine() {
            table.context = this;
            table.release = [](void* context, genrender_features*) {
                ++static_cast<number_engine*>(context)->released;
            };
            table.query = [](void* context, genrender_call const*, genrender_features const* f) -> genrender_features* {
                auto& engine = *static_cast<number_engine*>(context);
                auto const value = *static_cast<int const*>(f);
                return value == 7 ? nullptr : &engine.values[value + 1];
            };
            table.attend = [](void* context, genrender_call const*, genrender_features const*,
                              genrender_sources sources) -> genrender_features* {
                auto& engine = *static_cast<number_engine*>(context);
                engine.blocks_seen = sources.offsets[sources.frames];
                engine.scale_seen = sources.scales != nullptr ? sources.scales[1] : 0;
                auto const& last = sources.blocks[sources.offsets[1]];
                return &engine.values[*static_cast<int const*>(last.K) + static_cast<int>(last.frame)];
            };
        }
        number_engine(number_engine const&) = delete;
    };

    } // namespace

    TEST_CASE("features are released once, with the last copy, and lent ones never") {
        number_engine engine;
        {
            engine_features const first(engine.table, &engine.values[1], "query");
            auto const copy = first;
            CHECK(copy.get() == &engine.values[1]);
            engine_features const lent(&engine.values[2]);
            CHECK(engine.released == 0);
        }
        CHECK(engine.released == 1);
    }
    TEST_CASE("an operation that returns nothing, or that is missing, ends in a sentence") {
        number_engine engine;
        genrender_call const plain{{3, 1}, nullptr, 0, &engine.values[7], nullptr};
        engine_call const call(engine.table, plain);
        CHECK_THROWS_WITH_AS(call.query(call.f()), "engine: query returned no features", engine_error);
        CHECK_THROWS_WITH_AS(call.key(call.f()),
                             "engine: key is null, expected a function of an engine that calls back", engine_error);
    }
    TEST_CASE("places, frames and sources reach the engine as they are") {
        number_engine engine;
        std::array<std::uint32_t, 2> const frames{5, 9};
        genrender_call const plain{{3, 1}, frames.data(), 2, &engine.values[1], nullptr};
        engine_call const call(engine.table, plain);
        CHECK(call.place() == attention_place{{3}, 1});
        REQUIRE(call.frames().size() == 2);
        CHECK(call.frames()[1] == frame_index{9});
        engine_features const K(&engine.values[2]);
        engine_features const V(&engine.values[3]);
        attention_sources<engine_features> const sources{{{&K, &V, 0}, {&K, &V, 1}}, {{&V, &K, 1}}};
        auto const F = call.attend(call.f(), sources);
        CHECK(engine.blocks_seen == 3);
        CHECK(*static_cast<int*>(F.get()) == 4); // K of frame 1's first block is 3, its frame 1
    }
    TEST_CASE("scales of logits reach an engine that says it scales, and are refused by another") {
        number_engine engine;
        std::array<std::uint32_t, 2> const frames{5, 9};
        genrender_call const plain{{3, 1}, frames.data(), 2, &engine.values[1], nullptr};
        engine_call const call(engine.table, plain);
        engine_features const K(&engine.values[2]);
        attention_sources<engine_features> sources{{{&K, &K, 0}}, {{&K, &K, 1}}};
        call.attend(call.f(), sources);
        CHECK(engine.scale_seen == 0); // null
        sources.set_scales({1, 1.5});
        CHECK_THROWS_WITH_AS(call.attend(call.f(), sources),
                             "engine_call: logits are scaled, expected a length_correction of 0 for an engine without "
                             "scales_logits",
                             value_error);
        engine.table.scales_logits = 1;
        call.attend(call.f(), sources);
        CHECK(engine.scale_seen == 1.5F);
    }
}
