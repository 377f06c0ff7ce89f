// SPDX-License-Identifier: MIT
// [GR sec. 3.2] The laws of correspondence_map and of what it may know besides, as a check of a model.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/blending/blend_plan.hpp>
#include <genrender/core/finite.hpp>
#include <genrender/correspondence/correspondence_map.hpp>
#include <genrender/testing/at_once.hpp>
#include <genrender/testing/law_report.hpp>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace genrender::testing {

/// The laws that a map breaks, and how many tokens showed a point, so that a caller can see that something was checked.
struct correspondence_report : law_report {
    std::size_t shown_tokens = 0; ///< tokens that showed a point, all frames together
};

namespace detail {

/// A question to a map as text: `token 3 of frame 0`.
inline std::string token_text(std::uint32_t frame, std::uint32_t token) {
    return "token " + std::to_string(token) + " of frame " + std::to_string(frame);
}

inline std::string answer_text(std::optional<token_index> token) {
    return token ? "token " + std::to_string(token->value) : "no token";
}

/// The laws of one point in one frame, asked for token t of frame i. Returns the token that shows it.
template <correspondence_map Map>
std::optional<token_index> check_point(law_report& report, Map const& map, frame_index j,
                                       typename Map::point_type const& point, std::uint32_t i, std::uint32_t t) {
    std::size_t const tokens = grid_extents(map.grid()).size();
    auto const token = map.token_at(j, point);
    auto const asked = [&] { return " for the point of " + token_text(i, t); };
    auto const where = [&] { return answer_text(token) + " of frame " + std::to_string(j.value) + asked(); };
    if (token != map.token_at(j, point)) {
        report.add("correspondence_map: equal questions get equal answers", where() + " and another when asked again",
                   "the same");
    }
    if (token && token->value >= tokens) {
        report.add("correspondence_map: tokens returned lie in the grid", where(),
                   "a token below " + std::to_string(tokens));
    }
    if constexpr (weighted_correspondence_map<Map>) {
        double sum = 0;
        map.visit_tokens(j, point, [&](token_index shows, double weight) {
            if (shows.value >= tokens) {
                report.add("weighted_correspondence_map: tokens visited lie in the grid", answer_text(shows) + asked(),
                           "a token below " + std::to_string(tokens));
            }
            if (!(weight > 0)) {
                report.add("weighted_correspondence_map: weights are above 0", number_text(weight) + asked(),
                           "a number above 0");
            }
            sum += weight;
        });
        if (!are_close(sum, token ? 1 : 0, 1e-5)) {
            report.add("weighted_correspondence_map: weights sum to 1 where token_at finds a token, and there are none "
                       "elsewhere",
                       number_text(sum) + " with " + where(), token ? "1" : "0");
        }
    }
    if constexpr (graded_correspondence_map<Map>) {
        double const quality = token ? static_cast<double>(map.quality_at(j, point)) : 0.0;
        if (!(is_finite(quality) && quality >= 0)) {
            report.add("graded_correspondence_map: qualities are finite and at least 0",
                       number_text(quality) + " with " + where(), "a finite number of at least 0");
        }
    }
    return token;
}

/// That matches of a frame in all frames say what token_at and quality_at say; `found` [frame, token].
template <matched_correspondence_map Map>
void check_matches(law_report& report, Map const& map, std::uint32_t i, std::vector<frame_index> const& frames,
                   std::vector<std::vector<std::optional<token_index>>> const& found) {
    auto const matches = map.matches({i}, frames);
    if (matches.empty()) {
        return;
    }
    std::size_t const tokens = grid_extents(map.grid()).size();
    std::string const law = "matched_correspondence_map: matches say what token_at and quality_at say";
    if (matches.size() != frames.size()) {
        report.add(law, std::to_string(matches.size()) + " for frame " + std::to_string(i),
                   std::to_string(frames.size()) + ", one for each frame asked for");
        return;
    }
    for (std::size_t j = 0; j < matches.size(); ++j) {
        auto const& match = *matches[j];
        if (match.tokens.size() != tokens || match.is_shown.size() != tokens || match.qualities.size() != tokens) {
            report.add(law, std::to_string(match.tokens.size()) + " tokens", std::to_string(tokens));
            continue;
        }
        for (std::uint32_t t = 0; t < tokens; ++t) {
            auto const token = match.is_shown[t] != 0 ? std::optional(token_index{match.tokens[t]}) : std::nullopt;
            if (token != found[j][t]) {
                report.add(law, answer_text(token) + " of frame " + std::to_string(j) + " for " + token_text(i, t),
                           answer_text(found[j][t]));
            }
            if constexpr (graded_correspondence_map<Map>) {
                auto const point = map.point_at({i}, {t});
                auto const quality = static_cast<double>(match.qualities[t]);
                auto const expected = token && point ? static_cast<double>(map.quality_at(frames[j], *point)) : quality;
                if (!are_close(quality, expected, 1e-5)) {
                    report.add(law, "quality " + number_text(quality) + " for " + token_text(i, t),
                               number_text(expected));
                }
            }
        }
    }
}

} // namespace detail

/// Checks the laws of correspondence_map on every frame and token of `map`, and those of weighted_, graded_ and
/// matched_correspondence_map where it is one. Asks every frame for every point: frames^2 tokens questions, twice.
/// Throws what the map throws.
template <correspondence_map Map>
correspondence_report check_correspondence_laws(Map const& map) {
    correspondence_report report;
    std::size_t const count = map.frame_count();
    std::size_t const tokens = grid_extents(map.grid()).size();
    std::vector<frame_index> frames;
    for (std::uint32_t i = 0; i < count; ++i) {
        frames.push_back({i});
    }
    using answers_type = std::vector<std::vector<std::optional<token_index>>>;
    std::vector<answers_type> answers;
    for (std::uint32_t i = 0; i < count; ++i) {
        answers_type found(count, std::vector<std::optional<token_index>>(tokens));
        for (std::uint32_t t = 0; t < tokens; ++t) {
            auto const point = map.point_at({i}, {t});
            if (point.has_value() != map.point_at({i}, {t}).has_value()) {
                report.add("correspondence_map: equal questions get equal answers",
                           "a point and none at " + detail::token_text(i, t), "the same when asked again");
            }
            if (!point) {
                continue;
            }
            ++report.shown_tokens;
            for (std::uint32_t j = 0; j < count; ++j) {
                found[j][t] = detail::check_point(report, map, {j}, *point, i, t);
            }
            if (!found[i][t]) {
                report.add("correspondence_map: the point that a token shows is shown by some token of its frame",
                           "none for the point of " + detail::token_text(i, t),
                           "a token of frame " + std::to_string(i));
            }
        }
        if constexpr (matched_correspondence_map<Map>) {
            detail::check_matches(report, map, i, frames, found);
        }
        answers.push_back(std::move(found));
    }
    // On two threads, from the last frame on, every answer is what it was.
    std::vector<char> is_same(count, 1);
    at_once(2, count, [&](std::size_t frame) {
        auto const i = static_cast<std::uint32_t>(frame);
        for (std::uint32_t t = 0; t < tokens; ++t) {
            auto const point = map.point_at({i}, {t});
            for (std::uint32_t j = 0; point && j < count; ++j) {
                is_same[i] = is_same[i] && map.token_at({j}, *point) == answers[i][j][t];
            }
        }
    });
    for (std::uint32_t i = 0; i < count; ++i) {
        report.require(is_same[i] != 0, "correspondence_map: answers are the same from any thread",
                       "other answers for frame " + std::to_string(i), "those of one thread");
    }
    return report;
}

} // namespace genrender::testing

#include <genrender/core/end_header.inl>
