// SPDX-License-Identifier: MIT
// [GR alg. 1: the body of the loop] The passes one by one.
#include <genrender/pipeline/sequence_passes.hpp>

#include <genrender/testing/analytic_denoiser.hpp>
#include "../support/meeting_place.hpp"
#include "../support/shifted_strip.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <set>
#include <span>
#include <utility>
#include <vector>

using namespace genrender;
using testing::analytic_denoiser;
using testing::shifted_strip;

namespace {

/// Five frames of 1 x 4 tokens on a strip that moves one token a frame.
struct strip_run {
    analytic_denoiser<double> phi{.grid = {1, 4}, .attention = 1, .guidance_branches = 2};
    render_settings<double> settings = render_settings<double>::plain();
    correspondence_set<shifted_strip> maps;
    threaded_loop loop{2};
    std::vector<progress> told;
    progress_meter meter{4, 100, [this](progress const& now) {
                             told.push_back(now);
                             return true;
                         }};
    render_report report;
    report_writer writer{report};
    sequence_run<analytic_denoiser<double>, shifted_strip> run{&phi, &maps, &settings, loop, &meter, &writer};
    latents<double> z = latents<double>::from_shape({5, 3, 1, 4});
    latents<double> x0 = latents<double>::from_shape({5, 3, 1, 4});
    sequence_passes<analytic_denoiser<double>, shifted_strip> passes{run, x0, z, 0.5, 2};

    strip_run() {
        settings.steps = 4;
        maps.add({1, 4}, [](grid_extents) { return shifted_strip{5, 4}; });
        for (std::size_t e = 0; e < z.size(); ++e) {
            z.data()[e] = normal_value(1, random_stream::test, {static_cast<std::uint32_t>(e), 0, 0});
        }
        x0.fill(1e9);
    }
    strip_run(strip_run const&) = delete;
};

} // namespace

