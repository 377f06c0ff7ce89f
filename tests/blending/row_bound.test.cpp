// SPDX-License-Identifier: MIT
// [GR eq. 6] The bound of rows holds on scenes that know nothing of it.
#include <genrender/blending/row_bound.hpp>

#include <genrender/baselines/propagation_plan.hpp>
#include <genrender/blending/blend_plan.hpp>
#include <genrender/blending/padded_rows.hpp>

#include "../support/random_scene.hpp"
#include "../support/shifted_strip.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cstddef>
#include <optional>
#include <vector>

using namespace genrender;

TEST_SUITE("blending/row_bound") {
    namespace {

    struct untold : testing::shifted_strip {
        template <class Visit>
        void visit_tokens(frame_index frame, point_type const& point, Visit const& visit) const {
            if (auto const token = token_at(frame, point)) {
                visit(*token, 1.0);
            }
        }
    };

    constexpr std::size_t frames = 9;

    /// The longest row of the plans of all frames of a scene.
    std::size_t longest_row(chosen_correspondence<2> const& map, std::vector<frame_index> const& KF) {
        std::size_t longest = 0;
        for (std::uint32_t i = 0; i < frames; ++i) {
            longest = std::max(longest, row_width(make_blend_plan<float>(map, KF, {i}).rows()));
            CHECK(row_width(make_propagation_plan<float>(map, KF, {i}).plan.rows()) <=
                  std::min<std::size_t>(2, KF.size()));
        }
        return longest;
    }

    } // namespace

    TEST_CASE(
        "no row of random scenes is longer than the bound, with any reading of texels and any number of keyframes") {
        std::size_t longest_average = 0;
        std::size_t reached = 0;
        for (std::uint64_t seed = 0; seed < 6; ++seed) {
            auto const maps = testing::random_scene(seed, frames, {32, 32}, 3);
            for (auto const m : {std::size_t{1}, std::size_t{3}, std::size_t{8}}) {
                std::vector<frame_index> KF;
                for (std::uint32_t k = 0; k < m; ++k) {
                    KF.push_back({static_cast<std::uint32_t>((k * 4 + seed) % frames)});
                }
                std::vector<correspondence_settings> all(1);
                for (auto const reading : {texel_reading::nearest_sample, texel_reading::average}) {
                    for (auto const& T : {std::optional<std::size_t>{}, std::optional<std::size_t>{3}}) {
                        for (auto const dilation : {std::size_t{0}, std::size_t{1}}) {
                            all.push_back({correspondence_kind::texel_grid, {}, {T, reading, dilation}});
                        }
                    }
                }
                for (auto const& settings : all) {
                    chosen_correspondence<2> const map(to_uv_view(maps), {8, 8}, settings);
                    auto const bound = max_row_width(map, m);
                    auto const longest = longest_row(map, KF);
                    CHECK(longest <= bound);
                    auto const averages = settings.kind == correspondence_kind::texel_grid &&
                                          settings.texels.reading == texel_reading::average;
                    if (averages) {
                        longest_average = std::max(longest_average, longest);
                        CHECK(!max_row_width(settings, m));
                    } else {
                        CHECK(bound == m);
                        CHECK(max_row_width(settings, m) == m);
                        reached += longest == m ? 1U : 0U;
                    }
                }
            }
        }
        CHECK(longest_average > 16); // so the bound of averages is not that of the others
        CHECK(reached > 20);         // and that of the others is reached
        MESSAGE("longest row of averaged texels at m <= 8: ", longest_average);
    }
    TEST_CASE("a map that knows one token a point is bounded by the keyframes, one that does not tell by all tokens") {
        testing::shifted_strip const strip{5, 4};
        CHECK(max_row_width(strip, 3) == 3);
        static_assert(weighted_correspondence_map<untold> && !bounded_correspondence_map<untold>);
        CHECK(max_row_width(untold{{5, 4}}, 3) == 3 * 4);
    }
}
