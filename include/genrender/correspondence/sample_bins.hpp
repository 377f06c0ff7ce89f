// SPDX-License-Identifier: MIT
// A frame's kept pixels sorted into bins of canonical space, and the bins that they reach.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/correspondence/sample_pack.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

namespace genrender {

/// Bins of some six pixels each, where most pixels lie. A pixel reaches `reach` half cells of `rows` x `columns` of the
/// map's pixels, which is where it may show a point.
template <std::size_t D>
class sample_bins {
public:
    using pack = sample_pack<D>;
    using bin_type = std::array<std::int64_t, D>;

    sample_bins() = default;

    /// Of one object's kept pixels in one frame, about `spacing` of the map's pixels apart; brings them in order.
    template <std::derived_from<grid_sample<D>> Sample>
    sample_bins(std::vector<Sample>& samples, double reach, double rows, double columns, double spacing)
        : reach_(static_cast<float>(reach)), half_rows_(static_cast<float>(rows / 2)),
          half_columns_(static_cast<float>(columns / 2)) {
        lay_out(samples, spacing);
        sort(samples, rows, columns);
        mark_reached(samples, reach, rows, columns);
    }

    float reach() const { return reach_; }

    /// The pixels, in their order.
    pack const* packs() const { return packs_.data(); }

    /// The bin of a place; none outside of all bins.
    std::optional<bin_type> bin_at(std::array<float, D> const& place) const {
        bin_type bin{};
        for (std::size_t d = 0; d < D; ++d) {
            auto const at = (place[d] - low_[d]) * bins_a_unit_;
            // So written, not-a-number is outside too.
            if (!(at >= 0 && at < static_cast<float>(bins_[d]))) {
                return std::nullopt;
            }
            bin[d] = static_cast<std::int64_t>(at);
        }
        return bin;
    }

    /// Whether no pixel can show a point seen with a footprint. Never true of one that some pixel shows.
    bool is_beyond_reach(std::array<float, D> const& place, std::optional<bin_type> const& bin,
                         surface_footprint<D> const& footprint) const {
        auto const is_reached = bin ? is_reached_[number_of(*bin)] != 0 : is_within_reach(place);
        return is_precise_ && !is_reached && !is_near_lonely(place, footprint);
    }

    /// Whether single precision tells the bins' borders apart.
    bool is_precise() const { return is_precise_; }

    /// Bytes of bins of so many pixels, about: in space most bins hold none.
    static constexpr std::size_t expected_bytes(std::size_t count) {
        constexpr std::size_t of_a_bin = sizeof(std::uint32_t) + sizeof(std::uint8_t);
        return count * (sizeof(pack) / pack::size) + (D > 2 ? 12 * count : 5 * count) / 4 * of_a_bin;
    }

    /// The pixels in bins at most `around` bins away along each axis.
    struct block {
        /// Ranges of neighbouring bins that a block may have.
        static constexpr std::size_t most_rows = 64;

        block(sample_bins const& grid, bin_type const& bin, std::int64_t around) {
            is_everything = true;
            for (std::size_t d = 0; d < D; ++d) {
                auto const last_bin = static_cast<std::int64_t>(grid.bins_[d]) - 1;
                first[d] = static_cast<std::size_t>(std::max<std::int64_t>(bin[d] - around, 0));
                last[d] = static_cast<std::size_t>(std::min(bin[d] + around, last_bin));
                is_everything = is_everything && bin[d] - around <= 0 && bin[d] + around >= last_bin;
            }
            grid.for_each_row(first, last, [&](std::size_t begin, std::size_t end) {
                range const pixels{grid.begins_[begin], grid.begins_[end]};
                if (pixels.begin == pixels.end) {
                    return;
                }
                count += pixels.end - pixels.begin;
                if (row_count < most_rows) {
                    rows[row_count] = pixels;
                }
                ++row_count;
            });
        }

        /// Pixels from one to before another.
        struct range {
            std::uint32_t begin, end;
        };

        std::array<std::size_t, D> first{};
        std::array<std::size_t, D> last{};
        std::size_t count = 0;
        bool is_everything = false;
        std::size_t row_count = 0;
        std::array<range, most_rows> rows; ///< only the first row_count are set
    };

