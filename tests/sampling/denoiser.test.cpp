// SPDX-License-Identifier: MIT
// [GR alg. 1: Phi] The concept accepts what it should and nothing else.
#include <genrender/sampling/denoiser.hpp>

#include <genrender/testing/analytic_denoiser.hpp>
#include <genrender/testing/denoiser_laws.hpp>

#include <doctest/doctest.h>

#include <array>
#include <list>
#include <string>
#include <vector>

using namespace genrender;

namespace {

using complete = denoiser_archetype<float, host_features<float>>;

struct without_sites {
    using real_type = float;
    using features_type = host_features<float>;
    std::size_t latent_channels() const;
    grid_extents latent_grid() const;
    std::size_t branches() const;
    template <class Processor>
    void operator()(strided_view<float, 4>, strided_view<float const, 4>, float, std::span<frame_index const>,
                    Processor&) const;
};

/// Takes one frame at a time, which cannot work: eq. 3 needs all keyframes at a layer at once.
struct frame_by_frame {
    using real_type = float;
    using features_type = host_features<float>;
    std::size_t latent_channels() const;
    grid_extents latent_grid() const;
    std::span<attention_site const> sites() const;
    std::size_t branches() const;
    template <class Processor>
    void operator()(strided_view<float, 3>, strided_view<float const, 3>, float, frame_index, Processor&) const;
};

struct without_processor {
    using real_type = float;
    using features_type = host_features<float>;
    std::size_t latent_channels() const;
    grid_extents latent_grid() const;
    std::span<attention_site const> sites() const;
    std::size_t branches() const;
    void operator()(strided_view<float, 4>, strided_view<float const, 4>, float, std::span<frame_index const>) const;
};

struct sites_are_numbers : complete {
    std::vector<int> sites() const;
};
struct sites_are_names : complete {
    std::vector<std::string> sites() const;
};
struct sites_are_a_list : complete {
    std::list<attention_site> sites() const;
};
struct sites_by_value : complete {
    std::vector<attention_site> sites() const;
};

static_assert(!denoiser<sites_are_numbers>);
static_assert(!denoiser<sites_are_names>);
static_assert(!denoiser<sites_are_a_list>);
static_assert(denoiser<sites_by_value>);
static_assert(attention_sites<std::array<attention_site, 2> const&>);
static_assert(denoiser<complete>);
static_assert(denoiser<testing::analytic_denoiser<float>>);
static_assert(denoiser<testing::analytic_denoiser<double>>);
static_assert(!denoiser<without_sites>);
static_assert(!denoiser<frame_by_frame>);
static_assert(!denoiser<without_processor>);
static_assert(!denoiser<int>);

} // namespace

TEST_SUITE("sampling/denoiser") {
    TEST_CASE_TEMPLATE("the analytic denoiser keeps the laws with one and two guidance branches", Real, float, double) {
        for (std::size_t const branches : {1U, 2U}) {
            testing::analytic_denoiser<Real> phi{.grid = {4, 6}, .attention = Real(0.3)};
            phi.guidance_branches = branches;
            CHECK(testing::check_denoiser_laws(phi, Real(1.5)).text() == "");
        }
    }
    TEST_CASE_TEMPLATE("the analytic denoiser gives the posterior mean of its prior", Real, float, double) {
        testing::analytic_denoiser<Real> const phi{
            .grid = {1, 1}, .channels = 1, .mean = Real(0.5), .spread = Real(0.25)};
        stack<Real, 4> z({1, 1, 1, 1});
        z(0, 0, 0, 0) = Real(1.5);
        stack<Real, 4> x0({1, 1, 1, 1});
        std::array const frames{frame_index{0}};
        plain_attention const plain;
        phi(x0.view(), z.view(), Real(0.5), frames, plain);
        CHECK(x0(0, 0, 0, 0) == doctest::Approx(0.5 + 0.0625 / (0.0625 + 0.25) * (1.5 - 0.5)));
    }
}
