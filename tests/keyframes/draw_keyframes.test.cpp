// SPDX-License-Identifier: MIT
// [GR alg. 1: KF] Keyframes are different frames, all alike likely, in an order that is drawn too.
#include <genrender/keyframes/draw_keyframes.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <set>
#include <vector>

using namespace genrender;

namespace {

std::vector<std::uint32_t> drawn(keyframe_settings const& settings, std::size_t frame_count, std::size_t step) {
    std::vector<std::uint32_t> values;
    for (auto const frame : draw_keyframes(settings, frame_count, step)) {
        values.push_back(frame.value);
    }
    return values;
}

bool are_different(std::vector<std::uint32_t> const& values) {
    return std::set<std::uint32_t>(values.begin(), values.end()).size() == values.size();
}

keyframe_settings uniform(std::size_t m, std::uint64_t seed = 0) { return {m, keyframe_drawing::uniform, {}, seed}; }
keyframe_settings stratified(std::size_t m, std::uint64_t seed = 0) {
    return {m, keyframe_drawing::stratified, {}, seed};
}

} // namespace

TEST_SUITE("keyframes/draw_keyframes") {
    TEST_CASE("another stream draws other frames by the same rules") {
        std::size_t same = 0;
        for (std::size_t step = 0; step < 50; ++step) {
            auto const own = draw_keyframes(uniform(5), 40, step, random_stream::consensus_sources);
            CHECK(own == draw_keyframes(uniform(5), 40, step, random_stream::consensus_sources));
            CHECK(std::set<frame_index>(own.begin(), own.end()).size() == 5);
            same += own == draw_keyframes(uniform(5), 40, step) ? 1U : 0U;
        }
        CHECK(same < 3);
    }
    TEST_CASE("[GR alg. 1] a draw is a function of seed and step") {
        for (auto const& settings : {uniform(5, 3), stratified(5, 3)}) {
            auto const later = drawn(settings, 40, 17);
            CHECK(drawn(settings, 40, 0) == drawn(settings, 40, 0));
            CHECK(drawn(settings, 40, 17) == later);
            CHECK(drawn(settings, 40, 18) != later);
        }
        CHECK(drawn(uniform(5, 3), 40, 17) != drawn(uniform(5, 4), 40, 17));
        CHECK(drawn(uniform(5, 3), 40, 17) != drawn(uniform(5, 3 + (std::uint64_t{1} << 32)), 40, 17));
    }

    TEST_CASE("[GR alg. 1] m different frames of the animation") {
        for (std::size_t step = 0; step < 300; ++step) {
            for (auto const& settings : {uniform(6), stratified(6)}) {
                auto const KF = drawn(settings, 9, step);
                CHECK(KF.size() == 6);
                CHECK(are_different(KF));
                CHECK(*std::max_element(KF.begin(), KF.end()) < 9);
            }
        }
    }

    TEST_CASE("[GR alg. 1] all frames are alike likely at every place of the order") {
        constexpr std::size_t N = 7;
        constexpr std::size_t m = 3;
        constexpr int steps = 7000;
        std::array<std::array<int, N>, m> counts{};
        for (std::size_t step = 0; step < steps; ++step) {
            auto const KF = drawn(uniform(m, 1), N, step);
            for (std::size_t k = 0; k < m; ++k) {
                ++counts.at(k).at(KF[k]);
            }
        }
        // 1000 each with deviation 29, and 3000 with deviation 41 over all places: four and a half deviations.
        for (std::size_t i = 0; i < N; ++i) {
            int everywhere = 0;
            for (std::size_t k = 0; k < m; ++k) {
                CHECK(std::abs(counts.at(k).at(i) - 1000) < 132);
                everywhere += counts.at(k).at(i);
            }
            CHECK(std::abs(everywhere - 3000) < 186);
        }
    }

    TEST_CASE("[GR alg. 1] all ordered pairs are alike likely") {
        constexpr std::size_t N = 5;
        constexpr int steps = 8000;
        std::array<int, N * N> counts{};
        for (std::size_t step = 0; step < steps; ++step) {
            auto const KF = drawn(uniform(2, 2), N, step);
            ++counts.at(KF[0] * N + KF[1]);
        }
        double chi_squared = 0;
        for (std::size_t pair = 0; pair < N * N; ++pair) {
            if (pair / N == pair % N) {
                CHECK(counts.at(pair) == 0);
            } else {
                chi_squared += (counts.at(pair) - steps / 20.0) * (counts.at(pair) - steps / 20.0) / (steps / 20.0);
            }
        }
        // 19 degrees of freedom: 43.8 is exceeded once in a thousand seeds.
        CHECK(chi_squared < 43.8);
    }

    TEST_CASE("[GR alg. 1] the order is shuffled and not that of time") {
        for (auto const& settings : {uniform(3, 5), stratified(3, 5)}) {
            std::array<int, 6> orders{};
            for (std::size_t step = 0; step < 6000; ++step) {
                auto const KF = drawn(settings, 12, step);
                auto const a = KF[0] < KF[1];
                auto const b = KF[1] < KF[2];
                auto const c = KF[0] < KF[2];
                ++orders.at(a && b ? 0 : a && c ? 1 : a ? 2 : b && c ? 3 : b ? 4 : 5);
            }
            // A sixth of the steps each, with deviation 29.
            for (auto const count : orders) {
                CHECK(std::abs(count - 1000) < 132);
            }
        }
    }

    TEST_CASE("all frames as keyframes are a permutation of all") {
        for (auto const& settings : {uniform(8), stratified(8)}) {
            auto KF = drawn(settings, 8, 3);
            std::sort(KF.begin(), KF.end());
            CHECK(KF == std::vector<std::uint32_t>{0, 1, 2, 3, 4, 5, 6, 7});
        }
        CHECK(drawn(uniform(1), 1, 9) == std::vector<std::uint32_t>{0});
        CHECK(drawn(stratified(1), 1, 9) == std::vector<std::uint32_t>{0});
    }

    TEST_CASE("stratified keyframes are one of each stretch and every frame of it is likely") {
        // 10 frames in 4 stretches: [0, 2), [2, 5), [5, 7), [7, 10).
        std::array<std::uint32_t, 5> const ends{0, 2, 5, 7, 10};
        std::array<int, 10> counts{};
        constexpr int steps = 3000;
        for (std::size_t step = 0; step < steps; ++step) {
            auto KF = drawn(stratified(4, 6), 10, step);
            std::sort(KF.begin(), KF.end());
            for (std::size_t k = 0; k < 4; ++k) {
                CHECK_UNARY(KF[k] >= ends.at(k));
                CHECK_UNARY(KF[k] < ends.at(k + 1));
                ++counts.at(KF[k]);
            }
        }
        for (std::size_t i = 0; i < 10; ++i) {
            auto const expected = (i < 2 || i == 5 || i == 6) ? steps / 2 : steps / 3;
            CHECK(std::abs(counts.at(i) - expected) < 125);
        }
    }

    TEST_CASE("steps and draws of one step are independent") {
        // The correlation of the first keyframe of a step with that of the next.
        constexpr std::size_t steps = 5000;
        double next = 0;
        for (std::size_t step = 0; step < steps; ++step) {
            auto const a = drawn(uniform(2, 8), 100, step);
            auto const b = drawn(uniform(2, 8), 100, step + 1);
            next += (a[0] - 49.5) * (b[0] - 49.5) / 833.25;
        }
        CHECK(std::abs(next / steps) < 4 / std::sqrt(static_cast<double>(steps)));
    }

    TEST_CASE("keyframes are drawn from a stream of their own") {
        // The same draws from the noise's streams would be other keyframes.
        auto const by_hand = [](random_stream stream, std::size_t step) {
            std::vector<std::uint32_t> frames{0, 1, 2, 3, 4, 5, 6, 7, 8, 9};
            for (std::uint32_t k = 0; k < 3; ++k) {
                std::swap(frames[k],
                          frames[k + uniform_below(10 - k, 77, stream, {static_cast<std::uint32_t>(step), 3 + k, 0})]);
            }
            frames.resize(3);
            return frames;
        };
        int as_noise = 0;
        for (std::size_t step = 0; step < 50; ++step) {
            CHECK(drawn(uniform(3, 77), 10, step) == by_hand(random_stream::keyframes, step));
            as_noise += drawn(uniform(3, 77), 10, step) == by_hand(random_stream::texture_noise, step) ? 1 : 0;
            as_noise += drawn(uniform(3, 77), 10, step) == by_hand(random_stream::frame_noise, step) ? 1 : 0;
        }
        CHECK(as_noise <= 2);
    }

    TEST_CASE("fixed keyframes stay in the order given") {
        keyframe_settings const settings{99, keyframe_drawing::fixed, {{4}, {0}, {2}}, 1};
        for (std::size_t step = 0; step < 5; ++step) {
            CHECK(drawn(settings, 5, step) == std::vector<std::uint32_t>{4, 0, 2});
        }
    }

    TEST_CASE("impossible requests are refused with a sentence") {
        CHECK_THROWS_WITH_AS(draw_keyframes(uniform(5), 4, 0),
                             "draw_keyframes: count is 5, expected 1 to the animation's 4 frames", value_error);
        CHECK_THROWS_WITH_AS(draw_keyframes(stratified(5), 4, 0),
                             "draw_keyframes: count is 5, expected 1 to the animation's 4 frames", value_error);
        CHECK_THROWS_WITH_AS(draw_keyframes(uniform(0), 4, 0),
                             "draw_keyframes: count is 0, expected 1 to the animation's 4 frames", value_error);
        CHECK_THROWS_WITH_AS(draw_keyframes({}, 0, 0),
                             "draw_keyframes: count is 4, expected 1 to the animation's 0 frames", value_error);
        auto const fixed = [](std::vector<frame_index> frames) {
            return keyframe_settings{4, keyframe_drawing::fixed, std::move(frames), 0};
        };
        CHECK_THROWS_WITH_AS(draw_keyframes(fixed({}), 4, 0),
                             "draw_keyframes: frames is empty, expected at least one keyframe", value_error);
        CHECK_THROWS_WITH_AS(draw_keyframes(fixed({{1}, {4}}), 4, 0),
                             "draw_keyframes: frames is 4, expected different frames below 4", value_error);
        CHECK_THROWS_WITH_AS(draw_keyframes(fixed({{1}, {3}, {1}}), 4, 0),
                             "draw_keyframes: frames is 1, expected different frames below 4", value_error);
    }
    TEST_CASE("held keyframes are those of a uniform draw's first step in every step") {
        auto held = uniform(3, 8);
        held.drawing = keyframe_drawing::held;
        for (std::size_t step = 0; step < 5; ++step) {
            CHECK(drawn(held, 10, step) == drawn(uniform(3, 8), 10, 0));
        }
        CHECK_FALSE(drawn(uniform(3, 8), 10, 1) == drawn(held, 10, 1));
        CHECK_THROWS_AS(draw_keyframes(held, 2, 0), value_error);
    }
}
