// SPDX-License-Identifier: MIT
// Every pixel lies in its bin, blocks count what is in them, and what is beyond reach is never shown.
#include <genrender/correspondence/sample_bins.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

using namespace genrender;

namespace {

/// 40 x 30 pixels of a plane, 1/40 apart.
std::vector<grid_sample<2>> pixels_of_a_plane() {
    std::vector<grid_sample<2>> samples;
    for (std::uint32_t row = 0; row < 30; ++row) {
        for (std::uint32_t column = 0; column < 40; ++column) {
            samples.push_back({{static_cast<float>(column) / 40, static_cast<float>(row) / 40},
                               surface_footprint<2>{{1.0F / 40, 0}, {0, 1.0F / 40}}});
        }
    }
    return samples;
}

} // namespace

TEST_SUITE("correspondence/sample_bins") {
    TEST_CASE("a block around a pixel holds all pixels nearer than its border") {
        auto samples = pixels_of_a_plane();
        sample_bins<2> const bins(samples, 1, 4, 4, 1);
        CHECK(bins.is_precise());
        CHECK(bins.reach() == 1);
        for (auto const& s : samples) {
            auto const bin = bins.bin_at(s.place);
            REQUIRE(bin.has_value());
            sample_bins<2>::block const near(bins, *bin, 1);
            auto const border = bins.border_of(near, s.place);
            std::vector<bool> is_held(samples.size());
            std::size_t held = 0;
            for (std::size_t row = 0; row < near.row_count; ++row) {
                for (auto at = near.rows[row].begin; at < near.rows[row].end; ++at) {
                    CHECK_FALSE(is_held[at]);
                    is_held[at] = true;
                    ++held;
                }
            }
            CHECK(held == near.count);
            for (std::size_t n = 0; n < samples.size(); ++n) {
                auto const& other = samples[n];
                if (std::hypot(other.place[0] - s.place[0], other.place[1] - s.place[1]) < border) {
                    CHECK(is_held[n]);
                }
            }
        }
    }

    TEST_CASE("samples come in the order of the packs and keep what they carry") {
        struct numbered : grid_sample<2> {
            std::size_t number = 0;
        };
        auto const before = pixels_of_a_plane();
        std::vector<numbered> samples;
        for (auto const& s : before) {
            samples.push_back({s, samples.size()});
        }
        sample_bins<2> const bins(samples, 1, 4, 4, 1);
        std::vector<bool> is_seen(before.size());
        for (std::size_t n = 0; n < samples.size(); ++n) {
            auto const& pack = bins.packs()[n / sample_pack<2>::size];
            auto const lane = n % sample_pack<2>::size;
            CHECK(samples[n].place == std::array{pack.places[0][lane], pack.places[1][lane]});
            CHECK(samples[n].place == before[samples[n].number].place);
            is_seen[samples[n].number] = true;
        }
        CHECK(std::count(is_seen.begin(), is_seen.end(), true) == 1200);
    }

    TEST_CASE("a block of everything says so") {
        auto samples = pixels_of_a_plane();
        sample_bins<2> const bins(samples, 1, 4, 4, 1);
        auto const bin = bins.bin_at(samples[0].place);
        sample_bins<2>::block const everything(bins, *bin, 1000);
        CHECK(everything.is_everything);
        CHECK(everything.count == samples.size());
        sample_bins<2>::block const near(bins, *bin, 1);
        CHECK_FALSE(near.is_everything);
        CHECK(near.count < 100);
    }

    TEST_CASE("what lies within half a cell of a pixel is not beyond reach and what lies far off is") {
        auto samples = pixels_of_a_plane();
        sample_bins<2> const bins(samples, 1, 4, 4, 1);
        surface_footprint<2> const footprint{{1.0F / 40, 0}, {0, 1.0F / 40}};
        auto const is_beyond = [&](float u, float v) {
            std::array<float, 2> const place{u, v};
            return bins.is_beyond_reach(place, bins.bin_at(place), footprint);
        };
        CHECK_FALSE(is_beyond(0.5F, 0.5F));
        CHECK_FALSE(is_beyond(-1.9F / 40, 0));
        CHECK(is_beyond(-8.0F / 40, 0));
        CHECK(is_beyond(7, 7));
        CHECK_FALSE(bins.bin_at({7, 7}).has_value());
    }

    TEST_CASE("a pixel without footprint is reached by the footprint of the point") {
        auto samples = pixels_of_a_plane();
        samples.push_back({{2, 2}, {}});
        sample_bins<2> const bins(samples, 1, 4, 4, 1);
        std::array<float, 2> const place{2.1F, 2};
        surface_footprint<2> const small{{0.01F, 0}, {0, 0.01F}};
        surface_footprint<2> const large{{0.1F, 0}, {0, 0.1F}};
        CHECK(bins.is_beyond_reach(place, bins.bin_at(place), small));
        CHECK_FALSE(bins.is_beyond_reach(place, bins.bin_at(place), large));
    }

    TEST_CASE("no pixels and pixels in one place are no trouble") {
        std::vector<grid_sample<3>> no_samples;
        sample_bins<3> const none(no_samples, 1, 4, 4, 1);
        surface_footprint<3> const footprint{{1, 0, 0}, {0, 1, 0}};
        CHECK(none.is_beyond_reach({5, 5, 5}, none.bin_at({5, 5, 5}), footprint));
        std::vector<grid_sample<3>> same(20, grid_sample<3>{{1, 1, 1}, footprint});
        sample_bins<3> const one_place(same, 1, 4, 4, 1);
        auto const bin = one_place.bin_at({1, 1, 1});
        REQUIRE(bin.has_value());
        CHECK(sample_bins<3>::block(one_place, *bin, 1).count == 20);
    }
}
