// SPDX-License-Identifier: MIT
// [GR sec. 3.2] The concept accepts what it should and nothing else, and a second model, known by hand, keeps its laws.
#include <genrender/correspondence/correspondence_map.hpp>

#include <genrender/testing/correspondence_laws.hpp>
#include "../support/shifted_strip.hpp"

#include <genrender/correspondence/texel_grid.hpp>

#include <doctest/doctest.h>

using namespace genrender;

namespace {

struct without_grid {
    struct point_type {};
    std::size_t frame_count() const;
    std::optional<point_type> point_at(frame_index, token_index) const;
    std::optional<token_index> token_at(frame_index, point_type) const;
};

struct with_sentinel {
    using point_type = int;
    std::size_t frame_count() const;
    grid_extents grid() const;
    int point_at(frame_index, token_index) const; // -1 for none is not absence
    std::optional<token_index> token_at(frame_index, int) const;
};

struct visits_by_pointer : testing::shifted_strip {
    void visit_tokens(frame_index, point_type, void (*visit)(token_index, double)) const; // no function that remembers
};

static_assert(correspondence_map<correspondence_map_archetype>);
static_assert(correspondence_map<texel_grid>);
static_assert(weighted_correspondence_map<texel_grid>);
static_assert(correspondence_map<testing::shifted_strip>);
static_assert(!weighted_correspondence_map<testing::shifted_strip>);
static_assert(correspondence_map<visits_by_pointer> && !weighted_correspondence_map<visits_by_pointer>);
static_assert(!correspondence_map<without_grid>);
static_assert(!correspondence_map<with_sentinel>);

} // namespace

TEST_SUITE("correspondence/correspondence_map") {
    TEST_CASE("[GR sec. 3.2] a strip that moves by one token a frame keeps the laws") {
        testing::shifted_strip const strip{3, 6};
        auto const laws = testing::check_correspondence_laws(strip);
        CHECK(laws.text() == "");
        CHECK(laws.shown_tokens == 18);
        CHECK(strip.token_at({1}, 2)->value == 1);
        CHECK(!strip.token_at({2}, 1).has_value());
    }
}
