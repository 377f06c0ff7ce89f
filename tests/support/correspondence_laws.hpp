// SPDX-License-Identifier: MIT
// What every correspondence_map owes beyond its concept, as checks for models of the library and of users.
#pragma once

#include <genrender/correspondence/correspondence_map.hpp>

#include <doctest/doctest.h>

#include <cstddef>
#include <cstdint>

namespace genrender::testing {

/// Checks the laws of correspondence_map on every frame and token of `map`; returns how many tokens showed a point, so
/// that a caller can see that something was checked.
template <correspondence_map Map>
std::size_t check_correspondence_laws(Map const& map) {
    std::size_t shown = 0;
    auto const tokens = map.grid().size();
    for (std::uint32_t i = 0; i < map.frame_count(); ++i) {
        for (std::uint32_t t = 0; t < tokens; ++t) {
            auto const point = map.point_at({i}, {t});
            REQUIRE(point.has_value() == map.point_at({i}, {t}).has_value());
            if (!point) {
                continue;
            }
            ++shown;
            // A point that a frame shows is found in that frame.
            REQUIRE(map.token_at({i}, *point).has_value());
            for (std::uint32_t j = 0; j < map.frame_count(); ++j) {
                auto const token = map.token_at({j}, *point);
                REQUIRE(token == map.token_at({j}, *point));
                if (token) {
                    REQUIRE(token->value < tokens);
                }
                if constexpr (weighted_correspondence_map<Map>) {
                    double sum = 0;
                    map.visit_tokens({j}, *point, [&](token_index speaker, double weight) {
                        REQUIRE(speaker.value < tokens);
                        REQUIRE(weight > 0);
                        sum += weight;
                    });
                    REQUIRE(sum == doctest::Approx(token ? 1.0 : 0.0));
                }
            }
        }
    }
    return shown;
}

} // namespace genrender::testing
