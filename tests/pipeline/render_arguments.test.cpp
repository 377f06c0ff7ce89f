// SPDX-License-Identifier: MIT
// Arguments of a run that are left out.
#include <genrender/pipeline/render_arguments.hpp>

#include "../support/random_scene.hpp"

#include <genrender/pipeline/render.hpp>
#include <genrender/testing/analytic_denoiser.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <utility>

using namespace genrender;

TEST_SUITE("pipeline/render_arguments") {
    TEST_CASE("arguments that are left out are the preset, Alg. 1, one thread, nobody who looks on and a new run") {
        testing::analytic_denoiser<float> const phi{.grid = {8, 8}, .attention = 0.5F};
        auto const maps = testing::random_scene(33, 4, {16, 16}, 3);
        render_arguments<float, generative_rendering, chosen_correspondence<2>> const none;
        CHECK(!none.make_map);
        CHECK(!none.observer);
        CHECK(!none.after_step);
        CHECK(none.resume == nullptr);
        CHECK(none.model_key.empty());
        auto const left_out = render(phi, to_uv_view(maps), {});
        auto const told = render(phi, to_uv_view(maps),
                                 {.settings = render_settings<float>::vivid(),
                                  .method = generative_rendering{},
                                  .make_map = [&](grid_extents grid) -> chosen_correspondence<2> {
                                      return {to_uv_view(maps), grid, correspondence_settings{}};
                                  },
                                  .observer = [](progress const&) { return true; },
                                  .loop = sequential_loop{}});
        CHECK(std::equal(left_out.z.begin(), left_out.z.end(), told.z.begin(), told.z.end()));
    }
}
