// SPDX-License-Identifier: MIT
// The consensus of an animation against a plain second writing, and what it leaves alone.
#include <genrender/pipeline/estimate_consensus.hpp>

#include "../support/plain_consensus.hpp"
#include "../support/shifted_strip.hpp"

#include <genrender/testing/analytic_denoiser.hpp>
#include <genrender/testing/random_stack.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

using namespace genrender;

TEST_SUITE("pipeline/estimate_consensus") {
    namespace {

    using phi_type = testing::analytic_denoiser<double>;
    constexpr std::size_t frames = 9;
    constexpr std::size_t channels = 2;
    constexpr std::size_t width = 4;

    /// A strip that later frames see better.
    struct graded_strip : testing::shifted_strip {
        double quality_at(frame_index k, point_type) const { return 1.0 + k.value; }
    };
    /// A strip of which frames see nothing.
    struct unseen_strip : testing::shifted_strip {
        std::optional<point_type> point_at(frame_index, token_index) const { return std::nullopt; }
    };

    /// Nine frames of four cells on a strip that moves one cell a frame: a cell is seen by four frames.
    template <class Map = testing::shifted_strip>
    struct frames_of {
        phi_type phi{.grid = {1, width}, .channels = channels};
        render_settings<double> settings;
        correspondence_set<Map> maps;
        progress_meter meter{10, 1000, {}};
        render_report report;
        report_writer writer{report};
        stack<double, 4> before = testing::random_stack<double, 4>({frames, channels, 1, width}, 11);

        frames_of() {
            settings.steps = 10;
            settings.consensus.enabled = true;
            maps.add_unlisted({1, width}, [](grid_extents) {
                Map map;
                map.frames = frames;
                map.width = width;
                return map;
            });
        }

        stack<double, 4> after(std::size_t step, any_loop const& loop = {}, latent_cells const& cells = {}) {
            auto x0 = before;
            sequence_run<phi_type, Map> const run{&phi, &maps, &settings, loop, &meter, &writer};
            reach_consensus(run, x0.view(), cells, step);
            return x0;
        }

        /// The same plainly, all cells of a frame at `strength`, sources weighed by `weight_of`.
        std::vector<double> plain(std::vector<frame_index> const& sources, std::size_t i, std::size_t c,
                                  std::vector<double> const& strength,
                                  std::function<double(frame_index)> const& weight_of) const {
            std::vector<double> own;
            std::vector<testing::weighted_values> lists(width);
            for (std::size_t t = 0; t < width; ++t) {
                own.push_back(before(i, c, 0, t));
                for (auto const k : sources) {
                    if (i + t >= k.value && i + t < k.value + width) {
                        lists[t].emplace_back(before(k.value, c, 0, i + t - k.value), weight_of(k));
                    }
                }
                double sum = 0;
                for (auto const& [value, weight] : lists[t]) {
                    sum += weight;
                }
                for (auto& [value, weight] : lists[t]) {
                    weight /= sum;
                }
            }
            auto const is_covered = std::any_of(lists.begin(), lists.end(), [](auto const& l) { return !l.empty(); });
            return is_covered ? testing::plain_consensus(own, lists, strength, settings.consensus.most_gain) : own;
        }

        double difference_from_plain(
            stack<double, 4> const& x0, std::vector<frame_index> const& sources, std::vector<double> const& strength,
            std::function<double(frame_index)> const& weight_of = [](frame_index) { return 1.0; }) const {
            double worst = 0;
            for (std::size_t i = 0; i < frames; ++i) {
                for (std::size_t c = 0; c < channels; ++c) {
                    auto const expected = plain(sources, i, c, strength, weight_of);
                    for (std::size_t t = 0; t < width; ++t) {
                        worst = std::max(worst, std::abs(x0(i, c, 0, t) - expected[t]));
                    }
                }
            }
            return worst;
        }

        bool is_unchanged(stack<double, 4> const& x0) const {
            return std::equal(x0.data(), x0.data() + x0.size(), before.data());
        }
    };

    using strip_of_frames = frames_of<>;

    } // namespace

    TEST_CASE("over all frames or over a few it equals the plainly written consensus") {
        for (auto const count : {std::size_t{1}, std::size_t{3}, std::numeric_limits<std::size_t>::max()}) {
            strip_of_frames world;
            world.settings.consensus.sources.count = count;
            auto const sources = consensus_sources(world.settings, frames, 2);
            CHECK(sources.size() == std::min(count, frames));
            auto const x0 = world.after(2);
            auto const difference = world.difference_from_plain(x0, sources, std::vector<double>(width, 1.0));
            MESSAGE(sources.size(), " sources: greatest difference ", difference);
            CHECK(difference <= 1e-12);
            CHECK(!world.is_unchanged(x0));
        }
    }
    TEST_CASE("a frame of which no source shows anything keeps its own estimate") {
        strip_of_frames world;
        world.settings.consensus.sources = {.count = 1, .drawing = keyframe_drawing::fixed, .frames = {{0}}, .seed = 0};
        auto const x0 = world.after(0);
        for (std::size_t t = 0; t < width; ++t) {
            CHECK(x0(4, 0, 0, t) == world.before(4, 0, 0, t));
        }
        CHECK(x0(3, 0, 0, 0) == doctest::Approx(world.before(0, 0, 0, 3)));
        CHECK(x0(3, 0, 0, 1) == world.before(3, 0, 0, 1));
    }
    TEST_CASE("without a gain frames that see a point agree on it whichever frames are its sources") {
        for (auto const count : {4, 100}) {
            strip_of_frames world;
            world.settings.consensus.sources.count = static_cast<std::size_t>(count);
            world.settings.consensus.most_gain = 1;
            auto const sources = consensus_sources(world.settings, frames, 0);
            auto const x0 = world.after(0);
            std::size_t compared = 0;
            for (std::size_t i = 0; i + 1 < frames; ++i) {
                for (std::size_t t = 1; t < width; ++t) {
                    auto const is_covered = std::any_of(sources.begin(), sources.end(), [&](frame_index k) {
                        return i + t >= k.value && i + t < k.value + width;
                    });
                    if (is_covered) {
                        CHECK(x0(i, 1, 0, t) == doctest::Approx(x0(i + 1, 1, 0, t - 1)).epsilon(1e-12));
                        ++compared;
                    }
                }
            }
            CHECK(compared > 10);
        }
    }
    TEST_CASE("it runs in its window with the strength of the step") {
        strip_of_frames world;
        world.settings.consensus.window_begin = 0.2;
        world.settings.consensus.window_end = 0.6;
        world.settings.consensus.strength = [](std::size_t step) { return step == 4 ? 0.0 : step == 3 ? 0.25 : 1.0; };
        for (std::size_t const step : {0U, 1U, 4U, 6U, 9U}) {
            CHECK(!has_surface_consensus(world.settings, step));
            CHECK(world.is_unchanged(world.after(step)));
        }
        CHECK(has_surface_consensus(world.settings, 2));
        CHECK(has_consensus(world.settings, 9)); // of the background
        world.settings.consensus.agrees_on_background = false;
        CHECK(has_consensus(world.settings, 2));
        CHECK(!has_consensus(world.settings, 9));
        CHECK(consensus_sources(world.settings, frames, 9).empty());
        CHECK(uses_consensus(world.settings));
        CHECK(world.difference_from_plain(world.after(3), consensus_sources(world.settings, frames, 3),
                                          std::vector<double>(width, 0.25)) <= 1e-12);
        world.settings.consensus.enabled = false;
        CHECK(!uses_consensus(world.settings));
        CHECK(world.is_unchanged(world.after(2)));
    }
    TEST_CASE("a cell that shows its object partly moves by that share unless settings say otherwise") {
        strip_of_frames world;
        std::vector<std::uint8_t> const share{255, 51, 255, 204};
        strided_view<std::uint8_t const, 3> const shares(share.data(), {frames, 1, width}, {0, 0, 1});
        auto const sources = consensus_sources(world.settings, frames, 0);
        CHECK(world.difference_from_plain(world.after(0, {}, {.shares = shares}), sources, {1, 0.2, 1, 0.8}) <= 1e-12);
        world.settings.consensus.fades_at_silhouettes = false;
        CHECK(world.difference_from_plain(world.after(0, {}, {.shares = shares}), sources, {1, 1, 1, 1}) <= 1e-12);
    }
    TEST_CASE("a source is where neither frame shows an object, all sources alike") {
        // Rows of a frame's cells: 1 is background.
        std::vector<std::uint8_t> const mask{1, 1, 0, 0, 1, 0, 1, 1, 0, 1, 1, 0};
        strided_view<std::uint8_t const, 3> const background(mask.data(), {3, 2, 2});
        std::vector<frame_index> const sources{{2}, {0}};
        auto const of_first = background_plan<double>(background, sources, {0});
        CHECK(of_first.offsets == std::vector<std::uint32_t>{0, 1, 3, 3, 3});
        CHECK(of_first.sources == std::vector<std::uint32_t>{4, 1, 5});
        CHECK(of_first.weights == std::vector<double>{1, 0.5, 0.5});
        auto const of_second = background_plan<double>(background, sources, {1});
        CHECK(of_second.offsets == std::vector<std::uint32_t>{0, 1, 1, 2, 2});
        CHECK(of_second.sources == std::vector<std::uint32_t>{4, 2});
        CHECK(of_second.weights == std::vector<double>{1, 1});
        CHECK_THROWS_WITH_AS(background_plan<double>(background, sources, {3}),
                             "background_plan: i is 3, expected a frame of the background", value_error);
    }
    TEST_CASE("background agrees at its place on the screen where its noise stands still") {
        frames_of<unseen_strip> world; // The second cell shows something that no source sees.
        std::vector<std::uint8_t> const mask{1, 0, 1, 1};
        strided_view<std::uint8_t const, 3> const background(mask.data(), {frames, 1, width}, {0, 0, 1});
        latent_cells const cells{.background = background};
        for (std::size_t const step : {0U, 9U}) { // in the window of the surfaces and beyond
            auto const x0 = world.after(step, {}, cells);
            for (std::size_t t = 0; t < width; ++t) {
                double mean = 0;
                for (std::size_t k = 0; k < frames; ++k) {
                    mean += world.before(k, 1, 0, t) / frames;
                }
                for (std::size_t i = 0; i < frames; ++i) {
                    CHECK(x0(i, 1, 0, t) == doctest::Approx(mask[t] != 0 ? mean : world.before(i, 1, 0, t)));
                }
            }
        }
        world.settings.consensus.agrees_on_background = false;
        CHECK(world.is_unchanged(world.after(0, {}, cells)));
        world.settings.consensus.agrees_on_background = true;
        for (auto const moving : {background_noise::independent, background_noise::environment}) {
            world.settings.noise.background = moving;
            CHECK(world.is_unchanged(world.after(0, {}, cells)));
        }
    }
    TEST_CASE("sources share by a power of their quality that grows over the steps") {
        frames_of<graded_strip> world;
        world.settings.consensus.quality = {.exponent_begin = 0, .exponent_end = 4.5};
        for (auto const& [step, power] : {std::pair<std::size_t, double>{0, 0}, {2, 1}, {4, 2}}) {
            auto const sources = consensus_sources(world.settings, frames, step);
            CHECK(world.difference_from_plain(
                      world.after(step), sources, std::vector<double>(width, 1.0),
                      [power = power](frame_index k) { return std::pow(1.0 + k.value, power); }) <= 1e-12);
        }
    }
    TEST_CASE("any number of threads gives the same bits") {
        strip_of_frames world;
        auto const one = world.after(1);
        for (std::size_t const threads : {2U, 3U, 8U}) {
            auto const several = world.after(1, threaded_loop(threads));
            CHECK(std::equal(one.data(), one.data() + one.size(), several.data()));
        }
    }
    TEST_CASE("sources are drawn anew each step from numbers that are not the keyframes'") {
        strip_of_frames world;
        world.settings.consensus.sources.count = 3;
        world.settings.keyframes = world.settings.consensus.sources;
        bool is_new = false;
        bool is_own = false;
        for (std::size_t step = 0; step < 6; ++step) {
            auto const sources = consensus_sources(world.settings, frames, step);
            CHECK(sources == consensus_sources(world.settings, frames, step));
            is_new = is_new || sources != consensus_sources(world.settings, frames, 0);
            is_own = is_own || sources != draw_keyframes(world.settings.keyframes, frames, step);
            for (std::size_t stretch = 0; stretch < 3; ++stretch) { // one frame of each third
                CHECK(std::count_if(sources.begin(), sources.end(),
                                    [&](frame_index k) { return k.value / 3 == stretch; }) == 1);
            }
        }
        CHECK(is_new);
        CHECK(is_own);
    }
    TEST_CASE("the report tells coverage and seconds") {
        strip_of_frames world;
        world.settings.consensus.sources = {.count = 1, .drawing = keyframe_drawing::fixed, .frames = {{0}}, .seed = 0};
        world.after(0);
        CHECK(world.report.consensus.on_objects == frames * width);
        CHECK(world.report.consensus.covered == 4 + 3 + 2 + 1);
        CHECK(world.report.consensus_seconds > 0);
        CHECK(world.report.library_seconds == world.report.consensus_seconds);
        CHECK(world.report.coverage.empty());
    }
    TEST_CASE("without a run estimates reach the same, and cells that sources cover are returned") {
        strip_of_frames world;
        world.settings.consensus.sources = {.count = 1, .drawing = keyframe_drawing::fixed, .frames = {{0}}, .seed = 0};
        auto const expected = world.after(0);
        auto x0 = world.before;
        auto const& map = world.maps.at({1, width});
        CHECK(reach_consensus(&map, world.settings, x0.view(), {}, 0, threaded_loop(2)) ==
              std::vector<std::size_t>{4, 3, 2, 1, 0, 0, 0, 0, 0});
        CHECK(std::equal(x0.data(), x0.data() + x0.size(), expected.data()));
        CHECK(reach_consensus(&map, world.settings, x0.view(), {}, 9, {}).empty());
        CHECK(std::equal(x0.data(), x0.data() + x0.size(), expected.data()));
    }
    TEST_CASE("without a map of the latents' grid it is refused") {
        strip_of_frames world;
        world.maps = {};
        CHECK_THROWS_WITH_AS(world.after(0), "correspondence_set: grid is [1, 4], expected one of the 0 grids added",
                             value_error);
    }
}
