// SPDX-License-Identifier: MIT
// [GR sec. 3, 4] What is a method, and a user's own one.
#include <genrender/pipeline/sequence_method.hpp>

#include <genrender/testing/analytic_denoiser.hpp>
#include "../support/random_scene.hpp"
#include <genrender/testing/sequence_method_laws.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

using namespace genrender;

namespace {

using passes_type = sequence_passes<testing::analytic_denoiser<double>, correspondence_map_archetype>;

/// A user's method: the middle frame runs as a keyframe, then all frames by themselves.
struct middle_first {
    template <class Real>
    std::vector<frame_index> keyframes(render_settings<Real> const&, std::size_t frames, std::size_t) const {
        return {{static_cast<std::uint32_t>(frames / 2)}};
    }
    template <class Real>
    bool uses_correspondence(render_settings<Real> const&) const {
        return false;
    }
    template <class Passes>
    void operator()(Passes const& passes) const {
        passes.record_keyframes(keyframes(passes.settings(), passes.frame_count(), passes.step()), true);
        passes.denoise_frames_alone();
    }
};

struct without_keyframes {
    bool uses_correspondence(render_settings<double> const&) const;
    void operator()(passes_type const&) const;
};
struct without_body {
    std::vector<frame_index> keyframes(render_settings<double> const&, std::size_t, std::size_t) const;
    bool uses_correspondence(render_settings<double> const&) const;
};

} // namespace

TEST_SUITE("pipeline/sequence_method") {
    TEST_CASE("the paper's method and a user's own are sequence methods") {
        CHECK(sequence_method<generative_rendering, passes_type>);
        CHECK(sequence_method<middle_first, passes_type>);
    }
    TEST_CASE("what tells no keyframes or denoises nothing is none") {
        CHECK_FALSE(sequence_method<without_keyframes, passes_type>);
        CHECK_FALSE(sequence_method<without_body, passes_type>);
        CHECK_FALSE(sequence_method<int, passes_type>);
    }
    TEST_CASE("a user's own method runs in the same machinery and keeps the laws") {
        auto const maps = testing::random_scene(33, 5, {32, 32}, 2);
        testing::analytic_denoiser<double> const phi{.grid = {8, 8}, .attention = 0.5};
        render_settings<double> settings = render_settings<double>::plain();
        settings.steps = 3;
        auto const laws = testing::check_sequence_method_laws(middle_first{}, phi, to_uv_view(maps), settings);
        CHECK(laws.text() == "");
        settings.window_end = 0;
        auto const alone = render(phi, to_uv_view(maps), {.settings = settings}).z;
        CHECK(std::equal(laws.z.begin(), laws.z.end(), alone.begin()));
    }
}
