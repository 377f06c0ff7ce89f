// SPDX-License-Identifier: MIT
// A search visits the points that sorting all of them finds.
#include <genrender/correspondence/nearest_samples.hpp>

#include <genrender/core/random.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

using namespace genrender;

namespace {

template <std::size_t D>
std::array<float, D> random_place(std::uint32_t kind, std::uint32_t number) {
    std::array<float, D> place{};
    for (std::uint32_t d = 0; d < D; ++d) {
        place[d] = static_cast<float>(uniform_value(1, random_stream::test, {kind, number, d}));
    }
    return place;
}

template <std::size_t D>
std::vector<std::size_t> visited_by(nearest_samples<D> const& samples, std::array<float, D> const& place) {
    std::vector<std::size_t> numbers;
    samples.visit_nearest(place, [&](std::size_t number) { numbers.push_back(number); });
    return numbers;
}

template <std::size_t D>
float squared_distance(std::array<float, D> const& a, std::array<float, D> const& b) {
    float sum = 0;
    for (std::size_t d = 0; d < D; ++d) {
        sum += (a[d] - b[d]) * (a[d] - b[d]);
    }
    return sum;
}

/// Asks 100 times for the nearest of random points and compares with sorting all of them.
template <std::size_t D>
void check_against_all_points(std::uint32_t count) {
    std::vector<std::array<float, D>> places;
    for (std::uint32_t number = 0; number < count; ++number) {
        places.push_back(random_place<D>(0, number));
    }
    nearest_samples<D> const samples(places);
    for (std::uint32_t question = 0; question < 100; ++question) {
        auto const place = random_place<D>(1, question);
        std::vector<std::size_t> nearest(places.size());
        std::iota(nearest.begin(), nearest.end(), std::size_t{0});
        std::sort(nearest.begin(), nearest.end(), [&](std::size_t a, std::size_t b) {
            return squared_distance(places[a], place) < squared_distance(places[b], place);
        });
        nearest.resize(nearest_samples<D>::visited);
        CHECK(visited_by(samples, place) == nearest);
    }
}

} // namespace

TEST_SUITE("correspondence/nearest_samples") {
    TEST_CASE("the points visited are the nearest of all in two dimensions") {
        check_against_all_points<2>(700);
        check_against_all_points<2>(90);
    }
    TEST_CASE("the points visited are the nearest of all in three dimensions") {
        check_against_all_points<3>(700);
        check_against_all_points<3>(90);
    }

    TEST_CASE("fewer points than a search visits are all visited with the nearest first") {
        nearest_samples<2> const samples({{0, 0}, {4, 0}, {1, 0}});
        CHECK(visited_by<2>(samples, {1.25F, 0}) == std::vector<std::size_t>{2, 0, 1});
        CHECK(visited_by<2>(samples, {100, 0}) == std::vector<std::size_t>{1, 2, 0});
    }

    TEST_CASE("points at one place are points of their own") {
        std::vector<std::array<float, 3>> places(30, {1, 2, 3});
        places.push_back({0, 0, 0});
        auto numbers = visited_by<3>(nearest_samples<3>(places), {1, 2, 3});
        CHECK(numbers.size() == nearest_samples<3>::visited);
        std::sort(numbers.begin(), numbers.end());
        CHECK(std::adjacent_find(numbers.begin(), numbers.end()) == numbers.end());
        CHECK(numbers.back() < 30);
        CHECK(visited_by<3>(nearest_samples<3>(places), {0, 0, 0}).front() == 30);
    }

    TEST_CASE("a search without points visits nothing") {
        CHECK(visited_by<2>(nearest_samples<2>(), {0, 0}).empty());
        CHECK(visited_by<2>(nearest_samples<2>(std::vector<std::array<float, 2>>{}), {0, 0}).empty());
    }

    TEST_CASE("a copy answers when the first is gone") {
        nearest_samples<2> copy;
        {
            nearest_samples<2> const first({{0, 0}, {1, 1}});
            copy = first;
        }
        CHECK(visited_by<2>(copy, {1, 1}) == std::vector<std::size_t>{1, 0});
    }
}
