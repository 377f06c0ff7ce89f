// SPDX-License-Identifier: MIT
// Every index once, exceptions to the caller, results that no thread count changes.
#include <genrender/core/parallel.hpp>
#include <genrender/core/random.hpp>

#include <doctest/doctest.h>

#include <atomic>
#include <cstddef>
#include <functional>
#include <mutex>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

using namespace genrender;

namespace {

/// A stranger's loop: runs from the last index to the first and knows nothing of the library.
struct backward_loop {
    template <class Body>
    int operator()(std::size_t count, Body&& body) const {
        while (count-- > 0) {
            body(count);
        }
        return 0;
    }
};

struct not_const_loop {
    template <class Body>
    void operator()(std::size_t, Body&&) {}
};

/// Takes what remembers nothing, which the library's bodies do.
struct loop_of_functions {
    void operator()(std::size_t, void (*)(std::size_t)) const {}
};

struct loop_without_count {
    template <class Body>
    void operator()(Body&&) const {}
};

template <parallel_loop Loop>
std::vector<int> visits(Loop const& loop, std::size_t count) {
    std::vector<std::atomic<int>> counts(count);
    loop(count, [&](std::size_t i) { counts.at(i).fetch_add(1); });
    return {counts.begin(), counts.end()};
}

template <parallel_loop Loop>
std::vector<double> values(Loop const& loop, std::size_t count) {
    std::vector<double> result(count);
    loop(count, [&](std::size_t i) {
        result[i] = normal_value(5, random_stream::test, {static_cast<std::uint32_t>(i), 0, 0});
    });
    return result;
}

} // namespace

