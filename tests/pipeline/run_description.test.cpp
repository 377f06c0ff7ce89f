// SPDX-License-Identifier: MIT
// A run is described by its denoiser and maps.
#include <genrender/pipeline/run_description.hpp>

#include <genrender/testing/analytic_denoiser.hpp>
#include "../support/small_maps.hpp"

#include <doctest/doctest.h>

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

using namespace genrender;

namespace {

struct lending_denoiser : testing::analytic_denoiser<float> {
    struct residuals_type {};
    using testing::analytic_denoiser<float>::operator();
    template <class Processor>
    void run_until(strided_view<float const, 4>, float, std::span<frame_index const>, Processor&,
                   std::span<std::optional<site_index> const>, residuals_type* = nullptr) const {}
    template <class Processor>
    void operator()(strided_view<float, 4>, strided_view<float const, 4>, float, std::span<frame_index const>,
                    Processor&, residuals_type const&) const {}
    std::size_t residual_bytes() const { return 17; }
};

} // namespace

TEST_SUITE("pipeline/run_description") {
    TEST_CASE("grids and sites are the denoiser's and surfaces are counted frame by frame") {
        auto const maps = testing::drawn_maps({"aab. ab..", ".... ....", "b... ...."});
        testing::analytic_denoiser<float> const phi{.grid = {1, 2}, .guidance_branches = 2};
        auto const run = describe_run(phi, to_uv_view(maps), 3);
        CHECK(run.frames == 3);
        CHECK(run.latent_channels == 3);
        CHECK(run.latent_grid == grid_extents{1, 2});
        CHECK(run.branches == 2);
        CHECK(run.sites.size() == 3);
        CHECK(run.map_grid == grid_extents{2, 4});
        CHECK(run.map_dimensions == 2);
        CHECK(run.surface_pixels == std::vector<std::size_t>{3, 2, 0, 1});
        CHECK(run.calls_at_once == 3);
        CHECK_FALSE(run.residual_bytes.has_value());
    }
    TEST_CASE("a denoiser that lends says what that takes") {
        auto const maps = testing::drawn_maps({"a."});
        lending_denoiser const phi{{.grid = {1, 1}}};
        CHECK(describe_run(phi, to_uv_view(maps)).residual_bytes == 17);
    }
}
