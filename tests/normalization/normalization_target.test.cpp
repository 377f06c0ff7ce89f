// SPDX-License-Identifier: MIT
// Which frame others follow, and all frames as one.
#include <genrender/normalization/normalization_target.hpp>

#include <genrender/core/stack.hpp>
#include <genrender/testing/random_stack.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

using namespace genrender;

TEST_SUITE("normalization/normalization_target") {
    namespace {

    /// Frames of 4 x 5 pixels of which the first so many are background.
    stack<std::uint8_t, 3> background_of(std::vector<std::size_t> const& pixels) {
        stack<std::uint8_t, 3> background({pixels.size(), 4, 5});
        for (std::size_t i = 0; i < pixels.size(); ++i) {
            std::fill_n(background.data() + i * 20, pixels[i], std::uint8_t{1});
        }
        return background;
    }

    std::optional<std::size_t> target_of(std::vector<std::size_t> const& pixels, adain_target target,
                                         double enough = 0.1) {
        adain_settings<double> settings;
        settings.target = target;
        settings.enough_background = enough;
        auto const background = background_of(pixels);
        return target_frame(background.view(), settings);
    }

    } // namespace

    TEST_CASE("the first frame is the target whatever it shows") {
        CHECK(target_of({0, 20}, adain_target::first_frame) == 0);
        CHECK(!target_of({0, 20}, adain_target::all_frames));
    }
    TEST_CASE("a frame with enough background comes before the first") {
        CHECK(target_of({20, 20}, adain_target::first_with_background) == 0);
        CHECK(target_of({0, 1, 2, 20}, adain_target::first_with_background) == 2);
        CHECK(target_of({0, 1, 2, 20}, adain_target::first_with_background, 0.5) == 3);
        CHECK(target_of({0, 1, 1}, adain_target::first_with_background, 0) == 1); // two pixels at least, else the most
    }
    TEST_CASE("where none has enough the one with most is the target") {
        CHECK(target_of({3, 9, 4, 9}, adain_target::first_with_background, 1) == 1);
        CHECK(target_of({0, 0}, adain_target::first_with_background) == 0);
    }
    TEST_CASE_TEMPLATE("statistics of frames together are those of all their pixels", Real, float, double) {
        auto const z = testing::random_stack<Real, 4>({3, 2, 4, 5}, 2);
        auto const background = background_of({20, 7, 1});
        std::vector<channel_statistics<Real>> frames;
        for (std::size_t i = 0; i < 3; ++i) {
            frames.push_back(masked_statistics(z.view()[i], background.view()[i], Real{0}));
        }
        auto const all = pooled_statistics(frames, 2);
        CHECK(all.pixels == 27); // the single pixel of frame 2 is none
        for (std::size_t c = 0; c < 2; ++c) {
            double sum = 0;
            double squares = 0;
            for (std::size_t i = 0; i < 2; ++i) {
                for (std::size_t e = 0; e < (i == 0 ? 20U : 7U); ++e) {
                    auto const value = static_cast<double>(z(i, c, e / 5, e % 5));
                    sum += value;
                    squares += std::pow(value - static_cast<double>(frames[i].mean[c]), 2);
                }
            }
            CHECK(all.mean[c] == doctest::Approx(sum / 27).epsilon(1e-5));
            CHECK(all.deviation[c] == doctest::Approx(std::sqrt(squares / 25)).epsilon(1e-5));
        }
    }
    TEST_CASE("frames without pixels are of no statistics") {
        auto const none = pooled_statistics(std::vector<channel_statistics<double>>{{{3}, {1}, 1}, {{4}, {1}, 0}}, 2);
        CHECK(none.pixels == 0);
        CHECK(none.mean == std::vector<double>{0});
        CHECK(none.deviation == std::vector<double>{1});
        CHECK(pooled_statistics<double>({}, 2).pixels == 0);
    }
}
