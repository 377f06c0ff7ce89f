// SPDX-License-Identifier: MIT
// Matches are made once as long as there is room, and again when there is none.
#include <genrender/correspondence/token_matches.hpp>

#include "../support/counted_memory.hpp"

#include <genrender/core/parallel.hpp>

#include <doctest/doctest.h>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

using namespace genrender;

namespace {

token_matches matches_of(std::uint32_t token) {
    token_matches matches(2);
    matches.tokens[0] = token;
    matches.is_shown[0] = 1;
    return matches;
}

} // namespace

TEST_SUITE("correspondence/token_matches") {
    TEST_CASE("a pair in the cache is not made again") {
        match_cache cache(1000);
        std::size_t made = 0;
        auto const make = [&] {
            ++made;
            return matches_of(7);
        };
        auto const first = cache.of({1}, {2}, make);
        CHECK(cache.of({1}, {2}, make) == first);
        CHECK(made == 1);
        CHECK(first->tokens[0] == 7);
        CHECK(cache.byte_count() == token_matches::bytes_of(2));
        // The way back is another pair.
        CHECK(cache.of({2}, {1}, make) != first);
        CHECK(made == 2);
    }

    TEST_CASE("what there is no room for is made again and what came first stays") {
        match_cache cache(token_matches::bytes_of(2));
        std::size_t made = 0;
        auto const make = [&] {
            ++made;
            return matches_of(3);
        };
        cache.of({0}, {0}, make);
        cache.of({0}, {1}, make);
        cache.of({0}, {1}, make);
        CHECK(made == 3);
        cache.of({0}, {0}, make);
        CHECK(made == 3);
        CHECK(cache.byte_count() == token_matches::bytes_of(2));
        match_cache none(0);
        CHECK(none.of({0}, {0}, make)->tokens[0] == 3);
        CHECK(none.byte_count() == 0);
    }

    TEST_CASE("matches outlive their cache and lie in few chunks") {
        std::shared_ptr<token_matches const> last;
        {
            match_cache cache(1U << 20);
            for (std::uint32_t frame = 0; frame < 500; ++frame) {
                last = cache.of({frame}, {0}, [&] { return matches_of(frame); });
            }
            CHECK(cache.byte_count() == 500 * token_matches::bytes_of(2));
        }
        CHECK(last->tokens[0] == 499);
        CHECK(match_cache::expected_bytes(500, 2, 1U << 20) == match_cache::chunk_bytes);
        CHECK(match_cache::expected_bytes(100000, 2, 1U << 20) == 2 * match_cache::chunk_bytes);
        CHECK(match_cache::expected_bytes(500, 2, 0) == 0);
    }

    TEST_CASE("many pairs of many sizes hold what was written and lie in chunks without holes") {
        for (std::size_t const tokens : {1U, 37U, 5000U, 70000U}) {
            std::size_t const pairs = 40;
            match_cache cache(pairs * token_matches::bytes_of(tokens));
            std::vector<std::shared_ptr<token_matches const>> all;
            auto const before = testing::counted_memory::live.load();
            for (std::uint32_t frame = 0; frame < pairs; ++frame) {
                all.push_back(cache.of({frame}, {1}, [&] {
                    token_matches matches(tokens);
                    for (std::size_t t = 0; t < tokens; ++t) {
                        matches.tokens[t] = frame + static_cast<std::uint32_t>(t);
                        matches.is_shown[t] = static_cast<std::uint8_t>((frame + t) % 2);
                        matches.qualities[t] = static_cast<float>(t % 100);
                    }
                    return matches;
                }));
            }
            auto const taken = testing::counted_memory::live.load() - before;
            CHECK(cache.byte_count() == pairs * token_matches::bytes_of(tokens));
            for (std::uint32_t frame = 0; frame < pairs; ++frame) {
                auto const& matches = *all[frame];
                CHECK(reinterpret_cast<std::uintptr_t>(matches.tokens.data()) % alignof(std::uint32_t) == 0);
                CHECK(reinterpret_cast<std::uintptr_t>(matches.qualities.data()) % alignof(float) == 0);
                bool is_as_written = matches.tokens.size() == tokens;
                for (std::size_t t = 0; t < tokens; ++t) {
                    is_as_written = is_as_written && matches.tokens[t] == frame + t &&
                                    matches.is_shown[t] == (frame + t) % 2 &&
                                    matches.qualities[t] == static_cast<float>(t % 100);
                }
                CHECK(is_as_written);
            }
            // All in whole chunks but for the links between pairs and the handles here, whose vectors grow by halves.
            auto const planned = match_cache::expected_bytes(pairs, tokens, ~std::size_t{0});
            CHECK(taken <= planned + pairs * 200);
        }
    }

    TEST_CASE("a pair that is larger than a chunk has one of its own") {
        match_cache cache(~std::size_t{0});
        auto const tokens = match_cache::chunk_bytes;
        auto const first = cache.of({0}, {1}, [&] { return token_matches(tokens); });
        auto const second = cache.of({1}, {0}, [&] { return matches_of(5); });
        auto const third = cache.of({2}, {0}, [&] { return matches_of(6); });
        CHECK(first->tokens.size() == tokens);
        CHECK(first->tokens[tokens - 1] == 0);
        CHECK(first->tokens[0] == 0);
        CHECK(second->tokens[0] == 5);
        CHECK(third->tokens[0] == 6);
    }

    TEST_CASE("threads get equal matches") {
        match_cache cache(100000);
        std::atomic<std::size_t> wrong{0};
        threaded_loop(4)(400, [&](std::size_t n) {
            auto const frame = static_cast<std::uint32_t>(n % 10);
            auto const matches = cache.of({frame}, {0}, [&] { return matches_of(frame); });
            wrong += matches->tokens[0] == frame ? 0U : 1U;
        });
        CHECK(wrong == 0);
        CHECK(cache.byte_count() == 10 * token_matches::bytes_of(2));
    }
}
