// SPDX-License-Identifier: MIT
// The fast way through a frame's kept pixels: those around a point are measured a register at a time.
#pragma once

#include <genrender/core/register_vector.hpp>
#include <genrender/correspondence/sample_bins.hpp>
#include <genrender/correspondence/sample_tree.hpp>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <optional>
#include <type_traits>
#include <vector>

namespace genrender {

/// Which kept pixel of a frame shows a point: of sample_tree's nearest few the one closest on the screen, where single
/// precision is enough to be sure of it. The rest it leaves to who asks.
template <std::size_t D>
class sample_grid {
public:
    enum class verdict : std::uint8_t { shown, not_shown, unsure };
    struct answer {
        verdict is;
        std::uint32_t number; ///< of the pixel that shows it
    };

    sample_grid() = default;

    /// The arguments are those of sample_bins.
    sample_grid(std::vector<grid_sample<D>> const& samples, double reach, double rows, double columns, double spacing)
        : bins_(samples, reach, rows, columns, spacing) {}

    /// The pixel that shows a point which was seen with a footprint.
    answer find([[maybe_unused]] std::array<float, D> const& place,
                [[maybe_unused]] surface_footprint<D> const& footprint) const {
#if defined(__GNUC__)
        auto const bin = bins_.bin_at(place);
        if (bins_.is_beyond_reach(place, bin, footprint)) {
            return {verdict::not_shown, 0};
        }
        for (std::int64_t around = 1; bin && bins_.is_precise(); around *= 2) {
            block const near(bins_, *bin, around);
            if (near.count >= enough || near.is_everything) {
                if (near.count > most || near.row_count > block::most_rows) {
                    break;
                }
                if (auto const judged = judge(near, place, footprint)) {
                    return *judged;
                }
            }
        }
#endif
        return {verdict::unsure, 0};
    }

private:
    using block = typename sample_bins<D>::block;
    using pack = sample_pack<D>;

    /// Pixels around a point to look at: most often the nearest few are among so many.
    static constexpr std::size_t enough = 20;
    static constexpr std::size_t most = 1024;
    /// How far single precision may be off: in half cells, and by how much in squares of canonical distances.
    static constexpr float tolerance = 2e-4F;
    static constexpr float square_tolerance = 1e-5F;
    static constexpr float border_tolerance = 2e-3F;

#if defined(__GNUC__)
    using floats = detail::register_vector<float>;
    using whole = detail::register_vector<std::int32_t>;
    static constexpr std::size_t lanes = detail::register_lanes<float>;

    /// The elements of a register folded into one, half onto half.
    template <std::size_t Count = lanes, class Vector, class Fold>
    static auto folded(Vector const& values, Fold const& fold) {
        using T = std::remove_cvref_t<decltype(values[0])>;
        if constexpr (Count == 2) {
            return fold(values[0], values[1]);
        } else {
            using half = detail::register_vector<T, Count / 2>;
            std::array<half, 2> halves;
            std::memcpy(halves.data(), &values, sizeof(values));
            return folded<Count / 2>(fold(halves[0], halves[1]), fold);
        }
    }