    /// How far a place lies from where there may be pixels that are not in the block.
    float border_of(block const& near, std::array<float, D> const& place) const {
        auto border = std::numeric_limits<float>::infinity();
        for (std::size_t d = 0; d < D; ++d) {
            auto const below = low_[d] + static_cast<float>(near.first[d]) * side_;
            auto const above = low_[d] + static_cast<float>(near.last[d] + 1) * side_;
            border = near.first[d] == 0 ? border : std::min(border, place[d] - below);
            border = near.last[d] + 1 == bins_[d] ? border : std::min(border, above - place[d]);
        }
        return border;
    }

private:
    /// Least side of a bin for each unit of the coordinates.
    static constexpr float least_side = 3e-4F;

    std::size_t number_of(bin_type const& bin) const {
        std::size_t number = 0;
        for (std::size_t d = D; d-- > 0;) {
            number = number * bins_[d] + static_cast<std::size_t>(bin[d]);
        }
        return number;
    }

    template <class Sample>
    void lay_out(std::vector<Sample> const& samples, double spacing) {
        std::array<float, D> high{};
        std::vector<double> sides;
        for (std::size_t n = 0; n < samples.size(); ++n) {
            auto const& s = samples[n];
            for (std::size_t d = 0; d < D; ++d) {
                low_[d] = n == 0 ? s.place[d] : std::min(low_[d], s.place[d]);
                high[d] = n == 0 ? s.place[d] : std::max(high[d], s.place[d]);
            }
            if (s.footprint) {
                sides.push_back(std::sqrt(s.footprint->area()) * spacing);
            }
        }
        // Bins of some six pixels, by the pixel in the middle; not many more bins than pixels.
        double side = 1;
        if (!sides.empty()) {
            auto const middle = sides.begin() + static_cast<std::ptrdiff_t>(sides.size() / 2);
            std::nth_element(sides.begin(), middle, sides.end());
            side = 2.5 * *middle;
        }
        for (;; side *= 1.25) {
            double bins = 1;
            for (std::size_t d = 0; d < D; ++d) {
                bins *= std::floor((double{high[d]} - double{low_[d]}) / side + 1) + 2;
            }
            if (bins <= 4 * static_cast<double>(samples.size()) + 64) {
                break;
            }
        }
        side_ = static_cast<float>(side);
        bins_a_unit_ = 1 / side_;
        std::size_t bins = 1;
        for (std::size_t d = 0; d < D; ++d) {
            // A border of one bin, for points beside the outermost pixels.
            low_[d] -= side_;
            bins_[d] = static_cast<std::size_t>((high[d] - low_[d]) / side_) + 2;
            bins *= bins_[d];
        }
        begins_.assign(bins + 1, 0);
        is_reached_.assign(bins, 0);
        for (std::size_t d = 0; d < D; ++d) {
            auto const largest = std::max(std::abs(low_[d]), std::abs(high[d]));
            is_precise_ = is_precise_ && side_ > least_side * largest;
        }
    }

    template <class Sample>
    void sort(std::vector<Sample>& samples, double rows, double columns) {
        // Every pixel lies in a bin: the bins were laid out around them.
        auto const bin_of = [&](Sample const& s) { return number_of(bin_at(s.place).value_or(bin_type{})); };
        for (auto const& s : samples) {
            ++begins_[bin_of(s) + 1];
        }
        std::partial_sum(begins_.begin(), begins_.end(), begins_.begin());
        auto next = begins_;
        std::vector<Sample> sorted(samples.size());
        packs_.resize((samples.size() + pack::size - 1) / pack::size);
        for (auto const& s : samples) {
            auto const at = next[bin_of(s)]++;
            sorted[at] = s;
            packs_[at / pack::size].set(at % pack::size, s, rows, columns);
            if (!s.footprint) {
                lonely_.push_back(s.place);
            }
        }
        samples = std::move(sorted);
    }

