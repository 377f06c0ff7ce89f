// SPDX-License-Identifier: MIT
// [EDM alg. 1] What every sampler takes.
#include <genrender/sampling/sampler_arguments.hpp>

#include <doctest/doctest.h>

#include <genrender/core/stack.hpp>
#include <genrender/sampling/karras_schedule.hpp>

#include <array>
#include <limits>
#include <span>
#include <type_traits>
#include <vector>

using namespace genrender;

namespace {

// Sequences of float or double are noise levels, others are not.
static_assert(noise_levels<std::vector<float>>);
static_assert(noise_levels<std::span<double const>>);
static_assert(noise_levels<std::array<double, 3>>);
static_assert(!noise_levels<std::vector<int>>);
static_assert(!noise_levels<double>);
static_assert(std::is_same_v<level_type<std::span<float const>>, float>);

// What takes latents and a level and gives latents is followed, nothing else.
struct halves {
    double operator()(double z, double) const { return z / 2; }
};
struct changes_its_latents {
    double operator()(double& z, double) const { return z = 0; }
};
struct gives_nothing {
    void operator()(double, double) const {}
};
static_assert(viewed_latents<stack<float, 4>, float>);
static_assert(!viewed_latents<stack<float, 4>, double>);
static_assert(!viewed_latents<double, double>);
static_assert(clean_estimator<halves, double, double>);
static_assert(clean_estimator<halves const, double, double>);
static_assert(!clean_estimator<changes_its_latents, double, double>);
static_assert(!clean_estimator<gives_nothing, double, double>);

void check(std::vector<double> const& sigmas) { require_noise_levels("somewhere", sigmas); }

} // namespace

TEST_SUITE("sampling/sampler_arguments") {
    TEST_CASE("falling levels are accepted whether or not they end at 0") {
        CHECK_NOTHROW(check({1, 0}));
        CHECK_NOTHROW(check({3, 2, 1}));
        CHECK_NOTHROW(check(karras_schedule<double>(50)));
        CHECK_NOTHROW(require_noise_levels("somewhere", karras_schedule<float>(1000)));
    }

    TEST_CASE("fewer than two levels are refused") {
        CHECK_THROWS_WITH_AS(check({}), "somewhere: sigmas is [0], expected at least [2]", shape_error);
        CHECK_THROWS_WITH_AS(check({1}), "somewhere: sigmas is [1], expected at least [2]", shape_error);
    }

    TEST_CASE("levels that do not fall are refused") {
        CHECK_THROWS_WITH_AS(check({1, 2}), "somewhere: sigmas[1] is 2.000000, expected less than sigmas[0]",
                             value_error);
        CHECK_THROWS_WITH_AS(check({3, 2, 2, 0}), "somewhere: sigmas[2] is 2.000000, expected less than sigmas[1]",
                             value_error);
        CHECK_THROWS_WITH_AS(check({3, 0, 0}), "somewhere: sigmas[2] is 0.000000, expected less than sigmas[1]",
                             value_error);
    }

    TEST_CASE("levels that are no levels are refused") {
        auto const nan = std::numeric_limits<double>::quiet_NaN();
        auto const infinity = std::numeric_limits<double>::infinity();
        CHECK_THROWS_WITH_AS(check({infinity, 0}),
                             "somewhere: sigmas[0] is inf, expected a finite number of at least 0", value_error);
        CHECK_THROWS_WITH_AS(check({2, nan, 0}), "somewhere: sigmas[1] is nan, expected a finite number of at least 0",
                             value_error);
        CHECK_THROWS_WITH_AS(check({2, -1}),
                             "somewhere: sigmas[1] is -1.000000, expected a finite number of at least 0", value_error);
    }

    TEST_CASE("doing nothing after a step changes nothing") {
        double z = 3;
        nothing_after_step{}(0, z);
        CHECK(z == 3);
    }
}
