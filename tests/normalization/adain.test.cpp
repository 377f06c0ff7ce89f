// SPDX-License-Identifier: MIT
// [GR sec. 3.4] Latent normalisation: every frame's background gets the first one's statistics, and nobody gets a NaN.
#include <genrender/normalization/adain.hpp>

#include <genrender/core/index.hpp>
#include <genrender/core/stack.hpp>

#include <doctest/doctest.h>

#include <genrender/testing/random_stack.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

using namespace genrender;
using genrender::testing::random_stack;

TEST_SUITE("normalization/adain") {
    namespace {

    constexpr std::size_t frames = 4;
    constexpr std::size_t channels = 3;
    constexpr grid_extents grid{6, 8};

    using mask_stack = stack<std::uint8_t, 3>;

    constexpr auto as_the_paper = adain_statistics::mean_and_deviation;

    /// Frames of different means and deviations, and another background in each: all but a block of columns that moves.
    template <class Real>
    std::pair<stack<Real, 4>, mask_stack> world() {
        auto z = random_stack<Real, 4>({frames, channels, grid.height, grid.width}, 3);
        mask_stack background({frames, grid.height, grid.width});
        for (std::size_t i = 0; i < frames; ++i) {
            for (std::size_t row = 0; row < grid.height; ++row) {
                for (std::size_t column = 0; column < grid.width; ++column) {
                    background(i, row, column) = column < i || column >= i + 4 ? 1 : 0;
                    for (std::size_t c = 0; c < channels; ++c) {
                        auto& value = z(i, c, row, column);
                        value = static_cast<Real>(0.5 + static_cast<double>(i + c)) * value + static_cast<Real>(3 * i) -
                                static_cast<Real>(c);
                    }
                }
            }
        }
        return {std::move(z), std::move(background)};
    }

    template <class Real>
    channel_statistics<Real> background_of(stack<Real, 4> const& z, mask_stack const& background, std::size_t i) {
        return masked_statistics(z.view()[i], background.view()[i], Real{0});
    }

    template <class Real>
    double largest_difference(stack<Real, 4> const& a, stack<Real, 4> const& b) {
        double largest = 0;
        for (std::size_t e = 0; e < a.size(); ++e) {
            auto const difference = std::abs(static_cast<double>(a.data()[e]) - static_cast<double>(b.data()[e]));
            // A NaN must not pass as small.
            largest = std::isnan(difference) ? std::numeric_limits<double>::infinity() : std::max(largest, difference);
        }
        return largest;
    }

    template <class Real>
    bool frame_is_equal(stack<Real, 4> const& a, stack<Real, 4> const& b, std::size_t i) {
        auto const size = a.size() / a.extent(0);
        return std::equal(a.data() + i * size, a.data() + (i + 1) * size, b.data() + i * size);
    }

    template <class Real>
    bool is_finite(stack<Real, 4> const& z) {
        return std::all_of(z.data(), z.data() + z.size(), [](Real value) { return std::isfinite(value); });
    }

    void fill(mask_stack& background, std::size_t i, std::uint8_t value) {
        std::fill(background.data() + i * grid.size(), background.data() + (i + 1) * grid.size(), value);
    }

    } // namespace

    TEST_CASE_TEMPLATE("[GR sec. 3.4] AdaIN by hand", Real, float, double) {
        stack<Real, 3> z({2, 1, 2});
        z(0, 0, 0) = 1;
        z(0, 0, 1) = 5;
        z(1, 0, 0) = -2;
        z(1, 0, 1) = 0;
        // Channel 0: (z - 3) / 2 * 4 + 10. Channel 1: (z + 1) / 1 * 0.5 - 7.
        adain(z.view(), {{3, -1}, {2, 1}, 9}, {{10, -7}, {4, Real(0.5)}, 9});
        CHECK(z(0, 0, 0) == 6);
        CHECK(z(0, 0, 1) == 14);
        CHECK(z(1, 0, 0) == Real(-7.5));
        CHECK(z(1, 0, 1) == Real(-6.5));
    }

    TEST_CASE("[GR sec. 3.4] AdaIN there and back is where it began") {
        auto z = random_stack<double, 3>({2, 4, 4}, 5);
        auto const before = z;
        channel_statistics<double> const a{{3, -1}, {2, 1}, 9};
        channel_statistics<double> const b{{10, -7}, {4, 0.5}, 9};
        adain(z.view(), a, b);
        adain(z.view(), b, a);
        for (std::size_t e = 0; e < z.size(); ++e) {
            CHECK(z.data()[e] == doctest::Approx(before.data()[e]).epsilon(1e-12));
        }
    }

    TEST_CASE_TEMPLATE("[GR sec. 3.4] every background ends with the statistics of the first", Real, float, double) {
        auto [z, background] = world<Real>();
        auto const first = background_of(z, background, 0);
        CHECK(normalize_latents(z.view(), std::as_const(background).view(), {.statistics = as_the_paper}).empty());
        for (std::size_t i = 0; i < frames; ++i) {
            auto const own = background_of(z, background, i);
            for (std::size_t c = 0; c < channels; ++c) {
                CHECK(own.mean[c] == doctest::Approx(static_cast<double>(first.mean[c])).epsilon(1e-5));
                // 1e-5 is added to both variances, which are 0.25 and more.
                CHECK(own.deviation[c] == doctest::Approx(static_cast<double>(first.deviation[c])).epsilon(5e-5));
            }
        }
    }

    TEST_CASE_TEMPLATE("means alone shift a frame and scale nothing", Real, float, double) {
        auto [z, background] = world<Real>();
        auto const before = z;
        auto const first = background_of(z, background, 0);
        adain_settings<Real> settings;
        settings.statistics = adain_statistics::mean;
        CHECK(normalize_latents(z.view(), std::as_const(background).view(), settings).empty());
        for (std::size_t i = 0; i < frames; ++i) {
            auto const own = background_of(z, background, i);
            auto const was = background_of(before, background, i);
            for (std::size_t c = 0; c < channels; ++c) {
                CHECK(own.mean[c] == doctest::Approx(static_cast<double>(first.mean[c])).epsilon(1e-5));
                CHECK(own.deviation[c] == doctest::Approx(static_cast<double>(was.deviation[c])).epsilon(1e-5));
                auto const shift = static_cast<double>(first.mean[c] - was.mean[c]);
                CHECK(z(i, c, std::size_t{2}, std::size_t{5}) ==
                      doctest::Approx(static_cast<double>(before(i, c, std::size_t{2}, std::size_t{5})) + shift)
                          .epsilon(1e-5));
            }
        }
    }

    TEST_CASE_TEMPLATE("[GR sec. 3.4] the first frame stays as it is to the bit", Real, float, double) {
        auto [z, background] = world<Real>();
        auto const before = z;
        normalize_latents(z.view(), std::as_const(background).view(), {.statistics = as_the_paper});
        CHECK(frame_is_equal(z, before, 0));
        CHECK_FALSE(frame_is_equal(z, before, 1));
    }

    TEST_CASE_TEMPLATE("[GR sec. 3.4] normalising twice is normalising once", Real, float, double) {
        auto [z, background] = world<Real>();
        normalize_latents(z.view(), std::as_const(background).view(), {.statistics = as_the_paper});
        auto const once = z;
        normalize_latents(z.view(), std::as_const(background).view(), {.statistics = as_the_paper});
        // But for the 1e-5 in the variances.
        CHECK(largest_difference(z, once) < 2e-4);
    }

    TEST_CASE("[GR sec. 3.4] all pixels of a frame are rescaled and its objects too") {
        auto [z, background] = world<double>();
        auto const before = z;
        normalize_latents(z.view(), std::as_const(background).view(), {.statistics = as_the_paper});
        for (std::size_t i = 1; i < frames; ++i) {
            auto const own = masked_statistics(before.view()[i], std::as_const(background).view()[i]);
            auto const first = masked_statistics(before.view()[0], std::as_const(background).view()[0]);
            for (std::size_t c = 0; c < channels; ++c) {
                // Column i + 1 is the object's.
                CHECK(z(i, c, 2, i + 1) ==
                      doctest::Approx((before(i, c, 2, i + 1) - own.mean[c]) / own.deviation[c] * first.deviation[c] +
                                      first.mean[c]));
            }
        }
    }

    TEST_CASE("[GR sec. 3.4] each frame is measured by its own mask") {
        auto [z, background] = world<double>();
        auto const before = z;
        // What the objects hide does not count: another value there changes nothing on the background.
        auto disturbed = z;
        for (std::size_t i = 0; i < frames; ++i) {
            for (std::size_t c = 0; c < channels; ++c) {
                disturbed(i, c, 2, i + 1) += 1000;
            }
        }
        normalize_latents(z.view(), std::as_const(background).view(), {.statistics = as_the_paper});
        normalize_latents(disturbed.view(), std::as_const(background).view(), {.statistics = as_the_paper});
        for (std::size_t i = 0; i < frames; ++i) {
            CHECK(disturbed(i, 0, 1, 7) == z(i, 0, 1, 7));
        }
        // With the mask of frame 0 for all, frame 3 would be measured elsewhere.
        auto with_one_mask = before;
        auto one_mask = background;
        for (std::size_t i = 1; i < frames; ++i) {
            std::copy(background.data(), background.data() + grid.size(), one_mask.data() + i * grid.size());
        }
        normalize_latents(with_one_mask.view(), std::as_const(one_mask).view(), {.statistics = as_the_paper});
        CHECK(std::abs(with_one_mask(3, 0, 1, 7) - z(3, 0, 1, 7)) > 1e-3);
    }

    TEST_CASE_TEMPLATE("a frame without background is skipped and reported and no NaN appears", Real, float, double) {
        auto [z, background] = world<Real>();
        fill(background, 2, 0);
        auto const before = z;
        auto const skipped =
            normalize_latents(z.view(), std::as_const(background).view(), {.statistics = as_the_paper});
        CHECK(skipped == std::vector<std::size_t>{2});
        CHECK(frame_is_equal(z, before, 2));
        CHECK_FALSE(frame_is_equal(z, before, 1));
        CHECK_FALSE(frame_is_equal(z, before, 3));
        CHECK(is_finite(z));
    }

    TEST_CASE("without background in the first frame all are skipped and reported") {
        auto [z, background] = world<float>();
        fill(background, 0, 0);
        auto const before = z;
        CHECK(normalize_latents(z.view(), std::as_const(background).view(), {.statistics = as_the_paper}) ==
              std::vector<std::size_t>{0, 1, 2, 3});
        CHECK(largest_difference(z, before) == 0);
    }

    TEST_CASE("one background pixel is none") {
        auto [z, background] = world<float>();
        fill(background, 1, 0);
        background(1, 3, 3) = 1;
        auto const before = z;
        CHECK(normalize_latents(z.view(), std::as_const(background).view(), {.statistics = as_the_paper}) ==
              std::vector<std::size_t>{1});
        CHECK(frame_is_equal(z, before, 1));
        // Even where the settings ask for less.
        adain_settings<float> settings;
        settings.statistics = as_the_paper;
        settings.least_pixels = 0;
        CHECK(normalize_latents(z.view(), std::as_const(background).view(), settings) == std::vector<std::size_t>{1});
        background(1, 3, 4) = 1;
        CHECK(normalize_latents(z.view(), std::as_const(background).view(), settings).empty());
        CHECK(is_finite(z));
    }

    TEST_CASE("least_pixels counts the background of the frame and of the first") {
        auto [z, background] = world<double>();
        adain_settings<double> settings;
        settings.statistics = as_the_paper;
        settings.least_pixels = 24;
        CHECK(normalize_latents(z.view(), std::as_const(background).view(), settings).empty());
        background(2, 0, 0) = 0;
        CHECK(normalize_latents(z.view(), std::as_const(background).view(), settings) == std::vector<std::size_t>{2});
        background(0, 0, 7) = 0;
        CHECK(normalize_latents(z.view(), std::as_const(background).view(), settings) ==
              std::vector<std::size_t>{0, 1, 2, 3});
    }

    TEST_CASE_TEMPLATE("the statistics of all pixels stand in where the settings say so", Real, float, double) {
        auto [z, background] = world<Real>();
        fill(background, 2, 0);
        adain_settings<Real> settings;
        settings.statistics = as_the_paper;
        settings.fallback = without_background::all_pixels;
        mask_stack everywhere({frames, grid.height, grid.width});
        std::fill(everywhere.data(), everywhere.data() + everywhere.size(), std::uint8_t{1});
        auto const first_everywhere = background_of(z, everywhere, 0);
        auto const first = background_of(z, background, 0);
        CHECK(normalize_latents(z.view(), std::as_const(background).view(), settings).empty());
        auto const fallen_back = background_of(z, everywhere, 2);
        auto const usual = background_of(z, background, 1);
        for (std::size_t c = 0; c < channels; ++c) {
            CHECK(fallen_back.mean[c] == doctest::Approx(static_cast<double>(first_everywhere.mean[c])).epsilon(1e-5));
            CHECK(fallen_back.deviation[c] ==
                  doctest::Approx(static_cast<double>(first_everywhere.deviation[c])).epsilon(5e-5));
            CHECK(usual.mean[c] == doctest::Approx(static_cast<double>(first.mean[c])).epsilon(1e-5));
        }
    }

    TEST_CASE("without background in the first frame the fallback takes all pixels of every frame") {
        auto [z, background] = world<double>();
        auto everywhere = background;
        std::fill(everywhere.data(), everywhere.data() + everywhere.size(), std::uint8_t{1});
        auto expected = z;
        normalize_latents(expected.view(), std::as_const(everywhere).view(), {.statistics = as_the_paper});
        fill(background, 0, 0);
        adain_settings<double> settings;
        settings.statistics = as_the_paper;
        settings.fallback = without_background::all_pixels;
        CHECK(normalize_latents(z.view(), std::as_const(background).view(), settings).empty());
        CHECK(largest_difference(z, expected) == 0);
    }

    TEST_CASE_TEMPLATE("a constant background moves to the first one's mean and makes no NaN", Real, float, double) {
        auto [z, background] = world<Real>();
        for (std::size_t row = 0; row < grid.height; ++row) {
            for (std::size_t column = 0; column < grid.width; ++column) {
                if (background(1, row, column) != 0) {
                    z(1, 0, row, column) = Real(-12.3);
                }
            }
        }
        auto const first = background_of(z, background, 0);
        auto const before = z;
        CHECK(normalize_latents(z.view(), std::as_const(background).view(), {.statistics = as_the_paper}).empty());
        CHECK(is_finite(z));
        CHECK(z(1, 0, 5, 7) == doctest::Approx(static_cast<double>(first.mean[0])).epsilon(2e-5));
        CHECK(z(1, 0, 5, 7) == z(1, 0, 0, 0));
        // The object of that frame is rescaled by the whole ratio of deviations, against the root of 1e-5.
        auto const gain = (z(1, 0, 2, 2) - z(1, 0, 2, 3)) / (before(1, 0, 2, 2) - before(1, 0, 2, 3));
        CHECK(gain == doctest::Approx(static_cast<double>(first.deviation[0]) / std::sqrt(1e-5)).epsilon(1e-3));
    }

    TEST_CASE("a constant first background flattens the others and makes no NaN") {
        auto [z, background] = world<double>();
        for (std::size_t e = 0; e < channels * grid.size(); ++e) {
            z.data()[e] = 2;
        }
        normalize_latents(z.view(), std::as_const(background).view(), {.statistics = as_the_paper});
        CHECK(is_finite(z));
        auto const own = background_of(z, background, 3);
        CHECK(own.mean[1] == doctest::Approx(2));
        CHECK(own.deviation[1] == doctest::Approx(std::sqrt(1e-5)).epsilon(1e-3));
    }

    TEST_CASE("latents of one pixel are skipped or left alone") {
        stack<float, 4> z({2, 3, 1, 1});
        z(1, 0, 0, 0) = 5;
        mask_stack background({2, 1, 1});
        background(0, 0, 0) = background(1, 0, 0) = 1;
        CHECK(normalize_latents(z.view(), std::as_const(background).view(), {.statistics = as_the_paper}) ==
              std::vector<std::size_t>{0, 1});
        adain_settings<float> settings;
        settings.statistics = as_the_paper;
        settings.fallback = without_background::all_pixels;
        normalize_latents(z.view(), std::as_const(background).view(), settings);
        CHECK(z(1, 0, 0, 0) == 5);
    }

    TEST_CASE("frames that are equal to the first stay as they are") {
        auto [z, background] = world<double>();
        std::copy(z.data(), z.data() + z.size() / frames, z.data() + z.size() / frames);
        std::copy(background.data(), background.data() + grid.size(), background.data() + grid.size());
        auto const before = z;
        normalize_latents(z.view(), std::as_const(background).view(), {.statistics = as_the_paper});
        auto const size = z.size() / frames;
        for (std::size_t e = size; e < 2 * size; ++e) {
            CHECK(z.data()[e] == doctest::Approx(before.data()[e]).epsilon(1e-12));
        }
    }

    TEST_CASE_TEMPLATE("with all frames as the target every mean becomes that of all backgrounds", Real, float,
                       double) {
        auto [z, background] = world<Real>();
        adain_settings<Real> settings;
        settings.target = adain_target::all_frames;
        std::vector<double> expected(channels);
        double pixels = 0;
        for (std::size_t i = 0; i < frames; ++i) {
            auto const own = background_of(z, background, i);
            pixels += static_cast<double>(own.pixels);
            for (std::size_t c = 0; c < channels; ++c) {
                expected[c] += static_cast<double>(own.pixels) * static_cast<double>(own.mean[c]);
            }
        }
        auto const before = z;
        CHECK(normalize_latents(z.view(), std::as_const(background).view(), settings).empty());
        CHECK(!frame_is_equal(z, before, 0));
        for (std::size_t i = 0; i < frames; ++i) {
            auto const own = background_of(z, background, i);
            for (std::size_t c = 0; c < channels; ++c) {
                CHECK(own.mean[c] == doctest::Approx(expected[c] / pixels).epsilon(1e-5));
            }
        }
    }

    TEST_CASE("a first frame without background is none where the target is the first that has enough") {
        auto [z, background] = world<double>();
        fill(background, 0, 0);
        auto const before = z;
        auto const target = background_of(z, background, 1);
        adain_settings<double> settings;
        settings.target = adain_target::first_with_background;
        CHECK(normalize_latents(z.view(), std::as_const(background).view(), settings) == std::vector<std::size_t>{0});
        CHECK(frame_is_equal(z, before, 0));
        CHECK(frame_is_equal(z, before, 1));
        for (std::size_t c = 0; c < channels; ++c) {
            CHECK(background_of(z, background, 3).mean[c] == doctest::Approx(target.mean[c]));
        }
    }

    TEST_CASE("with all frames as the target all pixels of all frames stand in for a missing background") {
        auto [z, background] = world<double>();
        auto everywhere = background;
        std::fill(everywhere.data(), everywhere.data() + everywhere.size(), std::uint8_t{1});
        adain_settings<double> settings;
        settings.target = adain_target::all_frames;
        auto expected = z;
        normalize_latents(expected.view(), std::as_const(everywhere).view(), settings);
        auto without = z;
        fill(background, 2, 0);
        CHECK(normalize_latents(without.view(), std::as_const(background).view(), settings) ==
              std::vector<std::size_t>{2});
        CHECK(frame_is_equal(without, z, 2));
        settings.fallback = without_background::all_pixels;
        CHECK(normalize_latents(z.view(), std::as_const(background).view(), settings).empty());
        CHECK(frame_is_equal(z, expected, 2));
        CHECK(frame_is_equal(z, without, 1));
    }

    TEST_CASE_TEMPLATE("deviations are made alike as far as their pixels support them", Real, float, double) {
        auto [z, background] = world<Real>();
        auto const before = z;
        adain_settings<Real> settings;
        settings.statistics = adain_statistics::mean_and_supported_deviation;
        settings.most_gain = 3;
        CHECK(normalize_latents(z.view(), std::as_const(background).view(), settings).empty());
        auto const first = background_of(before, background, 0);
        bool is_scaled = false;
        for (std::size_t i = 1; i < frames; ++i) {
            auto const was = background_of(before, background, i);
            auto const own = background_of(z, background, i);
            for (std::size_t c = 0; c < channels; ++c) {
                auto const gain = static_cast<double>(supported_gain(was.deviation[c], was.pixels, first.deviation[c],
                                                                     first.pixels, settings.standard_errors, Real(3)));
                is_scaled = is_scaled || std::abs(std::log(gain)) > 0.1;
                CHECK(own.mean[c] == doctest::Approx(static_cast<double>(first.mean[c])).epsilon(1e-5));
                CHECK(own.deviation[c] == doctest::Approx(gain * static_cast<double>(was.deviation[c])).epsilon(1e-4));
            }
        }
        CHECK(is_scaled);
    }

    TEST_CASE("low bands are chosen by the statistics") {
        auto [z, background] = world<double>();
        auto expected = z;
        adain_settings<double> settings;
        settings.statistics = adain_statistics::low_band;
        auto const skipped = normalize_low_bands(expected.view(), std::as_const(background).view(), settings);
        CHECK(normalize_latents(z.view(), std::as_const(background).view(), settings) == skipped);
        CHECK(largest_difference(z, expected) == 0);
    }

    TEST_CASE("a ball that enters after two empty frames is not burnt but by the paper's literal form") {
        // The network was told of nothing in the empty frames and filled them with what it liked, dark and full of
        // contrast; then there is a ball on a flat sky.
        constexpr std::size_t side = 16;
        stack<double, 4> z({4, 1, side, side});
        mask_stack background({4, side, side});
        auto const noise = random_stack<double, 4>({4, 1, side, side}, 9);
        for (std::size_t e = 0; e < z.size(); ++e) {
            auto const i = e / (side * side);
            auto const row = static_cast<double>(e / side % side) - 7.5;
            auto const column = static_cast<double>(e % side) - 7.5;
            auto const is_ball = i >= 2 && row * row + column * column < 30;
            background.data()[e] = is_ball ? 0 : 1;
            z.data()[e] = i < 2 ? -0.3 + 0.8 * noise.data()[e] : is_ball ? -0.2 + 0.3 * noise.data()[e] : 0.6;
        }
        // How far the ball's darkest value falls, and how much its contrast grows.
        auto const of_ball = [&](stack<double, 4> const& latents) {
            double least = 0;
            double most = -1e9;
            for (std::size_t e = 2 * side * side; e < z.size(); ++e) {
                if (background.data()[e] == 0) {
                    least = std::min(least, latents.data()[e]);
                    most = std::max(most, latents.data()[e]);
                }
            }
            return std::pair(least, most - least);
        };
        auto const before = of_ball(z); // darkest value, contrast
        auto const after = [&](adain_settings<double> const& settings) {
            auto changed = z;
            CHECK(normalize_latents(changed.view(), std::as_const(background).view(), settings).empty());
            auto const [dark, apart] = of_ball(changed);
            return std::pair(before.first - dark, apart / before.second);
        };
        auto const burnt = after({.statistics = as_the_paper});
        CHECK(burnt.first > 100);
        CHECK(burnt.second > 100);
        for (auto const target :
             {adain_target::first_frame, adain_target::all_frames, adain_target::first_with_background}) {
            adain_settings<double> settings;
            settings.target = target;
            auto const means = after(settings);
            CHECK(means.first < 1.0); // no more than the sky's own shift, 0.9
            CHECK(means.second == doctest::Approx(1));
            settings.statistics = adain_statistics::mean_and_supported_deviation;
            auto const supported = after(settings);
            CHECK(supported.second <= 1.1 + 1e-9);
            CHECK(supported.first < 1.2);
            settings.statistics = adain_statistics::low_band;
            auto const bands = after(settings);
            CHECK(bands.first < 1.5);
            CHECK(bands.second < 1.5);
        }
    }

    TEST_CASE("no frame and one frame are no work") {
        stack<float, 4> none({0, 3, 6, 8});
        mask_stack const no_mask({0, 6, 8});
        CHECK(normalize_latents(none.view(), no_mask.view(), {.statistics = as_the_paper}).empty());
        auto one = random_stack<float, 4>({1, 2, 3, 3}, 1);
        auto const before = one;
        mask_stack mask({1, 3, 3});
        std::fill(mask.data(), mask.data() + 9, std::uint8_t{1});
        CHECK(normalize_latents(one.view(), std::as_const(mask).view(), {.statistics = as_the_paper}).empty());
        CHECK(largest_difference(one, before) == 0);
    }

    TEST_CASE("shapes that do not fit are refused with a sentence") {
        stack<float, 4> z({2, 3, 4, 5});
        mask_stack const background({2, 5, 4});
        CHECK_THROWS_WITH_AS(normalize_latents(z.view(), background.view(), {.statistics = as_the_paper}),
                             "normalize_latents: background is [2, 5, 4], expected [2, 4, 5]", shape_error);
        channel_statistics<float> const three{{0, 0, 0}, {1, 1, 1}, 2};
        channel_statistics<float> const two{{0, 0}, {1, 1}, 2};
        CHECK_THROWS_WITH_AS(adain(z.view()[0], two, three), "adain: from is [2], expected [3]", shape_error);
        CHECK_THROWS_WITH_AS(adain(z.view()[0], three, two), "adain: to is [2], expected [3]", shape_error);
    }
}
