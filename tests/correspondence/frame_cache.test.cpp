// SPDX-License-Identifier: MIT
// Values of frames are made once while they are among the last that were asked for, and once for all threads.
#include <genrender/correspondence/frame_cache.hpp>

#include <genrender/core/parallel.hpp>

#include <doctest/doctest.h>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <stdexcept>

using namespace genrender;

TEST_SUITE("correspondence/frame_cache") {
    TEST_CASE("the frame that was asked for longest ago is made again") {
        frame_cache<std::uint32_t> cache(2);
        std::size_t made = 0;
        auto const value_of = [&](std::uint32_t frame) {
            return *cache.of({frame}, [&] {
                ++made;
                return 10 * frame;
            });
        };
        CHECK(value_of(1) == 10);
        CHECK(value_of(2) == 20);
        CHECK(value_of(1) == 10);
        CHECK(made == 2);
        CHECK(value_of(3) == 30); // in the place of frame 2
        CHECK(value_of(1) == 10);
        CHECK(made == 3);
        CHECK(value_of(2) == 20);
        CHECK(made == 4);
    }

    TEST_CASE("frames asked for in turn are found when there is room for them all") {
        frame_cache<std::uint32_t> cache(0);
        cache.grow_to(3);
        cache.grow_to(2);
        std::size_t made = 0;
        for (std::uint32_t n = 0; n < 12; ++n) {
            CHECK(*cache.of({n % 3}, [&] {
                ++made;
                return n % 3;
            }) == n % 3);
        }
        CHECK(made == 3);
    }

    TEST_CASE("a value in use stays when its place is taken") {
        for (std::size_t const most : {0U, 1U}) {
            frame_cache<std::uint32_t> cache(most);
            auto const first = cache.of({1}, [] { return 7U; });
            auto const second = cache.of({2}, [] { return 8U; });
            CHECK(*first == 7);
            CHECK(*second == 8);
        }
    }

    TEST_CASE("what cannot be made is tried anew") {
        frame_cache<std::uint32_t> cache(3);
        CHECK_THROWS_AS(cache.of({1}, []() -> std::uint32_t { throw std::runtime_error("no"); }), std::runtime_error);
        CHECK(*cache.of({1}, [] { return 5U; }) == 5);
    }

    TEST_CASE("threads that ask for one frame make it once") {
        frame_cache<std::uint32_t> cache(5);
        std::atomic<std::size_t> made{0};
        std::atomic<std::size_t> wrong{0};
        threaded_loop(4)(1000, [&](std::size_t n) {
            auto const frame = static_cast<std::uint32_t>(n % 5);
            auto const value = cache.of({frame}, [&] {
                ++made;
                return frame + 1;
            });
            wrong += *value == frame + 1 ? 0U : 1U;
        });
        CHECK(wrong == 0);
        CHECK(made == 5);
    }
}
