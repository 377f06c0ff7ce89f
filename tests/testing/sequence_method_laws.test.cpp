// SPDX-License-Identifier: MIT
// [GR sec. 3, 4] Every law of methods can be broken, and is told by its sentence.
#include <genrender/testing/sequence_method_laws.hpp>

#include "broken_laws.hpp"

#include <genrender/testing/analytic_denoiser.hpp>

#include "../support/random_scene.hpp"

#include <doctest/doctest.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

TEST_SUITE("testing/sequence_method_laws") {
    using namespace genrender;
    using namespace genrender::testing;

    namespace {

    using names = std::vector<std::string>;

    enum class fault {
        none,
        runs_frames_twice,
        hides_its_keyframes,
        announces_more_keyframes,
        reads_frames_per_call,
        reports_by_frames_per_call
    };

    /// Every frame by itself, after keyframes that are announced or not.
    struct faulty_method {
        fault made = fault::none;

        template <class Real>
        std::vector<frame_index> keyframes(render_settings<Real> const&, std::size_t, std::size_t) const {
            if (made == fault::hides_its_keyframes) {
                return {};
            }
            return made == fault::announces_more_keyframes ? std::vector<frame_index>{{1}, {2}}
                                                           : std::vector<frame_index>{{1}};
        }
        template <class Real>
        bool uses_correspondence(render_settings<Real> const&) const {
            return made == fault::reports_by_frames_per_call;
        }
        template <class Passes>
        void operator()(Passes const& passes) const {
            passes.record_keyframes({{1}}, true);
            auto const one_by_one = passes.settings().frames_per_call == 1;
            if (made == fault::reads_frames_per_call && one_by_one) {
                auto const f_alone = [](auto& call) { return call.f(); };
                passes.denoise_frames([&](auto) -> decltype(f_alone) const& { return f_alone; });
            } else {
                passes.denoise_frames_alone();
            }
            if (made == fault::runs_frames_twice) {
                passes.denoise_frames_alone();
            }
            if (made == fault::reports_by_frames_per_call) {
                passes.make_plans(std::vector<frame_index>{{0}}, [&](auto const& map, frame_index frame) {
                    passes.report_coverage(map.grid(), frame, one_by_one ? 2 : 1);
                    return blend_plan<typename Passes::real_type>{};
                });
            }
        }
    };

    law_report report_on(fault made) {
        auto const maps = random_scene(33, 3, {16, 16}, 2);
        analytic_denoiser<double> const phi{.grid = {4, 4}, .attention = 0.5};
        render_settings<double> settings;
        settings.steps = 2;
        return check_sequence_method_laws(faulty_method{made}, phi, to_uv_view(maps), settings);
    }

    } // namespace

    TEST_CASE("a method that keeps the laws has none to tell") { CHECK(report_on(fault::none).text() == ""); }
    TEST_CASE("each fault is told by the law that it breaks") {
        CHECK(report_on(fault::runs_frames_twice).violations.front() ==
              "sequence_method: every evaluation denoises every frame once: found 6 frames in step 0, expected 3");
        CHECK(report_on(fault::hides_its_keyframes).violations.front() ==
              "sequence_method: every evaluation runs the keyframes that it announced: found 1 keyframes in step 0, "
              "expected 0");
        CHECK(
            report_on(fault::reads_frames_per_call).text() ==
            "sequence_method: estimates depend neither on the loop nor on frames_per_call: found other latents with 2 "
            "frames a call on two threads, expected the same\n");
        CHECK(
            report_on(fault::reports_by_frames_per_call).text() ==
            "sequence_method: coverage depends neither on the loop nor on frames_per_call: found another coverage with "
            "2 frames a call on two threads, expected the same\n");
    }
    TEST_CASE("keyframes that are announced and never come leave progress without its end") {
        CHECK(broken_laws(report_on(fault::announces_more_keyframes)) ==
              names{"sequence_method: every evaluation runs the keyframes that it announced",
                    "sequence_method: progress ends when all frames are done"});
    }
}
