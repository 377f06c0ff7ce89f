// SPDX-License-Identifier: MIT
// [GR sec. 3.2] How well tokens of one feature resolution find their partners in the keyframes, measured at the maps'.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/parallel.hpp>
#include <genrender/correspondence/correspondence_map.hpp>
#include <genrender/correspondence/representative_pixel.hpp>
#include <genrender/correspondence/surface_footprint.hpp>
#include <genrender/maps/canonical_maps.hpp>
#include <genrender/inspection/pixel_lattice.hpp>
#include <genrender/inspection/screen_search.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace genrender {

/// Which tokens of a frame some keyframe covers.
struct token_cover {
    frame_index frame; ///< whose tokens these are
    /// [tokens]: in how many of the steps looked at the token is covered; none where it shows no object.
    std::vector<std::optional<std::size_t>> steps;
};

/// The measures of one feature resolution. Its pairs are a token and a keyframe other than the token's own frame.
struct grid_check {
    grid_extents grid;                  ///< of the features, in tokens
    std::optional<std::string> refusal; ///< why nothing could be measured: the sentence of the one who refused

    std::size_t seen = 0;           ///< pairs whose keyframe shows the token's surface point, by screen_search
    std::size_t hits = 0;           ///< of these, for which the correspondence finds a token
    double error_sum = 0;           ///< over hits, from the found token's middle to the true place, in feature pixels
    std::size_t found = 0;          ///< pairs for which the correspondence finds a token, of all tokens
    std::size_t collided = 0;       ///< of these, that share their found token with another one of their frame
    std::size_t on_objects = 0;     ///< tokens that show an object, in every step looked at
    std::size_t covered = 0;        ///< of these, for which some keyframe has a token: the run's coverage
    std::vector<token_cover> cover; ///< of each frame looked at

    /// hits / seen: share of seen tokens that are found; none if none is seen.
    std::optional<double> hit_rate() const { return ratio(static_cast<double>(hits), seen); }
    /// error_sum / hits: mean error of found tokens; none without hits.
    std::optional<double> error() const { return ratio(error_sum, hits); }
    /// collided / found: share of found tokens that two share; none if nothing was found.
    std::optional<double> collisions() const { return ratio(static_cast<double>(collided), found); }
    /// covered / on_objects: share of tokens that a keyframe covers; none without objects.
    std::optional<double> coverage() const { return ratio(static_cast<double>(covered), on_objects); }

private:
    static std::optional<double> ratio(double part, std::size_t whole) {
        return whole > 0 ? std::optional(part / static_cast<double>(whole)) : std::nullopt;
    }
};

namespace detail {

/// The measures of the tokens of frame i by the keyframes of every step; `tokens` of them, about, are searched for.
template <correspondence_map Map, canonical_maps Maps>
grid_check check_frame(Map const& map, Maps const& maps, frame_index i,
                       std::vector<std::vector<frame_index>> const& steps,
                       std::map<frame_index, screen_search<Maps>> const& searches, std::size_t tokens) {
    grid_check result;
    auto const grid = map.grid();
    auto const height = static_cast<double>(maps.grid().height) / static_cast<double>(grid.height);
    auto const width = static_cast<double>(maps.grid().width) / static_cast<double>(grid.width);
    std::vector<std::optional<typename Map::point_type>> points(grid.size());
    auto& cover = result.cover.emplace_back(token_cover{i, {}}).steps;
    cover.resize(grid.size());
    for (std::uint32_t t = 0; t < grid.size(); ++t) {
        points[t] = map.point_at(i, {t});
        cover[t] = points[t] ? std::optional<std::size_t>(0) : std::nullopt;
    }
    std::vector<std::uint8_t> is_asked(grid.size());
    pixel_lattice(grid, tokens).visit_pixels([&](pixel p) { is_asked[p.row * grid.width + p.column] = 1; });

    // The answers of each keyframe, which several steps may have drawn
    std::map<frame_index, std::vector<std::optional<token_index>>> answers;
    for (auto const& keyframes : steps) {
        for (auto const k : keyframes) {
            auto& answer = answers[k];
            if (!answer.empty()) {
                continue;
            }
            answer.resize(grid.size());
            for (std::uint32_t t = 0; t < grid.size(); ++t) {
                answer[t] = points[t] ? map.token_at(k, *points[t]) : std::nullopt;
            }
        }
    }

    // Coverage counts a keyframe's own tokens, as the run does; a frame's pairs are with the others.
    for (auto const& keyframes : steps) {
        for (std::size_t t = 0; t < grid.size(); ++t) {
            auto const is_covered =
                std::any_of(keyframes.begin(), keyframes.end(), [&](auto k) { return answers.at(k)[t].has_value(); });
            result.on_objects += points[t].has_value();
            result.covered += is_covered;
            if (is_covered) {
                ++*cover[t];
            }
        }
    }
    for (auto const& [k, answer] : answers) {
        if (k == i) {
            continue;
        }
        std::vector<std::size_t> askers(grid.size());
        for (auto const& token : answer) {
            if (token) {
                ++askers[token->value];
            }
        }
        for (std::uint32_t t = 0; t < grid.size(); ++t) {
            auto const& token = answer[t];
            result.found += token.has_value();
            result.collided += token && askers[token->value] > 1;
            auto const p = points[t] && is_asked[t] ? representative_pixel(maps, i, grid, {t}) : std::nullopt;
            auto const footprint = p ? footprint_at(maps, i, *p) : std::nullopt;
            if (!footprint) {
                continue;
            }
            auto const place = searches.at(k).place_of(maps.object_at(i, *p), maps.point_at(i, *p), *footprint);
            result.seen += place.has_value();
            if (place && token) {
                auto const row = static_cast<double>(token->value / grid.width) + 0.5;
                auto const column = static_cast<double>(token->value % grid.width) + 0.5;
                ++result.hits;
                result.error_sum += std::hypot(place->row / height - row, place->column / width - column);
            }
        }
    }
    return result;
}

} // namespace detail

/// Measures a correspondence map over `maps` at some `frames` by the keyframes of some `steps`. `searches` holds every
/// keyframe; about `tokens` of each frame's are searched for.
template <correspondence_map Map, canonical_maps Maps>
grid_check check_grid(Map const& map, Maps const& maps, std::vector<frame_index> const& frames,
                      std::vector<std::vector<frame_index>> const& steps,
                      std::map<frame_index, screen_search<Maps>> const& searches, std::size_t tokens = 1024,
                      any_loop const& loop = {}) {
    std::vector<grid_check> of_frame(frames.size());
    loop(frames.size(),
         [&](std::size_t k) { of_frame[k] = detail::check_frame(map, maps, frames[k], steps, searches, tokens); });
    grid_check result;
    result.grid = map.grid();
    for (auto const& one : of_frame) {
        result.seen += one.seen;
        result.hits += one.hits;
        result.error_sum += one.error_sum;
        result.found += one.found;
        result.collided += one.collided;
        result.on_objects += one.on_objects;
        result.covered += one.covered;
        result.cover.insert(result.cover.end(), one.cover.begin(), one.cover.end());
    }
    return result;
}

} // namespace genrender

#include <genrender/core/end_header.inl>
