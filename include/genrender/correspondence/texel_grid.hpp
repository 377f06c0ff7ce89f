// SPDX-License-Identifier: MIT
// [GR sec. 3.2] The paper's own correspondence: tokens correspond when they meet in a texel of a T x T texture per
// object.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/index.hpp>
#include <genrender/core/parallel.hpp>
#include <genrender/correspondence/surface_sample.hpp>
#include <genrender/correspondence/visible_texels.hpp>

#include <algorithm>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <unordered_map>
#include <utility>
#include <vector>

namespace genrender {

/// Which samples of a frame a texel takes.
enum class texel_reading : std::uint8_t {
    nearest_sample, ///< the sample nearest to the texel's centre (the paper's "closest point correspondence")
    average         ///< all samples inside the texel, by their number
};

/// How texels are read.
struct texel_grid_settings {
    /// T, texels along each side of every object's texture. Too low a T merges distinct points, too high a T lets
    /// nothing meet (paper, supplement). None matches each object's T to its density in the maps: a quarter of a token,
    /// yet at least two map pixels a texel, so that samples seldom miss it.
    std::optional<std::size_t> T{};
    texel_reading reading = texel_reading::nearest_sample; ///< which samples a texel takes
    /// A texel without a sample of its own takes the nearest sample at most this many texels away on the same object.
    std::size_t dilation = 0;
};

/// A model of correspondence_map in texels. Geometry is compiled once for an animation: what each token reads, and per
/// frame which token shows each texel that any token reads. Lookups take constant time.
class texel_grid {
public:
    /// A texel that some token of the animation reads, counted from 0.
    struct point_type {
        std::uint32_t slot = 0; ///< below slot_count()
        /// Orders by slot.
        friend constexpr auto operator<=>(point_type, point_type) = default;
    };

    /// Compiles the UV maps for feature maps of `grid`. Throws value_error if the grid does not divide the maps, UVs
    /// are not finite, or T is outside [1, 2^20].
    texel_grid(uv_maps_view const& maps, grid_extents grid, texel_grid_settings const& settings = {},
               any_loop const& loop = {})
        : frames_(maps.frame_count()), grid_(grid), cell_(cell_extents("texel_grid", maps.grid(), grid)),
          resolution_(settings.T ? texture_resolution::same(*settings.T)
                                 : texture_resolution::matched(maps, grid, texels_per_token(cell_))) {
        number_slots(maps, loop);
        visible_.resize(frames_);
        loop(frames_,
             [&](std::size_t i) { visible_[i] = visible_in({static_cast<std::uint32_t>(i)}, maps, settings); });
        slots_.clear();
    }

    /// Number of frames.
    std::size_t frame_count() const { return frames_; }
    /// Height and width of the feature map.
    grid_extents grid() const { return grid_; }
    /// T of each object's texture.
    texture_resolution const& resolution() const { return resolution_; }
    /// Number of texels that some token reads; point_type::slot is below it.
    std::size_t slot_count() const { return slot_count_; }

    /// The texel that a token reads. [GR sec. 3.2]
    std::optional<point_type> point_at(frame_index frame, token_index token) const {
        auto const slot = read_[frame.value * grid_.size() + token.value];
        return slot == not_covered ? std::nullopt : std::optional(point_type{slot});
    }

    /// The token that shows a texel in a frame; with texel_reading::average the one of greatest weight.
    std::optional<token_index> token_at(frame_index frame, point_type point) const {
        auto const entries = visible_[frame.value].entries(point.slot);
        auto const best = std::max_element(entries.begin(), entries.end(),
                                           [](auto const& a, auto const& b) { return a.weight < b.weight; });
        return best == entries.end() ? std::nullopt : std::optional(best->token);
    }

    /// Every token that shows a texel in a frame, with weights that sum to 1.
    template <class Visit>
    void visit_tokens(frame_index frame, point_type point, Visit&& visit) const {
        for (auto const& entry : visible_[frame.value].entries(point.slot)) {
            visit(entry.token, entry.weight);
        }
    }

    /// Tokens of the texel that most tokens of one frame show; 1 with texel_reading::nearest_sample, where some frame
    /// shows a texel.
    std::size_t most_tokens() const {
        std::size_t most = 0;
        for (auto const& frame : visible_) {
            most = std::max(most, frame.most_entries());
        }
        return most;
    }

private:
    static constexpr std::uint32_t not_covered = 0xFFFFFFFFU;