TEST_SUITE("core/parallel") {
    TEST_CASE("the concept takes what can be called with a count and a body") {
        CHECK(parallel_loop<sequential_loop>);
        CHECK(parallel_loop<threaded_loop>);
        CHECK(parallel_loop<backward_loop>);
        CHECK(parallel_loop<any_loop>);
        CHECK_FALSE(parallel_loop<not_const_loop>);
        CHECK_FALSE(parallel_loop<loop_without_count>);
        CHECK_FALSE(parallel_loop<int>);
        CHECK_FALSE(parallel_loop<loop_of_functions>);
        auto const lambda = [](std::size_t count, auto&& body) { sequential_loop{}(count, body); };
        CHECK(parallel_loop<decltype(lambda)>);
        CHECK(visits(lambda, 3) == std::vector<int>(3, 1));
    }

    TEST_CASE("any_loop runs the loop that it was made of, on the caller's thread if none") {
        std::size_t runs = 0;
        any_loop const counted = [&runs](std::size_t count, auto&& body) {
            ++runs;
            sequential_loop{}(count, body);
        };
        auto const copy = counted;
        CHECK(visits(copy, 5) == std::vector<int>(5, 1));
        CHECK(runs == 1);
        CHECK(visits(any_loop(), 5) == std::vector<int>(5, 1));
        CHECK(visits(any_loop(sequential_loop{}), 5) == std::vector<int>(5, 1));
        CHECK(visits(any_loop(threaded_loop(3)), 50) == std::vector<int>(50, 1));
        CHECK(values(any_loop(backward_loop{}), 20) == values(any_loop(), 20));
        struct uncopied_loop : backward_loop {
            uncopied_loop() = default;
            uncopied_loop(uncopied_loop const&) = delete;
        };
        uncopied_loop const uncopied;
        CHECK(visits(any_loop(std::cref(uncopied)), 5) == std::vector<int>(5, 1));
        std::vector<std::size_t> order;
        any_loop(backward_loop{})(3, [&](std::size_t i) { order.push_back(i); });
        CHECK(order == std::vector<std::size_t>{2, 1, 0});
        CHECK_THROWS_AS(any_loop()(1, [](std::size_t) { throw std::runtime_error("body"); }), std::runtime_error);
    }

    TEST_CASE("every index is visited exactly once") {
        for (std::size_t const count : {0U, 1U, 2U, 3U, 7U, 64U, 1000U}) {
            CAPTURE(count);
            std::vector<int> const once(count, 1);
            CHECK(visits(sequential_loop{}, count) == once);
            CHECK(visits(backward_loop{}, count) == once);
            for (std::size_t const threads : {1U, 2U, 3U, 16U}) {
                CAPTURE(threads);
                CHECK(visits(threaded_loop(threads), count) == once);
            }
        }
    }

    TEST_CASE("results do not depend on the loop or its number of threads") {
        auto const expected = values(sequential_loop{}, 501);
        CHECK(values(backward_loop{}, 501) == expected);
        CHECK(values(threaded_loop(1), 501) == expected);
        CHECK(values(threaded_loop(2), 501) == expected);
        CHECK(values(threaded_loop(5), 501) == expected);
    }

    TEST_CASE("the sequential loop keeps the order and the caller's thread") {
        std::vector<std::size_t> order;
        sequential_loop{}(4, [&](std::size_t i) {
            order.push_back(i);
            CHECK(std::this_thread::get_id() != std::thread::id{});
        });
        CHECK(order == std::vector<std::size_t>{0, 1, 2, 3});
        std::vector<std::size_t> single;
        threaded_loop{1}(4, [&](std::size_t i) { single.push_back(i); });
        CHECK(single == order);
    }

    TEST_CASE("two threads take part where two indices wait for each other") {
        std::atomic<int> arrived{0};
        std::mutex mutex;
        std::set<std::thread::id> ids;
        threaded_loop{2}(2, [&](std::size_t) {
            {
                std::lock_guard const lock(mutex);
                ids.insert(std::this_thread::get_id());
            }
            arrived.fetch_add(1);
            while (arrived.load() < 2) {
                std::this_thread::yield();
            }
        });
        CHECK(ids.size() == 2);
        CHECK(ids.count(std::this_thread::get_id()) == 1);
    }

    TEST_CASE("an exception of the body reaches the caller with its text") {
        for (std::size_t const threads : {1U, 2U, 4U}) {
            CAPTURE(threads);
            auto const run = [&] {
                threaded_loop{threads}(100, [](std::size_t i) {
                    if (i == 37) {
                        throw std::runtime_error("index 37");
                    }
                });
            };
            CHECK_THROWS_WITH_AS(run(), "index 37", std::runtime_error);
        }
    }

    TEST_CASE("when all bodies throw one exception arrives and no index ran twice") {
        std::vector<std::atomic<int>> counts(64);
        auto const run = [&] {
            threaded_loop{4}(counts.size(), [&](std::size_t i) {
                counts.at(i).fetch_add(1);
                throw std::invalid_argument(std::to_string(i));
            });
        };
        CHECK_THROWS_AS(run(), std::invalid_argument);
        for (auto const& count : counts) {
            CHECK(count.load() <= 1);
        }
        CHECK(counts[0].load() == 1);
    }

    TEST_CASE("a loop inside a loop visits every pair once") {
        std::vector<std::atomic<int>> counts(30);
        threaded_loop const loop(2);
        loop(5, [&](std::size_t i) { loop(6, [&](std::size_t j) { counts.at(i * 6 + j).fetch_add(1); }); });
        CHECK(std::vector<int>(counts.begin(), counts.end()) == std::vector<int>(30, 1));
    }

    TEST_CASE("one object serves loop after loop and loops of several threads at once") {
        threaded_loop const loop(3);
        auto const copy = loop;
        for (int round = 0; round < 200; ++round) {
            REQUIRE(visits(round % 2 == 0 ? loop : copy, 5) == std::vector<int>(5, 1));
        }
        std::vector<std::atomic<int>> counts(4 * 100);
        threaded_loop(4)(4, [&](std::size_t caller) {
            for (int round = 0; round < 50; ++round) {
                loop(100, [&](std::size_t i) { counts.at(caller * 100 + i).fetch_add(1); });
            }
        });
        CHECK(std::vector<int>(counts.begin(), counts.end()) == std::vector<int>(400, 50));
    }

    TEST_CASE("loops share the same few threads and work goes on after an exception") {
        threaded_loop const loop(2);
        std::mutex mutex;
        std::set<std::thread::id> ids;
        for (int round = 0; round < 50; ++round) {
            CHECK_THROWS_AS(loop(3, [](std::size_t) { throw std::runtime_error("no"); }), std::runtime_error);
            loop(8, [&](std::size_t) {
                std::lock_guard const lock(mutex);
                ids.insert(std::this_thread::get_id());
            });
        }
        CHECK(ids.size() <= 2);
    }

    TEST_CASE("0 threads mean as many as the machine has") {
        CHECK(threaded_loop().threads() >= 1);
        CHECK(threaded_loop(0).threads() == threaded_loop().threads());
        CHECK(threaded_loop(3).threads() == 3);
        CHECK(visits(threaded_loop(), 17) == std::vector<int>(17, 1));
    }
}
