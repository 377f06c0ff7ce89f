// SPDX-License-Identifier: MIT
// [GR alg. 1: z] Who lends latents, and who does not.
#include <genrender/sampling/latent_lender.hpp>

#include "../support/device_denoiser.hpp"

#include <genrender/testing/analytic_denoiser.hpp>

#include <doctest/doctest.h>

#include <span>

using namespace genrender;

namespace {

struct some_latents {};
struct some_features {};
using lender = latent_lender_archetype<float, some_features, some_latents>;
using host_denoiser = testing::analytic_denoiser<double>;
using lending_device = testing::device_denoiser<host_denoiser>;

static_assert(latent_lender<lender> && !normalizing_lender<lender>);
static_assert(latent_lender<lending_device> && !normalizing_lender<lending_device>);
static_assert(normalizing_lender<testing::normalizing_device<host_denoiser>>);
static_assert(denoiser<host_denoiser> && !latent_lender<host_denoiser>);

// One thing wrong each.
struct uploads_nothing : lender {
    void upload(strided_view<float const, 4>) const;
};
struct combines_no_constants : lender {
    some_latents combination(std::span<float>, std::span<some_latents const>) const;
};
struct is_not_const : lender {
    bool all_finite(some_latents const&);
};
struct has_handles_of_one_owner : lender {
    struct latents_type {
        latents_type(latents_type&&) = default;
    };
};
static_assert(denoiser<uploads_nothing> && !latent_lender<uploads_nothing>);
static_assert(!detail::lender_uploads<uploads_nothing> && detail::lender_downloads<uploads_nothing>);
static_assert(!latent_lender<combines_no_constants> && !detail::lender_combines<combines_no_constants>);
static_assert(!latent_lender<is_not_const> && !detail::lender_tells_finite<is_not_const>);
static_assert(!latent_lender<has_handles_of_one_owner> && !detail::lender_names_handle<has_handles_of_one_owner>);
// What is told of one part is not told of the others again, nor of who lends nothing.
static_assert(detail::lender_uploads<has_handles_of_one_owner> && detail::lender_estimates<has_handles_of_one_owner>);
static_assert(detail::lender_uploads<host_denoiser> && detail::lender_names_handle<host_denoiser>);

} // namespace

TEST_SUITE("sampling/latent_lender") {
    TEST_CASE("a right lender is refused by no sentence") {
        require_latent_lender<lender>();
        require_latent_lender<lending_device>();
        require_latent_lender<host_denoiser>();
        CHECK(latent_lender<lender>);
    }
}