    static double texels_per_token(grid_extents cell) {
        return std::clamp(static_cast<double>(std::min(cell.height, cell.width)) / 2, 1.0, 4.0);
    }

    /// Spreads texels over buckets; rows and columns stay below 2^20.
    struct texel_hash {
        std::size_t operator()(texel const& t) const {
            auto const place = std::uint64_t{t.row} << 20 | t.column;
            return static_cast<std::size_t>((place ^ std::uint64_t{t.object.value} << 40) * 0x9E3779B97F4A7C15U >> 8) ^
                   (t.object.value >> 24);
        }
    };

    /// Notes which texel each token reads and numbers those texels.
    void number_slots(uv_maps_view const& maps, any_loop const& loop) {
        auto const tokens = grid_.size();
        std::vector<texel> texels(frames_ * tokens);
        read_.assign(frames_ * tokens, not_covered);
        loop(frames_, [&](std::size_t i) {
            for (std::size_t t = 0; t < tokens; ++t) {
                auto const sample = representative_sample(maps, {static_cast<std::uint32_t>(i)}, grid_,
                                                          {static_cast<std::uint32_t>(t)});
                if (sample) {
                    texels[i * tokens + t] = texel_of(*sample, resolution_);
                    read_[i * tokens + t] = 0;
                }
            }
        });
        for (std::size_t entry = 0; entry < read_.size(); ++entry) {
            if (read_[entry] != not_covered) {
                read_[entry] =
                    slots_.try_emplace(texels[entry], static_cast<std::uint32_t>(slots_.size())).first->second;
            }
        }
        slot_count_ = slots_.size();
    }

    /// Finds which token of one frame shows each texel.
    visible_texels visible_in(frame_index frame, uv_maps_view const& maps, texel_grid_settings const& settings) const {
        visible_texels::builder found(slot_count_);
        auto const map = maps.grid();
        auto const reach = static_cast<std::int64_t>(settings.dilation);
        for (std::uint32_t row = 0; row < map.height; ++row) {
            for (std::uint32_t column = 0; column < map.width; ++column) {
                pixel const p{row, column};
                if (!maps.is_covered(frame, p)) {
                    continue;
                }
                surface_sample const sample{maps.object_at(frame, p), maps.point_at(frame, p), p};
                auto const own = texel_of(sample, resolution_);
                auto const T = static_cast<std::int64_t>(resolution_.of(own.object));
                token_index const token{
                    static_cast<std::uint32_t>(row / cell_.height * grid_.width + column / cell_.width)};
                for (auto down = -reach; down <= reach; ++down) {
                    for (auto right = -reach; right <= reach; ++right) {
                        auto const r = std::int64_t{own.row} + down;
                        auto const c = std::int64_t{own.column} + right;
                        if (r < 0 || c < 0 || r >= T || c >= T) {
                            continue;
                        }
                        texel const t{own.object, static_cast<std::uint32_t>(r), static_cast<std::uint32_t>(c)};
                        auto const slot = slots_.find(t);
                        if (slot != slots_.end()) {
                            auto const is_inside = down == 0 && right == 0;
                            found.offer(slot->second, token, distance_to_centre(sample, t), is_inside,
                                        settings.reading == texel_reading::average);
                        }
                    }
                }
            }
        }
        return std::move(found).finish();
    }

    /// Squared distance of a sample to a texel's centre, in texels.
    double distance_to_centre(surface_sample const& sample, texel const& t) const {
        auto const T = static_cast<double>(resolution_.of(t.object));
        auto const du = static_cast<double>(sample.uv[0]) * T - (t.column + 0.5);
        auto const dv = static_cast<double>(sample.uv[1]) * T - (t.row + 0.5);
        return du * du + dv * dv;
    }

    std::size_t frames_;
    grid_extents grid_;
    grid_extents cell_;
    texture_resolution resolution_;
    std::size_t slot_count_ = 0;
    std::vector<std::uint32_t> read_; // [frames, tokens], slot or not_covered
    std::vector<visible_texels> visible_;
    std::unordered_map<texel, std::uint32_t, texel_hash> slots_; // only while compiling
};

} // namespace genrender

#include <genrender/core/end_header.inl>
