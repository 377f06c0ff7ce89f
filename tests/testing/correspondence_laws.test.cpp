// SPDX-License-Identifier: MIT
// [GR sec. 3.2] Every law of correspondence maps can be broken, and is told by its sentence.
#include <genrender/testing/correspondence_laws.hpp>

#include "broken_laws.hpp"

#include <doctest/doctest.h>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <thread>
#include <vector>

TEST_SUITE("testing/correspondence_laws") {
    using namespace genrender;
    using namespace genrender::testing;

    namespace {

    using names = std::vector<std::string>;

    enum class mistake {
        none,
        loses_its_own_point,
        leaves_the_grid,
        changes_its_mind,
        changes_its_mind_of_points,
        minds_the_thread,
        visits_outside,
        weighs_nothing,
        weighs_twice,
        grades_below_nothing,
        matches_another,
        matches_too_few,
        grades_matches_otherwise
    };

    /// Frame i shows the points i, i + 1, ..., i + 3 of a strip, and knows all that a map may know.
    struct strip {
        using point_type = std::uint32_t;
        mistake made = mistake::none;
        std::thread::id home = std::this_thread::get_id();
        mutable std::atomic<std::size_t> asked{0};

        std::size_t frame_count() const { return 3; }
        grid_extents grid() const { return {1, 4}; }
        std::optional<point_type> point_at(frame_index i, token_index t) const {
            if (made == mistake::changes_its_mind_of_points && ++asked % 2 == 0) {
                return std::nullopt;
            }
            return i.value + t.value;
        }
        std::optional<token_index> token_at(frame_index i, point_type point) const {
            if (point < i.value || point >= i.value + 4 || (made == mistake::loses_its_own_point && point == 2)) {
                return std::nullopt;
            }
            std::uint32_t const t = point - i.value;
            switch (made) {
            case mistake::leaves_the_grid:
                return token_index{t + 1};
            case mistake::changes_its_mind:
                return token_index{++asked % 2 == 0 ? t : t ^ 1U};
            case mistake::minds_the_thread:
                return token_index{std::this_thread::get_id() == home ? t : t ^ 1U};
            default:
                return token_index{t};
            }
        }
        template <class Visit>
        void visit_tokens(frame_index i, point_type point, Visit const& visit) const {
            auto const token = token_at(i, point);
            if (!token) {
                return;
            }
            visit(made == mistake::visits_outside ? token_index{9} : *token, made == mistake::weighs_twice ? 2.0 : 1.0);
            if (made == mistake::weighs_nothing) {
                visit(*token, 0.0);
            }
        }
        double quality_at(frame_index i, point_type) const {
            return made == mistake::grades_below_nothing ? -1.0 : 1.0 + i.value;
        }
        std::vector<std::shared_ptr<token_matches const>> matches(frame_index from,
                                                                  std::span<frame_index const> to) const {
            std::vector<std::shared_ptr<token_matches const>> all;
            for (auto const frame : to) {
                token_matches match(4);
                for (std::uint32_t t = 0; t < 4; ++t) {
                    if (auto const token = token_at(frame, from.value + t)) {
                        match.tokens[t] = token->value ^ (made == mistake::matches_another ? 1U : 0U);
                        match.is_shown[t] = 1;
                        match.qualities[t] = static_cast<float>(quality_at(frame, t)) *
                                             (made == mistake::grades_matches_otherwise ? 2.0F : 1.0F);
                    }
                }
                all.push_back(std::make_shared<token_matches const>(match, std::pmr::get_default_resource()));
            }
            if (made == mistake::matches_too_few) {
                all.pop_back();
            }
            return all;
        }
    };

    names laws_broken_by(mistake made) { return broken_laws(check_correspondence_laws(strip{made})); }

    } // namespace

    TEST_CASE("a map that knows all there is to know keeps the laws") {
        static_assert(weighted_correspondence_map<strip> && graded_correspondence_map<strip> &&
                      matched_correspondence_map<strip>);
        auto const report = check_correspondence_laws(strip{});
        CHECK(report.text() == "");
        CHECK(report.shown_tokens == 12);
    }
    TEST_CASE("each mistake is told by the law that it breaks") {
        CHECK(laws_broken_by(mistake::loses_its_own_point) ==
              names{"correspondence_map: the point that a token shows is shown by some token of its frame"});
        CHECK(laws_broken_by(mistake::leaves_the_grid).front() ==
              "correspondence_map: tokens returned lie in the grid");
        CHECK(laws_broken_by(mistake::changes_its_mind).front() ==
              "correspondence_map: equal questions get equal answers");
        CHECK(laws_broken_by(mistake::changes_its_mind_of_points).front() ==
              "correspondence_map: equal questions get equal answers");
        CHECK(laws_broken_by(mistake::minds_the_thread) ==
              names{"correspondence_map: answers are the same from any thread"});
        CHECK(laws_broken_by(mistake::visits_outside) ==
              names{"weighted_correspondence_map: tokens visited lie in the grid"});
        CHECK(laws_broken_by(mistake::weighs_nothing) == names{"weighted_correspondence_map: weights are above 0"});
        CHECK(laws_broken_by(mistake::weighs_twice) ==
              names{"weighted_correspondence_map: weights sum to 1 where token_at finds a token, and there are none "
                    "elsewhere"});
        CHECK(laws_broken_by(mistake::grades_below_nothing) ==
              names{"graded_correspondence_map: qualities are finite and at least 0"});
        for (auto const made :
             {mistake::matches_another, mistake::matches_too_few, mistake::grades_matches_otherwise}) {
            CHECK(laws_broken_by(made) ==
                  names{"matched_correspondence_map: matches say what token_at and quality_at say"});
        }
    }
    TEST_CASE("sentences say what was found where and what was expected") {
        CHECK(
            check_correspondence_laws(strip{mistake::leaves_the_grid}).violations.front() ==
            "correspondence_map: tokens returned lie in the grid: found token 4 of frame 0 for the point of token 3 of "
            "frame 0, expected a token below 4");
        CHECK(
            check_correspondence_laws(strip{mistake::loses_its_own_point}).text() ==
            "correspondence_map: the point that a token shows is shown by some token of its frame: found none for the "
            "point of token 2 of frame 0, expected a token of frame 0\n");
        CHECK(check_correspondence_laws(strip{mistake::matches_another}).text() ==
              "matched_correspondence_map: matches say what token_at and quality_at say: found token 1 of frame 0 for "
              "token 0 of frame 0, expected token 0\n");
    }
}
