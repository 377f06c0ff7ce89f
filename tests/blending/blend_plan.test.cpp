// SPDX-License-Identifier: MIT
// [GR sec. 3.2, alg. 1] The blend plan by hand and against the dense texture.
#include <genrender/blending/blend_plan.hpp>

#include "../support/dense_texture.hpp"
#include "../support/random_scene.hpp"
#include <genrender/testing/random_stack.hpp>
#include "../support/shifted_strip.hpp"

#include <genrender/blending/mix_rows.hpp>
#include <genrender/correspondence/footprint_map.hpp>
#include <genrender/correspondence/texel_grid.hpp>
#include <genrender/keyframes/draw_keyframes.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>
#include <set>
#include <type_traits>
#include <utility>
#include <vector>

using namespace genrender;

namespace {

/// F_bar of a frame by the library's plan; tokens that nothing covers keep 1000.
template <class Real, class Map>
stack<Real, 2> planned(Map const& map, std::vector<frame_index> const& KF, frame_index i, stack<Real, 3> const& F_KF,
                       Real share = Real(0.5)) {
    auto const plan = make_blend_plan<Real>(map, KF, i, share);
    stack<Real, 2> F({F_KF.extent(1), F_KF.extent(2)});
    for (std::size_t e = 0; e < F.size(); ++e) {
        F.data()[e] = 1000;
    }
    mix_rows(F.view(), F_KF, plan.rows(), 1);
    return F;
}

/// A strip whose frame i shows everything with quality 1 + 2 i, or with one of which nothing is known.
struct graded_strip : testing::shifted_strip {
    bool is_known = true;
    double quality_at(frame_index i, point_type) const { return is_known ? 1.0 + 2 * i.value : 0.0; }
};

static_assert(graded_correspondence_map<graded_strip>);
static_assert(!graded_correspondence_map<testing::shifted_strip>);

/// A footprint_map that is asked for one token after the other.
struct one_by_one {
    using point_type = footprint_map<2>::point_type;
    footprint_map<2> const* map;

    std::size_t frame_count() const { return map->frame_count(); }
    grid_extents grid() const { return map->grid(); }
    std::optional<point_type> point_at(frame_index i, token_index t) const { return map->point_at(i, t); }
    std::optional<token_index> token_at(frame_index i, point_type const& point) const {
        return map->token_at(i, point);
    }
    double quality_at(frame_index i, point_type const& point) const { return map->quality_at(i, point); }
};

static_assert(matched_correspondence_map<footprint_map<2>>);
static_assert(!matched_correspondence_map<one_by_one>);

/// The weights of each token's sources, in the drawn order.
std::vector<std::vector<double>> weights_of(blend_plan<double> const& plan) {
    std::vector<std::vector<double>> weights;
    for (std::size_t t = 0; t + 1 < plan.offsets.size(); ++t) {
        weights.emplace_back(plan.weights.begin() + plan.offsets[t], plan.weights.begin() + plan.offsets[t + 1]);
    }
    return weights;
}

/// Three of six frames in an order that is not sorted.
std::vector<frame_index> draw_shuffled(std::uint64_t seed) {
    return draw_keyframes({.count = 3, .drawing = keyframe_drawing::uniform, .frames = {}, .seed = seed}, 6, 0);
}

} // namespace

