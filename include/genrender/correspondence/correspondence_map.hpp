// SPDX-License-Identifier: MIT
// [GR sec. 3.2] The front door of correspondence: which surface point a token shows, and which token shows it.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/index.hpp>

#include <concepts>
#include <cstddef>
#include <optional>

namespace genrender {

/// Tells, at one feature resolution of an animation, which canonical surface point a token of a frame shows, and which
/// token of a frame shows a surface point. What a surface point is stays the model's own affair: a texel, a place on a
/// mesh.
///
/// expression                   | type                  | meaning
/// -----------------------------|-----------------------|--------------------------------------------------------------
/// `typename Map::point_type`   | copyable              | a canonical surface point
/// `map.frame_count()`          | size_t                | frames of the animation
/// `map.grid()`                 | grid_extents          | height and width of the feature map
/// `map.point_at(frame, token)` | optional<point_type>  | the surface point that the token shows; none on the
///                              |                       | background
/// `map.token_at(frame, point)` | optional<token_index> | the token that shows the point in that frame; none where it
///                              |                       | is hidden or out of view
///
/// These the compiler cannot check, and a model owes them (check_correspondence_laws of
/// testing/correspondence_laws.hpp checks them):
/// the point that a token shows is shown by some token of the same frame; tokens returned lie in the grid; equal
/// questions get equal answers, from any thread. It does not require that the token that shows a point is the one it
/// was asked from: where several tokens share a texel, one of them stands for all.
///
/// Optional capabilities: weighted_correspondence_map, for models that know several tokens a point;
/// graded_correspondence_map, how well it is seen; matched_correspondence_map (blending/blend_plan.hpp), all tokens at
/// once. See also: footprint_map, without a texture; texel_grid, the paper's own; make_blend_plan, which compiles plans
/// of it; render, which asks `make_map(grid)` for a map of each feature resolution.
template <class Map>
concept correspondence_map = std::copyable<typename Map::point_type> &&
    requires(Map const& map, frame_index i, token_index t, typename Map::point_type const& point) {
    { map.frame_count() } -> std::convertible_to<std::size_t>;
    { map.grid() } -> std::convertible_to<grid_extents>;
    { map.point_at(i, t) } -> std::same_as<std::optional<typename Map::point_type>>;
    { map.token_at(i, point) } -> std::same_as<std::optional<token_index>>;
};

/// Fails to compile with a sentence for each part that a correspondence_map lacks.
template <class Map>
consteval void require_correspondence_map() {
    static_assert(
        requires { requires std::copyable<typename Map::point_type>; },
        "correspondence_map: point_type is a copyable type");
    static_assert(
        requires(Map const& map) {
            { map.frame_count() } -> std::convertible_to<std::size_t>;
            { map.grid() } -> std::convertible_to<grid_extents>;
        },
        "correspondence_map: frame_count() is const and returns a number, grid() is const and returns grid_extents");
    static_assert(
        requires(Map const& map, frame_index i, token_index t) {
            { map.point_at(i, t) } -> std::same_as<std::optional<typename Map::point_type>>;
        },
        "correspondence_map: point_at(frame, token) is const and returns std::optional<point_type>");
    static_assert(
        requires(Map const& map, frame_index i, typename Map::point_type const& point) {
            { map.token_at(i, point) } -> std::same_as<std::optional<token_index>>;
        },
        "correspondence_map: token_at(frame, point) is const and returns std::optional<token_index>");
}

/// The least that a visitor of weighted tokens is, for checking maps; never run.
struct token_visitor_archetype {
    /// A token that shows the point, and its weight.
    void operator()(token_index token, double weight) const;
};

/// A correspondence_map that answers with several tokens and weights, an optional capability: a token that another map
/// finds counts fully and alone.
///
/// expression                              | type | meaning
/// ----------------------------------------|------|-------------------------------------------------------------------
/// `map.visit_tokens(frame, point, visit)` | any  | calls `visit(token_index, double weight)` for each token of the
///                                         |      | frame that shows the point, weights above 0 that sum to 1; never
///                                         |      | where token_at finds none; a template for every `visit`
template <class Map>
concept weighted_correspondence_map = correspondence_map<Map> &&
    requires(Map const& map, frame_index i, typename Map::point_type const& point,
             token_visitor_archetype const& visit) {
    map.visit_tokens(i, point, visit);
};

/// A weighted_correspondence_map that says how many tokens it knows a point by, an optional capability: it bounds the
/// rows of plans (max_row_width). Of others nothing less than all tokens of a frame is known.
///
/// expression          | type   | meaning
/// --------------------|--------|---------------------------------------------------------------------------------
/// `map.most_tokens()` | size_t | no visit_tokens visits more tokens than these
template <class Map>
concept bounded_correspondence_map = weighted_correspondence_map<Map> && requires(Map const& map) {
    { map.most_tokens() } -> std::convertible_to<std::size_t>;
};

/// A correspondence_map that says how well a frame shows a point, an optional capability: with others all keyframes
/// that see a point weigh alike, whatever `settings.average` says.
///
/// expression                     | type   | meaning
/// -------------------------------|--------|--------------------------------------------------------------------------
/// `map.quality_at(frame, point)` | double | finite, in units of which only ratios between frames matter; above 0
///                                |        | where token_at finds a token, or 0 where nothing is known of it
template <class Map>
concept graded_correspondence_map = correspondence_map<Map> &&
    requires(Map const& map, frame_index i, typename Map::point_type const& point) {
    { map.quality_at(i, point) } -> std::convertible_to<double>;
};

/// The least that a correspondence_map is, for checking what takes one; never run.
struct correspondence_map_archetype {
    struct point_type {};
    /// Number of frames.
    std::size_t frame_count() const;
    /// Height and width of the feature map.
    grid_extents grid() const;
    /// The surface point that the token shows.
    std::optional<point_type> point_at(frame_index, token_index) const;
    /// The token of the frame that shows the point.
    std::optional<token_index> token_at(frame_index, point_type) const;
};

} // namespace genrender

#include <genrender/core/end_header.inl>
