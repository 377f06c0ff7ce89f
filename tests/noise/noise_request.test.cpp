// SPDX-License-Identifier: MIT
// Requests come out of the sorting by children as a stable sort by the plain definition leaves them.
#include <genrender/noise/noise_request.hpp>

#include <genrender/core/random.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>
#include <vector>

using namespace genrender;

TEST_SUITE("noise/noise_request") {
    TEST_CASE_TEMPLATE("requests sorted by child keep their order within each", D,
                       std::integral_constant<std::size_t, 2>, std::integral_constant<std::size_t, 3>) {
        constexpr std::size_t d = D::value;
        // Counts of children have 16 and 8 bits: more requests than that, in one child and in all.
        for (std::size_t const count : {0U, 1U, 7U, 255U, 256U, 1000U, 65535U, 65536U, 140000U}) {
            for (auto const is_one_child : {false, true}) {
                CAPTURE(count);
                CAPTURE(is_one_child);
                std::vector<noise_request<d>> requests(count);
                for (std::uint32_t n = 0; n < count; ++n) {
                    auto const bits = random_bits(1, random_stream::test, {n, 0, 0});
                    for (std::size_t axis = 0; axis < d; ++axis) {
                        requests[n].place[axis] = is_one_child ? 0xFFFFU : bits[axis] & 0xFFFFU;
                    }
                    requests[n].pixel = n;
                }
                auto const child = [](auto const& request) { return genrender::detail::child_of(request, 9); };
                auto expected = requests;
                std::stable_sort(expected.begin(), expected.end(),
                                 [&](auto const& a, auto const& b) { return child(a) < child(b); });
                std::vector<noise_request<d>> sorted(count);
                auto const begins = genrender::detail::sort_by_child(std::span(sorted), requests, 9);
                CHECK(std::equal(sorted.begin(), sorted.end(), expected.begin(),
                                 [](auto const& a, auto const& b) { return a.pixel == b.pixel; }));
                CHECK(begins[0] == 0);
                CHECK(begins.back() == count);
                for (std::size_t c = 0; c + 1 < begins.size(); ++c) {
                    REQUIRE(std::all_of(sorted.begin() + static_cast<std::ptrdiff_t>(begins[c]),
                                        sorted.begin() + static_cast<std::ptrdiff_t>(begins[c + 1]),
                                        [&](auto const& request) { return child(request) == c; }));
                }
            }
        }
    }
}
