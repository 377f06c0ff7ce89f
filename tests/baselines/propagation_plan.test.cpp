// SPDX-License-Identifier: MIT
// [GR sec. 4: TokenFlow*] The plan by hand and on random scenes.
#include <genrender/baselines/propagation_plan.hpp>

#include "../support/random_scene.hpp"
#include "../support/shifted_strip.hpp"

#include <genrender/correspondence/texel_grid.hpp>

#include <doctest/doctest.h>

#include <vector>

using namespace genrender;
using testing::shifted_strip;

namespace {

/// A strip of three tokens whose last token shows background in the frames named.
struct strip_with_background : shifted_strip {
    std::vector<frame_index> cut;
    std::optional<point_type> point_at(frame_index i, token_index t) const {
        return t.value == 2 && is_cut(i) ? std::nullopt : shifted_strip::point_at(i, t);
    }
    std::optional<token_index> token_at(frame_index i, point_type point) const {
        auto const token = shifted_strip::token_at(i, point);
        return token && token->value == 2 && is_cut(i) ? std::nullopt : token;
    }
    bool is_cut(frame_index i) const { return std::find(cut.begin(), cut.end(), i) != cut.end(); }
};

template <class Real>
void check_plan(propagation_plan<Real> const& found, std::vector<std::uint32_t> const& offsets,
                std::vector<std::uint32_t> const& sources, std::vector<Real> const& weights, std::size_t matched) {
    CHECK(found.plan.offsets == offsets);
    CHECK(found.plan.sources == sources);
    REQUIRE(found.plan.weights.size() == weights.size());
    for (std::size_t e = 0; e < weights.size(); ++e) {
        CHECK(found.plan.weights[e] == doctest::Approx(weights[e]));
    }
    CHECK(found.matched == matched);
}

} // namespace

