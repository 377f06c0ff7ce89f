// SPDX-License-Identifier: MIT
// [GR sec. 3] What names a surface point in every frame: texture coordinates, or where the point lies at rest.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/index.hpp>
#include <genrender/core/strided_view.hpp>

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>

namespace genrender {

/// Maps of an animation that tell, for every pixel of every frame, which object it shows and where on that object, in
/// coordinates that move with the surface.
///
/// expression                | type                | meaning
/// --------------------------|---------------------|------------------------------------------------------------------
/// `Maps::dimensions`        | size_t              | number of canonical coordinates: 2 for UV, 3 for rest positions
/// `maps.frame_count()`      | size_t              | frames of the animation
/// `maps.grid()`             | grid_extents        | height and width of the maps
/// `maps.is_covered(i, p)`   | bool                | whether the pixel shows an object
/// `maps.object_at(i, p)`    | object_index        | the object that a covered pixel shows
/// `maps.point_at(i, p)`     | array<float, D>     | its canonical coordinates; equal ones are one surface point
///
/// All members are const. Maps can be copied, as cheaply as views: who finds correspondences in them keeps them.
/// object_at and point_at are asked of covered pixels alone. `render` asks from several threads if its loop has
/// several, refuses coordinates that are not finite, and wants a grid that is a whole multiple of the denoiser's latent
/// and feature grids. No check of testing/ is needed beyond that: preflight (inspection/preflight.hpp) looks at what
/// the maps say.
///
/// Models: uv_maps_view, position_maps_view.
template <class Maps>
concept canonical_maps = std::copy_constructible<Maps> &&(Maps::dimensions == 2 || Maps::dimensions == 3) &&
                         requires(Maps const& maps, frame_index i, pixel p) {
    { maps.frame_count() } -> std::convertible_to<std::size_t>;
    { maps.grid() } -> std::convertible_to<grid_extents>;
    { maps.is_covered(i, p) } -> std::same_as<bool>;
    { maps.object_at(i, p) } -> std::same_as<object_index>;
    { maps.point_at(i, p) } -> std::same_as<std::array<float, Maps::dimensions>>;
};

namespace detail {

// One part of the concept each, so that who checks it names what is missing in a line of his own.
template <class Maps>
concept maps_tell_dimensions = std::copy_constructible<Maps> &&(Maps::dimensions == 2 || Maps::dimensions == 3);
template <class Maps>
concept maps_tell_extents = requires(Maps const& maps) {
    { maps.frame_count() } -> std::convertible_to<std::size_t>;
    { maps.grid() } -> std::convertible_to<grid_extents>;
};
template <class Maps>
concept maps_tell_coverage = requires(Maps const& maps, frame_index i, pixel p) {
    { maps.is_covered(i, p) } -> std::same_as<bool>;
};
template <class Maps>
concept maps_tell_objects = requires(Maps const& maps, frame_index i, pixel p) {
    { maps.object_at(i, p) } -> std::same_as<object_index>;
};
template <class Maps>
concept maps_tell_points = !maps_tell_dimensions<Maps> || requires(Maps const& maps, frame_index i, pixel p) {
    { maps.point_at(i, p) } -> std::same_as<std::array<float, Maps::dimensions>>;
};

} // namespace detail

// The sentences, which static_assert takes as literals only.
/// What the compiler says of maps that lack this.
#define GENRENDER_MAPS_DIMENSIONS "canonical_maps: maps can be copied and have `dimensions`, a constant of 2 or 3"
/// What the compiler says of maps that lack this.
#define GENRENDER_MAPS_EXTENTS                                                                                         \
    "canonical_maps: frame_count() is const and returns a number, grid() is const and returns grid_extents"
/// What the compiler says of maps that lack this.
#define GENRENDER_MAPS_COVERAGE "canonical_maps: is_covered(frame, pixel) is const and returns bool"
/// What the compiler says of maps that lack this.
#define GENRENDER_MAPS_OBJECTS "canonical_maps: object_at(frame, pixel) is const and returns object_index"
/// What the compiler says of maps that lack this.
#define GENRENDER_MAPS_POINTS                                                                                          \
    "canonical_maps: point_at(frame, pixel) is const and returns std::array<float, dimensions>"

/// Fails to compile with a sentence for each part that canonical maps lack.
template <class Maps>
consteval void require_canonical_maps() {
    static_assert(detail::maps_tell_dimensions<Maps>, GENRENDER_MAPS_DIMENSIONS);
    static_assert(detail::maps_tell_extents<Maps>, GENRENDER_MAPS_EXTENTS);
    static_assert(detail::maps_tell_coverage<Maps>, GENRENDER_MAPS_COVERAGE);
    static_assert(detail::maps_tell_objects<Maps>, GENRENDER_MAPS_OBJECTS);
    static_assert(detail::maps_tell_points<Maps>, GENRENDER_MAPS_POINTS);
}

/// Maps of an animation in their owner's memory, of D coordinates: full resolution, no antialiasing, floating point. A
/// model of canonical_maps.
template <std::size_t D>
    requires(D == 2 || D == 3)
class canonical_maps_view {
public:
    /// Components of a coordinate: 2 for UVs, 3 for positions at rest.
    static constexpr std::size_t dimensions = D;

    /// `points` [frames, height, width, D], texture coordinates or positions in the units of the rest pose; `object`
    /// and `coverage` [frames, height, width]. Throws shape_error if the extents do not fit each other.
    canonical_maps_view(strided_view<float const, 4> points, strided_view<std::uint32_t const, 3> object,
                        strided_view<std::uint8_t const, 3> coverage)
        : points_(points), object_(object), coverage_(coverage) {
        auto const& e = coverage.extents();
        auto const name = D == 2 ? "uv_maps_view" : "position_maps_view";
        require_shape(name, D == 2 ? "uv" : "position", points, {e[0], e[1], e[2], D});
        require_shape(name, "object", object, e);
    }

    /// Number of frames.
    std::size_t frame_count() const { return coverage_.extent(0); }
    /// Height and width of a frame in pixels.
    grid_extents grid() const { return {coverage_.extent(1), coverage_.extent(2)}; }

    /// Whether the pixel shows an object.
    bool is_covered(frame_index i, pixel p) const { return coverage_(i.value, p.row, p.column) != 0; }
    /// The object a covered pixel shows.
    object_index object_at(frame_index i, pixel p) const { return {object_(i.value, p.row, p.column)}; }
    /// (u, v), or (x, y, z) at rest, of a covered pixel.
    std::array<float, D> point_at(frame_index i, pixel p) const {
        std::array<float, D> point;
        for (std::size_t d = 0; d < D; ++d) {
            point[d] = points_(i.value, p.row, p.column, d);
        }
        return point;
    }

private:
    strided_view<float const, 4> points_;
    strided_view<std::uint32_t const, 3> object_;
    strided_view<std::uint8_t const, 3> coverage_;
};

/// Where each surface point lies in its object's rest pose. Unlike UVs, no two points of an object share their rest
/// position, so overlapping, mirrored and tiled UVs and the seams of charts do not matter.
using position_maps_view = canonical_maps_view<3>;

} // namespace genrender

#include <genrender/core/end_header.inl>