TEST_SUITE("pipeline/sequence_passes") {
    TEST_CASE("it tells where it is") {
        strip_run world;
        world.settings.alpha = [](std::size_t step, attention_site const& site) {
            return static_cast<double>(step) + (site.name == "decoder.attn1" ? 0.5 : 0);
        };
        CHECK(world.passes.step() == 2);
        CHECK(world.passes.frame_count() == 5);
        CHECK(world.passes.settings().steps == 4);
        CHECK(world.passes.alpha({2}) == 2.5);
        CHECK(world.passes.takes_part({{2}, 1}));
        CHECK(!world.passes.takes_part({{1}, 1})); // a ControlNet's
        CHECK(!world.passes.takes_part({{0}, 0})); // the encoder's
    }
    TEST_CASE("frames are denoised once each whatever number is denoised at once") {
        for (auto const frames_per_call : {1, 2, 5, 9}) {
            strip_run world;
            world.settings.frames_per_call = static_cast<std::size_t>(frames_per_call);
            std::atomic<std::size_t> frames{0};
            std::atomic<std::size_t> calls{0};
            world.passes.denoise_frames([&](std::span<frame_index const> stack) {
                frames += stack.size();
                ++calls;
                return plain_attention{};
            });
            auto const count = static_cast<std::size_t>(frames_per_call);
            CHECK(frames == 5);
            CHECK(calls == (5 + count - 1) / count);
            CHECK(world.told.size() == calls);
            CHECK(world.told.back().frames_done == 5);
            CHECK(world.told.back().pass == render_pass::frames);
            CHECK(world.told.back().step == 2);
            CHECK(world.report.denoiser_seconds > 0);
        }
    }
    TEST_CASE("at most as many calls run at the same time as the settings say, each once") {
        for (auto const at_once : {1, 2, 0, 7}) {
            strip_run world;
            world.run.loop = threaded_loop(4);
            world.settings.calls_at_once = static_cast<std::size_t>(at_once);
            sequence_passes<analytic_denoiser<double>, shifted_strip> const passes(world.run, world.x0, world.z, 0.5,
                                                                                   2);
            testing::meeting_place meeting;
            std::array<std::atomic<int>, 5> runs{};
            passes.denoise_frames([&](std::span<frame_index const> stack) {
                ++runs[stack.front().value];
                return [&](auto& call) { // runs while the denoiser does, at its last site
                    if (call.place() == attention_place{{2}, 0}) {
                        meeting.meet(std::chrono::milliseconds(at_once == 1 ? 20 : 2000));
                    }
                    return plain_attention{}(call);
                };
            });
            CHECK(std::all_of(runs.begin(), runs.end(), [](auto const& count) { return count == 1; }));
            CHECK((at_once == 1 ? meeting.most() == 1 : meeting.most() >= 2));
            CHECK((at_once != 2 || meeting.most() == 2));
            CHECK(world.told.back().frames_done == 5);
        }
    }
    TEST_CASE("one call at a time leaves the loop's threads to the library's own work") {
        strip_run world;
        world.settings.calls_at_once = 1;
        world.settings.frames_per_call = 5;
        testing::meeting_place meeting;
        std::vector<frame_index> const KF{{0}};
        world.passes.denoise_frames([&](std::span<frame_index const> stack) {
            auto const plans = world.passes.make_plans(stack, [&](shifted_strip const& map, frame_index i) {
                meeting.meet(std::chrono::milliseconds(2000));
                return make_blend_plan<double>(map, KF, i);
            });
            CHECK(plans.rows({2}, {3}).row_count() == 4);
            return plain_attention{};
        });
        CHECK(meeting.most() == 2);
    }
    TEST_CASE("a call that fails ends the pass, however few run at once") {
        strip_run world;
        world.settings.calls_at_once = 1;
        std::atomic<std::size_t> calls{0};
        CHECK_THROWS_AS(world.passes.denoise_frames([&](std::span<frame_index const>) -> plain_attention {
            ++calls;
            throw cancelled("enough");
        }),
                        cancelled);
        CHECK(calls == 1);
    }
    TEST_CASE("a last call that is filled repeats the last frame, and one in order is not filled") {
        strip_run world;
        world.settings.frames_per_call = 3;
        world.settings.fills_last_call = true;
        auto const expected = [&] {
            strip_run other;
            other.passes.denoise_frames_alone();
            return other.x0;
        }();
        std::mutex mutex;
        std::set<std::vector<frame_index>> stacks;
        std::atomic<std::size_t> made{0};
        world.passes.denoise_frames([&](std::span<frame_index const> stack) {
            std::lock_guard const lock(mutex);
            stacks.insert({stack.begin(), stack.end()});
            world.passes.make_plans(stack, [&](shifted_strip const&, frame_index) {
                ++made;
                return blend_plan<double>{};
            });
            return plain_attention{};
        });
        CHECK(stacks == std::set<std::vector<frame_index>>{{{0}, {1}, {2}}, {{3}, {4}, {4}}});
        CHECK(made == 5);
        CHECK(std::equal(world.x0.begin(), world.x0.end(), expected.begin()));
        CHECK(world.told.back().frames_done == 5);
        std::vector<std::size_t> in_order;
        world.passes.denoise_frames_in_order([&](std::span<frame_index const> stack) {
            in_order.push_back(stack.size());
            return plain_attention{};
        });
        CHECK(in_order == std::vector<std::size_t>{3, 2});
    }
    TEST_CASE("in order means one call after the other from the first frame on") {
        strip_run world;
        world.settings.frames_per_call = 2;
        std::vector<frame_index> seen; // pushed to from one thread, or the thread sanitizer would find it
        world.passes.denoise_frames_in_order([&](std::span<frame_index const> stack) {
            CHECK(world.told.size() == (seen.size() + 1) / 2); // those before are done
            seen.insert(seen.end(), stack.begin(), stack.end());
            return plain_attention{};
        });
        CHECK(seen == std::vector<frame_index>{{0}, {1}, {2}, {3}, {4}});
    }
    TEST_CASE("frames by themselves are what the denoiser makes of each alone") {
        strip_run world;
        world.passes.denoise_frames_alone();
        plain_attention const plain;
        for (std::uint32_t i = 0; i < 5; ++i) {
            auto alone = latents<double>::from_shape({1, 3, 1, 4});
            world.phi(to_view(alone), to_view(std::as_const(world.z)).slice(i, 1), 0.5, std::array{frame_index{i}},
                      plain);
            for (std::size_t e = 0; e < 12; ++e) {
                CHECK(world.x0.data()[i * 12 + e] == alone.data()[e]);
            }
        }
    }
    TEST_CASE("[GR alg. 1: f_KF, F_KF] keyframes are recorded in their drawn order where they take part") {
        strip_run world;
        std::vector<frame_index> const KF{{3}, {1}};
        auto const bank = world.passes.record_keyframes(KF, true);
        CHECK(bank.find({{0}, 0}) == nullptr);
        CHECK(bank.find({{1}, 0}) == nullptr);
        auto const* const kept = bank.find({{2}, 1});
        REQUIRE(kept != nullptr);
        // K = f is the posterior mean, in the second branch with its sign turned.
        auto const gain = 0.25 * 0.25 / (0.25 * 0.25 + 0.5 * 0.5);
        CHECK(kept->K_KF->view()(0, 2, 1) == doctest::Approx(-(0.5 + gain * (world.z(3, 1, 0, 2) - 0.5))));
        CHECK(kept->K_KF->view()(1, 0, 0) == doctest::Approx(-(0.5 + gain * (world.z(1, 0, 0, 0) - 0.5))));
        REQUIRE(world.told.size() == 1);
        CHECK(world.told[0].pass == render_pass::keyframes);
        CHECK(world.told[0].frames_done == 2);
        CHECK(world.x0(3, 0, 0, 0) == 1e9); // estimates of keyframes are not kept
        auto const apart = world.passes.record_keyframes(KF, false);
        CHECK(apart.find({{2}, 1})->F_KF->view()(0, 0, 0) != kept->F_KF->view()(0, 0, 0));
    }
    TEST_CASE("plans are made once for each resolution and frame and serve all sites") {
        strip_run world;
        std::vector<frame_index> const frames{{1}, {4}};
        std::vector<frame_index> const KF{{0}};
        std::atomic<std::size_t> made{0}; // the loop has two threads
        auto const plans = world.passes.make_plans(frames, [&](shifted_strip const& map, frame_index i) {
            ++made;
            return make_blend_plan<double>(map, KF, i);
        });
        CHECK(made == 2);
        CHECK(plans.rows({2}, {1}).sources.size() == 3); // points 1, 2, 3 of frame 1 are in frame 0
        CHECK(plans.rows({2}, {1}).sources[0] == 1);
        CHECK(plans.rows({0}, {4}).sources.empty());
        CHECK(made == 2);
    }
    TEST_CASE("coverage is counted of the tokens that show an object") {
        strip_run world;
        world.passes.report_coverage({1, 4}, {2}, 3);
        CHECK(world.report.coverage.at({1, 4}).on_objects == 4);
        CHECK(world.report.coverage.at({1, 4}).covered == 3);
    }
    TEST_CASE("features that are missing are refused by site and branch") {
        strip_run world;
        auto bank = world.passes.new_bank();
        bank.put({{2}, 0}, {});
        CHECK_THROWS_WITH_AS(world.passes.require_recorded(bank, "frames"),
                             "sequence_denoiser: features of frames at site decoder.attn1 of branch 1 are missing, "
                             "expected the denoiser to run its processor there",
                             value_error);
        bank.put({{2}, 1}, {});
        CHECK_NOTHROW(world.passes.require_recorded(bank, "frames"));
    }
}
