// SPDX-License-Identifier: MIT
// The samples of a footprint_map, read frame by frame from maps of any type.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/index.hpp>
#include <genrender/core/instance.hpp>
#include <genrender/core/parallel.hpp>
#include <genrender/correspondence/frame_samples.hpp>
#include <genrender/correspondence/representative_pixel.hpp>
#include <genrender/correspondence/surface_footprint.hpp>
#include <genrender/maps/canonical_maps.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

namespace genrender::detail {

/// The pixels that stand for the tokens of a frame.
struct representative_pixels {
    std::vector<std::uint32_t> numbers; ///< row * width + column, of tokens that have one
    std::vector<bool> is_there;
};

/// Where a map of tokens has its surface points and samples from.
template <std::size_t D>
struct sample_source {
    virtual ~sample_source() = default;
    virtual std::size_t frame_count() const = 0;
    virtual std::optional<footprint_point<D>> point_at(frame_index i, token_index token) const = 0;
    virtual frame_samples<D> samples_in(frame_index i) const = 0;
};

/// Maps, and the pixel that stands for each token.
template <canonical_maps Maps>
class sample_source_of final : public sample_source<Maps::dimensions> {
    using point_type = footprint_point<Maps::dimensions>;

public:
    sample_source_of(Maps const& maps, grid_extents grid, double reach)
        : maps_(maps), grid_(grid), reach_(reach), representatives_(maps.frame_count()) {}

    /// Checks a frame and remembers which pixels stand for its tokens.
    void read(frame_index i) {
        auto& of_frame = representatives_[i.value];
        of_frame.numbers.resize(grid_.size());
        of_frame.is_there.resize(grid_.size());
        for (std::uint32_t t = 0; t < grid_.size(); ++t) {
            if (auto const p = representative_pixel(maps_, i, grid_, {t})) {
                of_frame.numbers[t] = static_cast<std::uint32_t>(p->row * maps_.grid().width + p->column);
                of_frame.is_there[t] = true;
            }
        }
        require_finite(i);
    }

    std::size_t frame_count() const override { return representatives_.size(); }

    std::optional<point_type> point_at(frame_index i, token_index token) const override {
        auto const p = representative_of(i, token);
        return p ? std::optional(point_type{maps_.object_at(i, *p), maps_.point_at(i, *p), footprint_at(maps_, i, *p)})
                 : std::nullopt;
    }

    frame_samples<Maps::dimensions> samples_in(frame_index i) const override {
        return {maps_, i, grid_, reach_, [&](token_index token) { return representative_of(i, token); }};
    }

private:
    std::optional<pixel> representative_of(frame_index i, token_index token) const {
        auto const& of_frame = representatives_[i.value];
        auto const width = static_cast<std::uint32_t>(maps_.grid().width);
        auto const number = of_frame.numbers[token.value];
        return of_frame.is_there[token.value] ? std::optional(pixel{number / width, number % width}) : std::nullopt;
    }

    void require_finite(frame_index i) const {
        for (std::uint32_t row = 0; row < maps_.grid().height; ++row) {
            for (std::uint32_t column = 0; column < maps_.grid().width; ++column) {
                if (maps_.is_covered(i, {row, column})) {
                    require_finite_point("footprint_map", maps_.point_at(i, {row, column}));
                }
            }
        }
    }

    Maps maps_;
    grid_extents grid_;
    double reach_;
    std::vector<representative_pixels> representatives_; ///< [frames]
};

/// Maps read for feature maps of `grid`, their frames shared out over `loop`. Throws value_error if coordinates are not
/// finite.
template <canonical_maps Maps>
std::shared_ptr<sample_source<Maps::dimensions> const> read_samples(Maps const& maps, grid_extents grid, double reach,
                                                                    any_loop const& loop) {
    auto const source = std::make_shared<sample_source_of<Maps>>(maps, grid, reach);
    loop(maps.frame_count(), [&](std::size_t i) { source->read({static_cast<std::uint32_t>(i)}); });
    return source;
}

GENRENDER_INSTANCE(read_samples<canonical_maps_view<2>>);
GENRENDER_INSTANCE(read_samples<canonical_maps_view<3>>);

} // namespace genrender::detail

#include <genrender/core/end_header.inl>