    /// Marks the bins that a pixel's reach touches: in others nothing is shown.
    template <class Sample>
    void mark_reached(std::vector<Sample> const& samples, double reach, double rows, double columns) {
        reached_from_.fill(std::numeric_limits<double>::infinity());
        reached_to_.fill(-std::numeric_limits<double>::infinity());
        for (auto const& s : samples) {
            if (!s.footprint) {
                continue;
            }
            std::array<std::size_t, D> first{};
            std::array<std::size_t, D> last{};
            auto const limit = D > 2 ? 0.5 * std::sqrt(s.footprint->area() * rows * columns) : 0.0;
            for (std::size_t d = 0; d < D; ++d) {
                auto const way = 1.001 * (reach * 0.5 *
                                              (columns * std::abs(double{s.footprint->across[d]}) +
                                               rows * std::abs(double{s.footprint->down[d]})) +
                                          limit) +
                                 1e-3 * double{side_};
                auto const middle = double{s.place[d]} - double{low_[d]};
                reached_from_[d] = std::min(reached_from_[d], double{s.place[d]} - way);
                reached_to_[d] = std::max(reached_to_[d], double{s.place[d]} + way);
                auto const most_bin = static_cast<double>(bins_[d] - 1);
                first[d] = static_cast<std::size_t>(std::clamp((middle - way) / double{side_}, 0.0, most_bin));
                last[d] = static_cast<std::size_t>(std::clamp((middle + way) / double{side_}, 0.0, most_bin));
            }
            for_each_row(first, last, [&](std::size_t begin, std::size_t end) {
                std::fill(is_reached_.begin() + static_cast<std::ptrdiff_t>(begin),
                          is_reached_.begin() + static_cast<std::ptrdiff_t>(end), std::uint8_t{1});
            });
        }
    }

    bool is_within_reach(std::array<float, D> const& place) const {
        for (std::size_t d = 0; d < D; ++d) {
            if (!(place[d] >= reached_from_[d] && place[d] <= reached_to_[d])) {
                return false;
            }
        }
        return true;
    }

    /// Whether a pixel without a footprint may lie within that of the point, or there are too many to tell.
    bool is_near_lonely(std::array<float, D> const& place, surface_footprint<D> const& footprint) const {
        constexpr std::size_t most_lonely = 64;
        if (lonely_.empty() || lonely_.size() > most_lonely) {
            return !lonely_.empty();
        }
        // Off the plane it may lie as far as half the side of a square as large as the cell.
        auto const off_plane =
            D == 2 ? 0.0F
                   : static_cast<float>(std::sqrt(footprint.area() * double{half_rows_} * double{half_columns_}));
        return std::any_of(lonely_.begin(), lonely_.end(), [&](std::array<float, D> const& lonely) {
            auto is_near = true;
            for (std::size_t d = 0; d < D; ++d) {
                auto const way = reach_ * (half_columns_ * std::abs(footprint.across[d]) +
                                           half_rows_ * std::abs(footprint.down[d])) +
                                 off_plane;
                is_near = is_near && std::abs(lonely[d] - place[d]) <= 1.01F * way + 1e-3F * side_;
            }
            return is_near;
        });
    }

    /// Calls `visit(begin, end)` for the bins of each row of a block, both ends of the block included.
    template <class Visit>
    void for_each_row(std::array<std::size_t, D> const& first, std::array<std::size_t, D> const& last,
                      Visit&& visit) const {
        auto const last_layer = D > 2 ? last[D - 1] : 0;
        for (auto z = D > 2 ? first[D - 1] : 0; z <= last_layer; ++z) {
            for (auto y = first[1]; y <= last[1]; ++y) {
                auto const row = (z * bins_[1] + y) * bins_[0];
                visit(row + first[0], row + last[0] + 1);
            }
        }
    }

    float reach_ = 0;
    float half_rows_ = 0;
    float half_columns_ = 0;
    float side_ = 1;
    float bins_a_unit_ = 1;
    bool is_precise_ = true;
    std::array<float, D> low_{};
    std::array<std::size_t, D> bins_{};
    std::array<double, D> reached_from_{}; ///< a box around what any pixel reaches
    std::array<double, D> reached_to_{};
    std::vector<std::uint32_t> begins_;        ///< of each bin's pixels, and the end
    std::vector<std::uint8_t> is_reached_;     ///< [bins]
    std::vector<pack> packs_;                  ///< of the pixels, bin by bin
    std::vector<std::array<float, D>> lonely_; ///< places of the pixels without footprints
};

} // namespace genrender

#include <genrender/core/end_header.inl>