TEST_SUITE("baselines/propagation_plan") {
    TEST_CASE("[GR sec. 4: TokenFlow*] the nearest keyframes are those before and after in time in any order") {
        std::vector<frame_index> const KF{{8}, {2}, {5}};
        auto const check = [&](std::uint32_t i, std::size_t nearer, std::optional<std::size_t> farther) {
            auto const found = nearest_in_time(KF, {i});
            CHECK(found.nearer == nearer);
            CHECK(found.farther == farther);
        };
        check(0, 1, std::nullopt); // before the first keyframe
        check(2, 1, std::nullopt); // a keyframe
        check(3, 1, 2);
        check(4, 2, 1);
        check(5, 2, std::nullopt);
        check(7, 0, 2);
        check(9, 0, std::nullopt); // after the last
    }
    TEST_CASE("of two keyframes as near the earlier is the nearer") {
        CHECK(nearest_in_time(std::vector<frame_index>{{4}, {2}}, {3}).nearer == 1);
        CHECK(nearest_in_time(std::vector<frame_index>{{2}, {4}}, {3}).nearer == 0);
    }
    TEST_CASE_TEMPLATE("shares are linear in time", Real, float, double) {
        CHECK(share_of_nearer<Real>({2}, {3}, {6}) == Real(0.75));
        CHECK(share_of_nearer<Real>({6}, {5}, {2}) == Real(0.75));
        CHECK(share_of_nearer<Real>({2}, {4}, {6}) == Real(0.5));
    }
    TEST_CASE_TEMPLATE("by hand: a strip that moves one token a frame", Real, float, double) {
        // Frame i shows the points i, i + 1, i + 2. Frame 1 between the keyframes 2 (the first drawn) and 0: its points
        // 1, 2, 3 are the tokens -, 0, 1 of frame 2 and 1, 2, - of frame 0.
        shifted_strip const map{4, 3};
        std::vector<frame_index> const KF{{2}, {0}};
        check_plan<Real>(make_propagation_plan<Real>(map, KF, {1}), {0, 1, 3, 4}, {3 + 1, 3 + 2, 0, 1},
                         {1, Real(0.5), Real(0.5), 1}, 3);
        // Frame 3 lies after both: its points 3, 4, 5 are the tokens 1, 2, - of frame 2; the last is taken from the
        // same place on the screen.
        check_plan<Real>(make_propagation_plan<Real>(map, KF, {3}), {0, 1, 2, 3}, {1, 2, 2}, {1, 1, 1}, 2);
    }
    TEST_CASE_TEMPLATE("a keyframe takes its own tokens whoever else shows them", Real, float, double) {
        auto const maps = testing::random_scene(3, 4, {32, 32}, 3);
        texel_grid const map(to_uv_view(maps), {8, 8});
        std::vector<frame_index> const KF{{3}, {1}, {2}};
        auto const found = make_propagation_plan<Real>(map, KF, {1});
        REQUIRE(found.plan.sources.size() == 64);
        for (std::uint32_t t = 0; t < 64; ++t) {
            CHECK(found.plan.sources[t] == 64 + t);
            CHECK(found.plan.weights[t] == 1);
        }
    }
    TEST_CASE("background matches background at the same place and nothing else") {
        // Points of frame 1 are 1, 2 and background; of frame 0: 0, 1, background; of frame 2: 2, 3, 4.
        strip_with_background const map{{3, 3}, {{0}, {1}}};
        CHECK(matching_token(map, {0}, {1}, {2}) == token_index{2});
        CHECK(matching_token(map, {2}, {1}, {2}) == std::nullopt);
        CHECK(matching_token(map, {2}, {1}, {1}) == token_index{0});
        CHECK(matching_token(map, {0}, {1}, {1}) == std::nullopt);
        std::vector<frame_index> const KF{{0}, {2}};
        // Token 0 and the background find a match in frame 0 alone, token 1 in frame 2 alone.
        check_plan<double>(make_propagation_plan<double>(map, KF, {1}), {0, 1, 2, 3}, {1, 3, 2}, {1, 1, 1}, 2);
    }
    TEST_CASE("background that no keyframe shows comes from the same place in the nearer keyframe") {
        strip_with_background const map{{5, 3}, {{3}}};
        std::vector<frame_index> const KF{{4}, {0}};
        auto const found = make_propagation_plan<double>(map, KF, {3});
        CHECK(found.plan.sources.back() == 2); // token 2 of frame 4
        CHECK(found.plan.weights.back() == 1);
    }
    TEST_CASE_TEMPLATE("every token is covered by one or two tokens whose weights sum to 1", Real, float, double) {
        auto const maps = testing::random_scene(5, 9, {64, 64}, 4);
        texel_grid const map(to_uv_view(maps), {16, 16});
        std::vector<frame_index> const KF{{6}, {1}, {3}};
        std::size_t matched = 0;
        std::size_t shared = 0;
        for (std::uint32_t i = 0; i < 9; ++i) {
            auto const found = make_propagation_plan<Real>(map, KF, {i});
            auto const rows = found.plan.rows();
            REQUIRE(rows.row_count() == 256);
            for (std::size_t t = 0; t < 256; ++t) {
                Real sum = 0;
                for (auto e = rows.offsets[t]; e < rows.offsets[t + 1]; ++e) {
                    REQUIRE(rows.sources[e] < 3 * 256);
                    REQUIRE(rows.weights[e] > 0);
                    sum += rows.weights[e];
                }
                auto const count = rows.offsets[t + 1] - rows.offsets[t];
                REQUIRE((count == 1 || count == 2));
                REQUIRE(sum == doctest::Approx(1));
                shared += count - 1;
            }
            matched += found.matched;
        }
        CHECK(matched > 500);
        CHECK(shared > 500);
    }
    TEST_CASE("frames that do not exist and an empty list are refused in a sentence") {
        shifted_strip const map{3, 3};
        std::vector<frame_index> const KF{{0}};
        std::vector<frame_index> const beyond{{0}, {3}};
        CHECK_THROWS_WITH_AS(make_propagation_plan<double>(map, KF, {3}),
                             "make_propagation_plan: i is 3, expected a frame below 3", value_error);
        CHECK_THROWS_WITH_AS(make_propagation_plan<double>(map, beyond, {1}),
                             "make_propagation_plan: keyframes is 3, expected a frame below 3", value_error);
        CHECK_THROWS_WITH_AS(make_propagation_plan<double>(map, {}, {1}),
                             "make_propagation_plan: keyframes is empty, expected at least one keyframe", value_error);
    }
}
