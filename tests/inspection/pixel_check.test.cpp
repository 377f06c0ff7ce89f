// SPDX-License-Identifier: MIT
// Seams, blended edges and points shown twice are told apart from surfaces that are merely steep, curved or small.
#include <genrender/inspection/pixel_check.hpp>

#include <genrender/maps/uv_maps.hpp>
#include <support/slanted_maps.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <cstddef>

TEST_SUITE("inspection/pixel_check") {
    using namespace genrender;
    using testing::changed_maps;
    using testing::slanted_maps;

    TEST_CASE("a step stays on the map") {
        CHECK(stepped({1, 2}, {-1, 1}, {4, 4}) == pixel{0, 3});
        CHECK_FALSE(stepped({0, 0}, {-1, 0}, {4, 4}));
        CHECK_FALSE(stepped({0, 3}, {0, 1}, {4, 4}));
    }

    TEST_CASE("a leap between charts is a seam and a neighbour of another object is no pair") {
        auto maps =
            changed_maps(1, [](float& u, float&, std::size_t, std::size_t column) { u += column < 32 ? 0 : 0.3F; });
        maps.object(0, 10, 21) = 1;
        auto const view = to_uv_view(maps);
        CHECK(is_seam(view, {0}, {10, 31}, {0, 1}, 0.0093) == true);
        CHECK(is_seam(view, {0}, {10, 30}, {0, 1}, 0.0093) == false);
        CHECK(is_seam(view, {0}, {10, 31}, {1, 0}, 0.0093) == false);
        CHECK_FALSE(is_seam(view, {0}, {10, 20}, {0, 1}, 0.0093));
        CHECK_FALSE(is_seam(view, {0}, {10, 59}, {0, 1}, 0.0093)); // background
    }

    TEST_CASE("steps that grow towards a horizon are no seams") {
        auto const maps = changed_maps(
            1, [](float&, float& v, std::size_t row, std::size_t) { v = 1 / static_cast<float>(70 - row); });
        auto const view = to_uv_view(maps);
        for (std::uint32_t row = 4; row < 59; ++row) {
            CHECK(is_seam(view, {0}, {row, 30}, {1, 0}, 0.0005) == false);
        }
    }

    TEST_CASE("an edge mixed with the background is blended and a sharp one is not") {
        auto const sharp = slanted_maps(1);
        auto const blended = changed_maps(1, [](float& u, float& v, std::size_t, std::size_t column) {
            u *= column == 4 ? 0.6F : 1;
            v *= column == 4 ? 0.6F : 1;
        });
        CHECK(is_blended_edge(to_uv_view(sharp), {0}, {30, 4}, 0.0093) == false);
        CHECK(is_blended_edge(to_uv_view(blended), {0}, {30, 4}, 0.0093) == true);
        CHECK_FALSE(is_blended_edge(to_uv_view(blended), {0}, {30, 5}, 0.0093)); // not on the silhouette
    }

    TEST_CASE("the rim of a ball is no blend though it turns away ever faster") {
        auto const maps = changed_maps(1, [](float& u, float&, std::size_t, std::size_t column) {
            u = std::sqrt(static_cast<float>(column - 4) + 0.02F) / 8;
        });
        CHECK(is_blended_edge(to_uv_view(maps), {0}, {30, 4}, 0.02) == false);
    }

    TEST_CASE("a point is claimed by the same side or by the mirrored one or by nobody") {
        auto const folded = changed_maps(1, [](float& u, float& v, std::size_t row, std::size_t column) {
            u = 0.13F + 0.0091F * std::abs(static_cast<float>(column) - 31.5F);
            v = 0.19F + 0.0093F * static_cast<float>(row);
        });
        auto const repeated = changed_maps(1, [](float& u, float& v, std::size_t row, std::size_t column) {
            u = 0.13F + 0.0091F * static_cast<float>(column < 32 ? column : column - 28);
            v = 0.19F + 0.0093F * static_cast<float>(row);
        });
        auto const claims = [](uv_maps const& maps, pixel p) {
            auto const view = to_uv_view(maps);
            return claims_on(view, screen_search(view, {0}), {0}, p, 0.0093);
        };
        auto const mirrored = claims(folded, {30, 10});
        REQUIRE(mirrored);
        CHECK(mirrored->mirrored);
        CHECK_FALSE(mirrored->same);
        auto const same = claims(repeated, {30, 10});
        REQUIRE(same);
        CHECK(same->same);
        CHECK_FALSE(same->mirrored);
        auto const none = claims(slanted_maps(1), {30, 10});
        REQUIRE(none);
        CHECK_FALSE(none->any());
    }

    TEST_CASE("a pixel without footprint is not asked") {
        auto const flat = changed_maps(1, [](float& u, float& v, std::size_t, std::size_t) { u = v = 0.5F; });
        auto const view = to_uv_view(flat);
        CHECK_FALSE(claims_on(view, screen_search(view, {0}), {0}, {30, 30}, 0));
    }
}
