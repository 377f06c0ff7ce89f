// SPDX-License-Identifier: MIT
// Distances of kept pixels from a surface point, with the vectors of one target.

namespace genrender::detail::GENRENDER_TARGET {

/// The pixels of a block of bins around a point in single precision: squares of the distances in canonical space, and
/// distances on the screen in half cells along the axis on which they are further; infinite where a pixel cannot show
/// the point, below 0 where single precision does not tell.
template <std::size_t D>
class sample_distances {
    using pack = sample_pack<D>;
    using floats = lanes<float>;
    using whole = lanes<std::int32_t>;
    static constexpr std::size_t width = lane_count<float>;

public:
    /// How far the screen's distances may be off.
    static constexpr float tolerance = 2e-4F;

    /// Measures a block around a point that was seen with a footprint.
    sample_distances(sample_bins<D> const& bins, typename sample_bins<D>::block const& near,
                     std::array<float, D> const& place, surface_footprint<D> const& footprint) {
        auto const border = bins.border_of(near, place);
        auto const border_square = border * border * (1 - border_tolerance);

        [[maybe_unused]] std::array<float, D> normal{};
        [[maybe_unused]] auto const near_reach = bins.reach() + tolerance;
        [[maybe_unused]] float orientation = 0;
        if constexpr (D == 3) {
            auto const exact = normal_of(footprint);
            auto const length = std::sqrt(exact[0] * exact[0] + exact[1] * exact[1] + exact[2] * exact[2]);
            for (std::size_t d = 0; d < D; ++d) {
                normal[d] = static_cast<float>(exact[d] / length);
            }
        } else {
            orientation = static_cast<float>(double{footprint.across[0]} * double{footprint.down[1]} -
                                             double{footprint.across[1]} * double{footprint.down[0]});
        }

        auto const lane = lane_numbers();
        auto const far = floats{} + infinity();
        auto const not_known = floats{} + unknown;
        whole inside{};
        for (std::size_t row = 0; row < near.row_count; ++row) {
            auto const [begin, end] = near.rows[row];
            for (auto at = begin - begin % static_cast<std::uint32_t>(width); at < end;
                 at += static_cast<std::uint32_t>(width)) {
                auto const& of = bins.packs()[at / pack::size];
                auto const part = at % pack::size;
                auto const is_here = (lane >= static_cast<std::int32_t>(begin) - static_cast<std::int32_t>(at)) &
                                     (lane < static_cast<std::int32_t>(end - at));
                floats way[D];
                floats square{};
                floats right{};
                floats down{};
                for (std::size_t d = 0; d < D; ++d) {
                    way[d] = load_as<floats>(&of.places[d][part]) - place[d];
                    square += way[d] * way[d];
                    right += way[d] * load_as<floats>(&of.measures[d][part]);
                    down += way[d] * load_as<floats>(&of.measures[D + d][part]);
                }
                // Pixels without measures are no numbers.
                auto is_doubtful = (bits_as<whole>(right) & 0x7FFFFFFF) > 0x7F800000;
                right = right < 0 ? -right : right;
                down = down < 0 ? -down : down;
                auto distance = right > down ? right : down;
                if constexpr (D == 3) {
                    floats off_plane{};
                    floats facing{};
                    floats scale{};
                    for (std::size_t d = 0; d < D; ++d) {
                        auto const n = load_as<floats>(&of.measures[2 * D + d][part]);
                        off_plane += way[d] * n;
                        facing += normal[d] * n;
                        scale += n * n;
                    }
                    off_plane = off_plane < 0 ? -off_plane : off_plane;
                    is_doubtful |= (distance <= near_reach) &
                                   (((off_plane > 1 - 10 * tolerance) & (off_plane < 1 + 10 * tolerance)) |
                                    (facing * facing < scale * 1e-6F));
                    distance = ((off_plane > 1) | (facing <= 0)) ? far : distance;
                } else {
                    auto const measure = [&](std::size_t which) GENRENDER_ALWAYS_INLINE {
                        return load_as<floats>(&of.measures[which][part]);
                    };
                    auto const facing = orientation * (measure(0) * measure(3) - measure(1) * measure(2));
                    distance = facing < 0 ? far : distance;
                }
                distance = is_doubtful ? not_known : distance;
                square = is_here ? square : far;
                inside -= square <= border_square;
                canonical_[used_] = square;
                screen_[used_] = is_here ? distance : far;
                numbers_[used_] = at;
                ++used_;
            }
        }
        count_inside_ = folded<std::int32_t>(inside, added);
    }

