// SPDX-License-Identifier: MIT
// Who can end a keyframe pass early, who lends, and where the pass may end.
#include <genrender/keyframes/stoppable_denoiser.hpp>

#include <genrender/testing/analytic_denoiser.hpp>

#include <doctest/doctest.h>

#include <concepts>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

using namespace genrender;

namespace {

using plain_one = testing::analytic_denoiser<float>;

struct stops : plain_one {
    template <class Processor>
    void run_until(strided_view<float const, 4>, float, std::span<frame_index const>, Processor&,
                   std::span<std::optional<site_index> const>) const {}
};

struct lends : plain_one {
    struct residuals_type {};
    using plain_one::operator();
    template <class Processor>
    void run_until(strided_view<float const, 4>, float, std::span<frame_index const>, Processor&,
                   std::span<std::optional<site_index> const>, residuals_type* = nullptr) const {}
    template <class Processor>
    void operator()(strided_view<float, 4>, strided_view<float const, 4>, float, std::span<frame_index const>,
                    Processor&, residuals_type const&) const {}
    std::size_t residual_bytes() const { return 5; }
};

} // namespace

TEST_SUITE("keyframes/stoppable_denoiser") {
    TEST_CASE("both are capabilities that a denoiser may have") {
        CHECK(denoiser<plain_one>);
        CHECK_FALSE(stoppable_denoiser<plain_one>);
        CHECK(stoppable_denoiser<stops>);
        CHECK_FALSE(residual_lender<stops>);
        CHECK(stoppable_denoiser<lends>);
        CHECK(residual_lender<lends>);
        CHECK(std::same_as<residuals_of<lends>, lends::residuals_type>);
        CHECK_FALSE(std::same_as<residuals_of<stops>, lends::residuals_type>);
    }
    TEST_CASE("the last site that takes part is found in each branch by itself") {
        plain_one const phi{.grid = {2, 2}, .guidance_branches = 3};
        auto const last = last_sites(phi, [](attention_place place) {
            return place.branch == 0 ? place.site.value != 2 : place.branch == 2 && place.site.value == 0;
        });
        REQUIRE(last.size() == 3);
        CHECK(last[0] == site_index{1});
        CHECK(last[1] == std::nullopt);
        CHECK(last[2] == site_index{0});
    }
}