TEST_SUITE("blending/blend_plan") {
    TEST_CASE_TEMPLATE("[GR sec. 3.2] a point seen twice is the mean of its first value and its average", Real, float,
                       double) {
        // Frame i shows points i, i + 1, i + 2. Keyframes in the drawn order: 2, then 0.
        testing::shifted_strip const strip{4, 3};
        stack<Real, 3> F_KF({2, 3, 1});
        F_KF(0, 0, 0) = 2;  // point 2, first
        F_KF(0, 1, 0) = 3;  // point 3
        F_KF(0, 2, 0) = 4;  // point 4
        F_KF(1, 0, 0) = 10; // point 0
        F_KF(1, 1, 0) = 11; // point 1
        F_KF(1, 2, 0) = 12; // point 2, second
        auto const F_bar = planned<Real>(strip, {{2}, {0}}, {1}, F_KF);
        CHECK(F_bar(0, 0) == 11);                                        // point 1: seen once, itself
        CHECK(F_bar(1, 0) == doctest::Approx((2 + (2 + 12) / 2.0) / 2)); // point 2: (first + average) / 2
        CHECK(F_bar(2, 0) == 3);                                         // point 3: seen once, itself
        auto const F_bar_3 = planned<Real>(strip, {{2}, {0}}, {3}, F_KF);
        CHECK(F_bar_3(2, 0) == 1000); // point 5: seen by no keyframe, not touched
        // The order of the keyframes decides who fills first.
        stack<Real, 3> swapped({2, 3, 1});
        copy(swapped.view()[0], in_view<Real, 2>(F_KF.view()[1]));
        copy(swapped.view()[1], in_view<Real, 2>(F_KF.view()[0]));
        CHECK(planned<Real>(strip, {{0}, {2}}, {1}, swapped)(1, 0) == doctest::Approx((12 + (2 + 12) / 2.0) / 2));
    }
    TEST_CASE("[GR sec. 3.2] being filled is geometry and not a value: features around zero fill first all the same") {
        testing::shifted_strip const strip{2, 2};
        stack<double, 3> F_KF({2, 2, 2});
        // The first keyframe's feature of point 1 sums to less than zero, the peer's sign of an empty texel.
        F_KF(0, 1, 0) = -3;
        F_KF(0, 1, 1) = 1;
        F_KF(1, 0, 0) = 5;
        F_KF(1, 0, 1) = 7;
        auto const first_fill = planned<double>(strip, {{0}, {1}}, {0}, F_KF, 1);
        CHECK(first_fill(1, 0) == -3);
        CHECK(first_fill(1, 1) == 1);
    }
    TEST_CASE("[GR sec. 3.2] the average divides by the keyframes that see the point and keeps the magnitude") {
        testing::shifted_strip const strip{5, 3};
        stack<double, 3> F_KF({3, 3, 1});
        for (std::size_t e = 0; e < F_KF.size(); ++e) {
            F_KF.data()[e] = 8;
        }
        auto const average = planned<double>(strip, {{0}, {1}, {4}}, {1}, F_KF, 0);
        CHECK(average(0, 0) == doctest::Approx(8));
        CHECK(average(1, 0) == doctest::Approx(8));
    }
    TEST_CASE_TEMPLATE("[GR alg. 1] the plan equals the dense texture on random scenes", Real, float, double) {
        double worst = 0;
        std::size_t compared = 0;
        std::size_t uncovered = 0;
        std::size_t collisions = 0;
        for (std::uint64_t seed = 0; seed < 12; ++seed) {
            std::size_t const objects = 1 + seed % 4;
            std::size_t const T =
                std::array<std::size_t, 4>{6, 16, 40, 200}[seed % 4]; // collisions at 6, uncovered texels at 200
            grid_extents const grid{12, 16};
            auto const maps = testing::random_scene(seed, 6, {48, 64}, objects);
            texel_grid const map(to_uv_view(maps), grid, {.T = T});
            auto const KF = draw_shuffled(seed);
            auto const F_KF = testing::random_stack<Real, 3>({KF.size(), grid.size(), 5}, seed);
            auto const share = seed % 3 == 0 ? Real(0.25) : Real(0.5);

            std::vector<testing::dense_texture<Real>> unprojected;
            for (std::size_t k = 0; k < KF.size(); ++k) {
                unprojected.push_back(
                    testing::dense_unproject<Real>(maps, KF[k].value, F_KF.view()[k], grid, objects, T));
            }
            auto const texture = testing::dense_blend(unprojected, share);
            for (std::uint32_t i = 0; i < 6; ++i) {
                auto const F_bar = planned<Real>(map, KF, {i}, F_KF, share);
                std::set<std::size_t> read;
                for (std::size_t t = 0; t < grid.size(); ++t) {
                    auto const texel = testing::dense_texel_of(maps, i, grid, t, objects, T);
                    auto const is_covered = texel && texture.filled[*texel] != 0;
                    uncovered += texel && !is_covered ? 1U : 0U;
                    collisions += texel && !read.insert(*texel).second ? 1U : 0U;
                    for (std::size_t c = 0; c < 5; ++c) {
                        auto const expected = is_covered ? texture.values[*texel * 5 + c] : Real(1000);
                        worst = std::max(worst, static_cast<double>(std::abs(F_bar(t, c) - expected)));
                        compared += is_covered ? 1U : 0U;
                    }
                }
            }
        }
        MESSAGE("compared ", compared, " values, ", uncovered, " tokens uncovered, ", collisions,
                " shared texels, worst difference ", worst);
        CHECK(worst <= (std::is_same_v<Real, float> ? 1e-6 : 1e-12));
        CHECK(compared > 10000);
        CHECK(uncovered > 100);
        CHECK(collisions > 100);
    }
    TEST_CASE("[GR alg. 1] the plan equals the dense texture at the matched resolution too") {
        grid_extents const grid{12, 16};
        auto const maps = testing::random_scene(17, 6, {48, 64}, 1);
        texel_grid const map(to_uv_view(maps), grid);
        auto const T = map.resolution().of({0});
        CHECK(T > 8);
        auto const KF = draw_shuffled(3);
        auto const F_KF = testing::random_stack<double, 3>({KF.size(), grid.size(), 2}, 3);
        std::vector<testing::dense_texture<double>> unprojected;
        for (std::size_t k = 0; k < KF.size(); ++k) {
            unprojected.push_back(testing::dense_unproject<double>(maps, KF[k].value, F_KF.view()[k], grid, 1, T));
        }
        auto const texture = testing::dense_blend(unprojected);
        std::size_t covered = 0;
        for (std::uint32_t i = 0; i < 6; ++i) {
            auto const F_bar = planned<double>(map, KF, {i}, F_KF);
            for (std::size_t t = 0; t < grid.size(); ++t) {
                auto const texel = testing::dense_texel_of(maps, i, grid, t, 1, T);
                auto const is_covered = texel && texture.filled[*texel] != 0;
                covered += is_covered ? 1U : 0U;
                CHECK(F_bar(t, 1) ==
                      doctest::Approx(is_covered ? texture.values[*texel * 2 + 1] : 1000).epsilon(1e-12));
            }
        }
        CHECK(covered > 100);
    }
    TEST_CASE("[GR alg. 1] with the average reading the plan's rows still sum to 1") {
        auto const maps = testing::random_scene(4, 4, {48, 48}, 3);
        texel_grid const map(to_uv_view(maps), {8, 8}, {.T = 12, .reading = texel_reading::average});
        auto const plan = make_blend_plan<double>(map, std::vector<frame_index>{{3}, {1}}, {0});
        CHECK(plan.covered_count() > 20);
        for (std::size_t t = 0; t < 64; ++t) {
            double sum = 0;
            for (auto e = plan.offsets[t]; e < plan.offsets[t + 1]; ++e) {
                sum += plan.weights[e];
            }
            CHECK(sum == doctest::Approx(plan.rows().is_covered(t) ? 1.0 : 0.0));
        }
    }
    TEST_CASE("an average by quality mixes keyframes by how well they see the point") {
        // Frame 0 shows the points 0, 1 and 2; keyframes in the drawn order: 0 of quality 1, then 1 of quality 3.
        graded_strip const strip{{2, 3}};
        std::vector<frame_index> const KF{{0}, {1}};
        using rows = std::vector<std::vector<double>>;
        auto const by_quality = [&](double share) {
            return weights_of(make_blend_plan<double>(strip, KF, {0}, share, texel_average::by_quality));
        };
        CHECK(by_quality(0) == rows{{1}, {0.25, 0.75}, {0.25, 0.75}});
        CHECK(by_quality(0.5) == rows{{1}, {0.625, 0.375}, {0.625, 0.375}});
        CHECK(by_quality(1) == rows{{1}, {1, 0}, {1, 0}});
        // The plain average does not ask.
        CHECK(weights_of(make_blend_plan<double>(strip, KF, {0}, 0)) == rows{{1}, {0.5, 0.5}, {0.5, 0.5}});
    }
    TEST_CASE("where no quality is known or told the average by quality is the plain one") {
        std::vector<frame_index> const KF{{2}, {0}};
        graded_strip const unknown{{4, 3}, false};
        testing::shifted_strip const untold{4, 3};
        auto const plain = make_blend_plan<double>(untold, KF, {1});
        for (auto const& plan : {make_blend_plan<double>(unknown, KF, {1}, 0.5, texel_average::by_quality),
                                 make_blend_plan<double>(untold, KF, {1}, 0.5, texel_average::by_quality)}) {
            CHECK(plan.offsets == plain.offsets);
            CHECK(plan.sources == plain.sources);
            CHECK(plan.weights == plain.weights);
        }
        CHECK(plain.sources.size() == 4);
    }
    TEST_CASE("a keyframe that sees a surface twice as large has four times the share") {
        // Frame 0 and frame 1 show one plane, frame 1 its upper left quarter.
        uv_maps maps(2, {16, 16});
        maps.coverage.fill(1);
        for (std::size_t i = 0; i < 2; ++i) {
            auto const scale = i == 0 ? 1.0F / 16 : 0.5F / 16;
            for (std::size_t row = 0; row < 16; ++row) {
                for (std::size_t column = 0; column < 16; ++column) {
                    maps.uv(i, row, column, 0) = (static_cast<float>(column) + 0.5F) * scale;
                    maps.uv(i, row, column, 1) = (static_cast<float>(row) + 0.5F) * scale;
                }
            }
        }
        footprint_map const map(to_uv_view(maps), {4, 4});
        auto const plan =
            make_blend_plan<double>(map, std::vector<frame_index>{{0}, {1}}, {1}, 0, texel_average::by_quality);
        for (auto const& weights : weights_of(plan)) {
            REQUIRE(weights.size() == 2);
            CHECK(weights[0] == doctest::Approx(0.2));
            CHECK(weights[1] == doctest::Approx(0.8));
        }
        CHECK(plan.covered_count() == 16);
    }
    TEST_CASE("by quality the plan's rows still sum to 1 and never fall below 0") {
        auto const maps = testing::random_scene(4, 4, {48, 48}, 3);
        footprint_map const map(to_uv_view(maps), {12, 12});
        auto const plan =
            make_blend_plan<double>(map, std::vector<frame_index>{{3}, {1}, {2}}, {0}, 0.25, texel_average::by_quality);
        CHECK(plan.covered_count() > 50);
        for (auto const& weights : weights_of(plan)) {
            double sum = 0;
            for (auto const weight : weights) {
                CHECK(weight >= 0);
                sum += weight;
            }
            CHECK(sum == doctest::Approx(weights.empty() ? 0.0 : 1.0));
        }
    }
    TEST_CASE_TEMPLATE("matches of whole frames give the plan that single questions give", Real, float, double) {
        std::size_t entries = 0;
        for (std::uint64_t seed = 0; seed < 6; ++seed) {
            auto const maps = testing::random_scene(seed, 6, {48, 64}, 1 + seed % 4);
            footprint_map const map(to_uv_view(maps), {12, 16});
            footprint_map const forgetful(to_uv_view(maps), {12, 16}, {.match_cache_bytes = 0, .cached_frames = 1});
            one_by_one const single{&map};
            auto const KF = draw_shuffled(seed);
            auto const share = seed % 2 == 0 ? Real(0.5) : Real(0.2);
            for (std::uint32_t i = 0; i < 6; ++i) {
                // The second time from what the first left.
                for (auto const average :
                     {texel_average::plain, texel_average::by_quality, texel_average::by_quality}) {
                    auto const expected = make_blend_plan<Real>(single, KF, {i}, share, average);
                    auto const plan = make_blend_plan<Real>(map, KF, {i}, share, average);
                    CHECK(plan.offsets == expected.offsets);
                    CHECK(plan.sources == expected.sources);
                    auto const again = make_blend_plan<Real>(forgetful, KF, {i}, share, average);
                    CHECK(again.sources == plan.sources);
                    CHECK(again.weights == plan.weights);
                    REQUIRE(plan.weights.size() == expected.weights.size());
                    for (std::size_t e = 0; e < plan.weights.size(); ++e) {
                        CHECK(plan.weights[e] == doctest::Approx(expected.weights[e]).epsilon(1e-6));
                    }
                    entries += expected.sources.size();
                }
            }
        }
        CHECK(entries > 9000);
    }
    TEST_CASE("arguments that do not fit are refused by name") {
        testing::shifted_strip const strip{2, 3};
        std::vector<frame_index> const KF{{0}};
        CHECK_THROWS_WITH_AS(make_blend_plan<double>(strip, KF, {5}),
                             "make_blend_plan: i is 5, expected a frame below 2", value_error);
        CHECK_THROWS_WITH_AS(make_blend_plan<double>(strip, {}, {0}),
                             "make_blend_plan: keyframes is empty, expected at least one keyframe", value_error);
        CHECK_THROWS_WITH_AS(make_blend_plan<double>(strip, std::vector<frame_index>{{2}}, {0}),
                             "make_blend_plan: keyframes is 2, expected a frame below 2", value_error);
        CHECK_THROWS_WITH_AS(make_blend_plan<double>(strip, KF, {0}, 1.5),
                             "make_blend_plan: first_fill_share is 1.500000, expected a share in [0, 1]", value_error);
    }
    TEST_CASE("an exponent of quality runs from all alike over shares of quality to the best alone") {
        graded_strip const strip{{2, 3}};
        std::vector<frame_index> const KF{{0}, {1}}; // of qualities 1 and 3
        auto const shares = [&](double exponent) {
            return weights_of(make_blend_plan<double>(strip, KF, {0}, 0, texel_average::by_quality, {exponent}))[1];
        };
        CHECK(shares(0) == std::vector<double>{0.5, 0.5});
        CHECK(shares(2)[1] == doctest::Approx(0.9));
        CHECK(shares(6)[1] == doctest::Approx(729.0 / 730));
        CHECK(shares(1) == weights_of(make_blend_plan<double>(strip, KF, {0}, 0, texel_average::by_quality))[1]);
    }
    TEST_CASE("the winner has all of the average, whatever the order, and of those alike the earliest frame wins") {
        graded_strip const strip{{2, 3}};
        auto const plan_of = [&](std::vector<frame_index> const& KF, double share, bool is_known) {
            graded_strip of = strip;
            of.is_known = is_known;
            return make_blend_plan<double>(of, KF, {0}, share, texel_average::winner);
        };
        using rows = std::vector<std::vector<double>>;
        auto const drawn = plan_of({{0}, {1}}, 0, true);
        CHECK(weights_of(drawn) == rows{{1}, {1}, {1}});
        CHECK(drawn.sources == std::vector<std::uint32_t>{0, 3, 4}); // frame 1, which shows points 1, 2, 3
        CHECK(plan_of({{1}, {0}}, 0, true).sources == std::vector<std::uint32_t>{3, 0, 1});
        CHECK(weights_of(plan_of({{0}, {1}}, 0.5, true)) == rows{{1}, {0.5, 0.5}, {0.5, 0.5}});
        CHECK(plan_of({{1}, {0}}, 0, false).sources == std::vector<std::uint32_t>{3, 4, 5}); // frame 0
    }
    TEST_CASE("a match below the threshold of the frame's own quality is none, and what has no other is not covered") {
        graded_strip const strip{{2, 3}};
        std::vector<frame_index> const KF{{0}, {1}};
        auto const plan_of = [&](frame_index i, double threshold) {
            return make_blend_plan<double>(strip, KF, i, 0, texel_average::by_quality, {1, threshold});
        };
        // Frame 1 sees with quality 3, in which frame 0 has a third of it.
        CHECK(plan_of({1}, 0.3).sources.size() == 5);
        CHECK(plan_of({1}, 0.4).sources == std::vector<std::uint32_t>{3, 4, 5});
        CHECK(plan_of({0}, 2).sources == std::vector<std::uint32_t>{3, 4}); // of point 0 there is no better match
        CHECK(plan_of({0}, 2).covered_count() == 2);
        CHECK(plan_of({0}, 4).covered_count() == 0);
        graded_strip const unknown{{2, 3}, false};
        CHECK(make_blend_plan<double>(unknown, KF, {1}, 0, texel_average::plain, {1, 5}).sources.size() == 5);
        CHECK(make_blend_plan<double>(strip, KF, {1}, 0, texel_average::plain, {1, 0.4}).sources ==
              std::vector<std::uint32_t>{3, 4, 5});
    }
    TEST_CASE("matches of whole frames give weighed plans that single questions give") {
        std::size_t entries = 0;
        std::size_t fewer = 0;
        for (std::uint64_t seed = 0; seed < 3; ++seed) {
            auto const maps = testing::random_scene(seed, 6, {48, 64}, 1 + seed % 4);
            footprint_map const map(to_uv_view(maps), {12, 16});
            one_by_one const single{&map};
            auto const KF = draw_shuffled(seed);
            for (std::uint32_t i = 0; i < 6; ++i) {
                for (auto const& [average, weights] : {std::pair(texel_average::winner, quality_weights{}),
                                                       {texel_average::by_quality, quality_weights{3, 0}},
                                                       {texel_average::by_quality, quality_weights{1, 0.9}},
                                                       {texel_average::plain, quality_weights{1, 0.9}},
                                                       {texel_average::by_quality, quality_weights{0, 0.5}}}) {
                    auto const share = seed == 0 ? 0.0 : 0.5;
                    auto const expected = make_blend_plan<double>(single, KF, {i}, share, average, weights);
                    auto const plan = make_blend_plan<double>(map, KF, {i}, share, average, weights);
                    CHECK(plan.offsets == expected.offsets);
                    CHECK(plan.sources == expected.sources);
                    REQUIRE(plan.weights.size() == expected.weights.size());
                    for (std::size_t e = 0; e < plan.weights.size(); ++e) {
                        CHECK(plan.weights[e] == doctest::Approx(expected.weights[e]).epsilon(1e-6));
                    }
                    for (auto const& row : weights_of(plan)) {
                        CHECK(std::accumulate(row.begin(), row.end(), 0.0) == doctest::Approx(row.empty() ? 0.0 : 1.0));
                    }
                    entries += plan.sources.size();
                    fewer += make_blend_plan<double>(map, KF, {i}).covered_count() - plan.covered_count();
                }
            }
        }
        CHECK(entries > 4000);
        CHECK(fewer > 30);
    }
}