    /// None if the nearest few may lie outside of the block, which a larger one tells.
    std::optional<answer> judge(block const& near, std::array<float, D> const& place,
                                surface_footprint<D> const& footprint) const {
        constexpr auto infinity = std::numeric_limits<float>::infinity();
        auto const reach = bins_.reach();
        // Nearer than this are no pixels but those of the block.
        auto const border = bins_.border_of(near, place);
        auto const border_square = border * border * (1 - border_tolerance);

        [[maybe_unused]] std::array<float, D> normal{};
        float orientation = 0;
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

        // Once over the block: squares of the distances in canonical space and the distances on the screen.
        constexpr auto capacity = 2 * (most / lanes + block::most_rows) + 2 * pack::size;
        std::array<floats, capacity> squares;
        std::array<floats, capacity> distances;
        std::array<std::int32_t const*, capacity> numbers;
        std::size_t used = 0;
        whole lane{};
        for (std::size_t n = 0; n < lanes; ++n) {
            lane[n] = static_cast<std::int32_t>(n);
        }
        auto const far = floats{} + infinity;
        auto closest = far;
        whole inside{};
        whole doubtful{};
        for (std::size_t row = 0; row < near.row_count; ++row) {
            auto const [begin, end] = near.rows[row];
            for (auto at = begin - begin % static_cast<std::uint32_t>(lanes); at < end;
                 at += static_cast<std::uint32_t>(lanes)) {
                auto const& of = bins_.packs()[at / pack::size];
                auto const part = at % pack::size;
                auto const is_here = (lane >= static_cast<std::int32_t>(begin) - static_cast<std::int32_t>(at)) &
                                     (lane < static_cast<std::int32_t>(end - at));
                std::array<floats, D> way;
                floats square{};
                floats right{};
                floats down{};
                for (std::size_t d = 0; d < D; ++d) {
                    way[d] = detail::load_as<floats>(&of.places[d][part]) - place[d];
                    square += way[d] * way[d];
                    right += way[d] * detail::load_as<floats>(&of.measures[d][part]);
                    down += way[d] * detail::load_as<floats>(&of.measures[D + d][part]);
                }
                // Pixels without measures are no numbers.
                doubtful |= is_here & (right != right);
                right = right < 0 ? -right : right;
                down = down < 0 ? -down : down;
                auto distance = right > down ? right : down;
                if constexpr (D == 3) {
                    floats off_plane{};
                    floats facing{};
                    floats scale{};
                    for (std::size_t d = 0; d < D; ++d) {
                        auto const n = detail::load_as<floats>(&of.measures[2 * D + d][part]);
                        off_plane += way[d] * n;
                        facing += normal[d] * n;
                        scale += n * n;
                    }
                    off_plane = off_plane < 0 ? -off_plane : off_plane;
                    doubtful |= is_here & (distance <= reach + tolerance) &
                                (((off_plane > 1 - 10 * tolerance) & (off_plane < 1 + 10 * tolerance)) |
                                 (facing * facing < scale * 1e-6F));
                    distance = ((off_plane > 1) | (facing <= 0)) ? far : distance;
                } else {
                    auto const measure = [&](std::size_t which) {
                        return detail::load_as<floats>(&of.measures[which][part]);
                    };
                    auto const facing = orientation * (measure(0) * measure(3) - measure(1) * measure(2));
                    distance = facing < 0 ? far : distance;
                }
                square = is_here ? square : far;
                distance = is_here ? distance : far;
                closest = distance < closest ? distance : closest;
                inside -= square <= border_square;
                squares[used] = square;
                distances[used] = distance;
                numbers[used] = &of.numbers[part];
                ++used;
            }
        }
        auto const any = [](auto a, auto b) { return a | b; };
        auto const sum = [](auto a, auto b) { return a + b; };
        auto const least = [](auto a, auto b) { return a < b ? a : b; };
        auto const greatest = [](auto a, auto b) { return a > b ? a : b; };
        auto const nearest_few_are_here =
            near.is_everything || folded(inside, sum) >= static_cast<std::int32_t>(sample_tree<D>::visited);
        if (!nearest_few_are_here) {
            return std::nullopt;
        }
        if (folded(doubtful, any) != 0) {
            return answer{verdict::unsure, 0};
        }
        auto const best = folded(closest, least);
        if (best > reach + tolerance) {
            return answer{verdict::not_shown, 0};
        }
        if (!(best < reach - tolerance)) {
            return answer{verdict::unsure, 0};
        }

        // Again over those that are as close: there must be one alone, and it among the nearest few.
        whole lowest = whole{} + std::numeric_limits<std::int32_t>::max();
        whole highest{};
        floats nearest = far;
        for (std::size_t n = 0; n < used; ++n) {
            auto const is_close = distances[n] <= best + tolerance;
            auto const number = detail::load_as<whole>(numbers[n]);
            auto const or_greatest = is_close ? number : lowest;
            auto const or_least = is_close ? number : highest;
            lowest = or_greatest < lowest ? or_greatest : lowest;
            highest = or_least > highest ? or_least : highest;
            auto const or_far = is_close ? squares[n] : far;
            nearest = or_far < nearest ? or_far : nearest;
        }
        auto const number = folded(lowest, least);
        if (number != folded(highest, greatest)) {
            return answer{verdict::unsure, 0};
        }
        auto const radius = folded(nearest, least) * (1 + square_tolerance);
        whole nearer{};
        for (std::size_t n = 0; n < used; ++n) {
            nearer -= squares[n] <= radius;
        }
        return answer{folded(nearer, sum) <= static_cast<std::int32_t>(sample_tree<D>::visited) ? verdict::shown
                                                                                                : verdict::unsure,
                      static_cast<std::uint32_t>(number)};
    }
#endif

    sample_bins<D> bins_;
};

} // namespace genrender