    /// Pixels nearer to the point in canonical space than any outside of the block.
    std::int32_t count_inside() const { return count_inside_; }

    /// Pixels whose squares of the canonical distance are at most `radius`.
    std::int32_t count_within(float radius) const {
        whole sum{};
        for (std::size_t n = 0; n < used_; ++n) {
            sum -= canonical_[n] <= radius;
        }
        return folded<std::int32_t>(sum, added);
    }

    /// The least distance on the screen of the pixels within a radius; infinite without any.
    float closest_within(float radius) const {
        auto const far = floats{} + infinity();
        auto closest = far;
        for (std::size_t n = 0; n < used_; ++n) {
            auto const distance = canonical_[n] <= radius ? screen_[n] : far;
            closest = distance < closest ? distance : closest;
        }
        return folded<float>(closest, lesser);
    }

    /// The one pixel within a radius that is at most so far on the screen, and the square of its canonical distance;
    /// none if there are several or none.
    std::optional<std::pair<std::uint32_t, float>> only_one_within(float radius, float distance) const {
        auto const far = floats{} + infinity();
        whole count{};
        whole number{};
        auto canonical = far;
        for (std::size_t n = 0; n < used_; ++n) {
            auto const is_meant = (canonical_[n] <= radius) & (screen_[n] <= distance);
            count -= is_meant;
            number |= is_meant & (lane_numbers() + static_cast<std::int32_t>(numbers_[n]));
            auto const or_far = is_meant ? canonical_[n] : far;
            canonical = or_far < canonical ? or_far : canonical;
        }
        if (folded<std::int32_t>(count, added) != 1) {
            return std::nullopt;
        }
        return std::pair(static_cast<std::uint32_t>(folded<std::int32_t>(number, joined)),
                         folded<float>(canonical, lesser));
    }

    /// The least square of a canonical distance above `radius`; infinite without one.
    float next_beyond(float radius) const {
        auto const far = floats{} + infinity();
        auto next = far;
        for (std::size_t n = 0; n < used_; ++n) {
            auto const square = canonical_[n] > radius ? canonical_[n] : far;
            next = square < next ? square : next;
        }
        return folded<float>(next, lesser);
    }

private:
    static constexpr float infinity() { return std::numeric_limits<float>::infinity(); }
    static constexpr float unknown = -1;
    static constexpr float border_tolerance = 2e-3F;
    static constexpr auto added = [](auto const& a, auto const& b) GENRENDER_ALWAYS_INLINE { return a + b; };
    static constexpr auto joined = [](auto const& a, auto const& b) GENRENDER_ALWAYS_INLINE { return a | b; };
    static constexpr auto lesser = [](auto const& a, auto const& b) GENRENDER_ALWAYS_INLINE { return a < b ? a : b; };
    static constexpr auto capacity = 2 * (most_measured / width + sample_bins<D>::block::most_rows) + 2 * pack::size;

    std::size_t used_ = 0;
    std::int32_t count_inside_ = 0;
    // Of the first `used_` registers, the others are not set.
    floats canonical_[capacity];
    floats screen_[capacity];
    std::array<std::uint32_t, capacity> numbers_; ///< of the first pixel of each register
};

} // namespace genrender::detail::GENRENDER_TARGET
