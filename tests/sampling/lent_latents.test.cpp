// SPDX-License-Identifier: MIT
// Latents that a denoiser lends.
#include <genrender/sampling/lent_latents.hpp>

#include "../support/device_denoiser.hpp"

#include <genrender/sampling/latent_combination.hpp>
#include <genrender/testing/analytic_denoiser.hpp>
#include <genrender/testing/random_stack.hpp>

#include <doctest/doctest.h>

#include <array>
#include <cstddef>
#include <utility>

TEST_SUITE("sampling/lent_latents") {
    using namespace genrender;
    using on_device = testing::device_denoiser<testing::analytic_denoiser<double>>;
    using lent = lent_latents<on_device>;

    namespace {

    stack<double, 4> some_values(std::uint64_t seed, std::size_t frames = 2) {
        return testing::random_stack<double>(std::array<std::size_t, 4>{frames, 3, 2, 2}, seed);
    }
    stack<double, 4> downloaded(lent const& z) {
        stack<double, 4> values(z.extents());
        z.download(values.view());
        return values;
    }
    bool are_equal(stack<double, 4> const& a, stack<double, 4> const& b) {
        return a.extents() == b.extents() && std::equal(a.data(), a.data() + a.size(), b.data());
    }

    } // namespace

    static_assert(combined_latents<lent, double> && !viewed_latents<lent, double>);

    TEST_CASE("lent latents are values: copies stay as they were") {
        on_device const phi{{.grid = {2, 2}}};
        auto const a = some_values(1);
        auto const b = some_values(2);
        lent z(phi, a.view());
        auto const before = z;
        lent const x0(phi, b.view());
        detail::combine_latents<double>(z, {0.25, 0.75}, z, x0);
        auto expected = stack<double, 4>::uninitialized(a.extents());
        linear_combination(expected.data(), expected.size(), std::array{0.25, 0.75}, std::array{a.data(), b.data()});
        CHECK(are_equal(downloaded(z), expected));
        CHECK(are_equal(downloaded(before), a));
        z = before;
        CHECK(are_equal(downloaded(z), a));
        CHECK(phi.counts->uploads == 2);
    }
    TEST_CASE("what the engine does not lend is done on the host by one download and one upload") {
        on_device const phi{{.grid = {2, 2}}};
        auto values = some_values(3);
        lent z(phi, std::as_const(values).view());
        z.on_host([](strided_view<double, 4> view) { view(1, 2, 1, 0) = 7; });
        values(1, 2, 1, 0) = 7;
        CHECK(phi.counts->uploads == 2);
        CHECK(phi.counts->downloads == 1);
        CHECK(are_equal(downloaded(z), values));
    }
    TEST_CASE("latents of other extents are refused") {
        on_device const phi{{.grid = {2, 2}}};
        lent z(phi, some_values(1).view());
        lent const more(phi, some_values(1, 3).view());
        CHECK_THROWS_WITH_AS(detail::combine_latents<double>(z, {1.0, 1.0}, z, more),
                             "sampler: D(z, sigma) is [3, 3, 2, 2], expected [2, 3, 2, 2]", shape_error);
        stack<double, 4> to({3, 3, 2, 2});
        CHECK_THROWS_WITH_AS(z.download(to.view()), "lent_latents: to is [3, 3, 2, 2], expected [2, 3, 2, 2]",
                             shape_error);
    }
}
