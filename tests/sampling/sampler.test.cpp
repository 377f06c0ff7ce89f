// SPDX-License-Identifier: MIT
// [EDM alg. 1] The samplers by name.
#include <genrender/sampling/sampler.hpp>

#include <genrender/core/tensor.hpp>
#include <genrender/sampling/karras_schedule.hpp>

#include <doctest/doctest.h>

#include "sampler_properties.hpp"

#include <cstddef>
#include <vector>

using namespace genrender;

TEST_SUITE("sampling/sampler") {
    TEST_CASE("a sampler by name is the sampler") {
        gaussian_denoiser const D;
        auto const sigmas = karras_schedule<double>(6);
        CHECK(sample(sampler::euler, D, 9.0, sigmas) == euler(D, 9.0, sigmas));
        CHECK(sample(sampler::heun, D, 9.0, sigmas) == heun(D, 9.0, sigmas));
        CHECK(sample(sampler::dpmpp_2m, D, 9.0, sigmas) == dpmpp_2m(D, 9.0, sigmas));
        CHECK(euler(D, 9.0, sigmas) != heun(D, 9.0, sigmas));
        CHECK(euler(D, 9.0, sigmas) != dpmpp_2m(D, 9.0, sigmas));
    }

    TEST_CASE("evaluations of 50 steps") {
        CHECK(evaluations(sampler::euler, 50) == 50);
        CHECK(evaluations(sampler::heun, 50) == 99);
        CHECK(evaluations(sampler::dpmpp_2m, 50) == 50);
    }

    TEST_CASE("[EDM alg. 1] Euler's method is a sampler of first order") {
        check_sampler_properties(sampler_by_name{sampler::euler}, facts_of(sampler::euler));
    }

    TEST_CASE("[EDM alg. 1] Heun's method is a sampler of second order") {
        check_sampler_properties(sampler_by_name{sampler::heun}, facts_of(sampler::heun));
    }

    TEST_CASE("[DPM++ alg. 2] DPM-Solver++(2M) is a sampler of second order") {
        check_sampler_properties(sampler_by_name{sampler::dpmpp_2m}, facts_of(sampler::dpmpp_2m));
    }

    TEST_CASE("[DPM++ alg. 2] the same number of evaluations goes further than with Euler's method") {
        for (std::size_t const steps : {10U, 20U, 50U}) {
            CHECK(error_of(sampler_by_name{sampler::dpmpp_2m}, steps) <
                  0.5 * error_of(sampler_by_name{sampler::euler}, steps));
        }
    }

    TEST_CASE("estimates of other extents are refused") {
        auto const levels = karras_schedule<double>(3, 0.1, 10.0, 7.0);
        auto const D = [](tensor<double, 4> const&, double) { return tensor<double, 4>::from_shape({1, 1, 2, 2}); };
        for (auto const method : {sampler::euler, sampler::heun, sampler::dpmpp_2m}) {
            auto const z = tensor<double, 4>::from_shape({2, 1, 2, 2});
            CHECK_THROWS_WITH_AS(sample(method, D, z, levels),
                                 "sampler: D(z, sigma) is [1, 1, 2, 2], expected [2, 1, 2, 2]", shape_error);
        }
    }

    TEST_CASE("what names no sampler and no step is refused") {
        auto const none = static_cast<sampler>(7);
        CHECK_THROWS_WITH_AS(sample(none, gaussian_denoiser{}, 1.0, std::vector{1.0, 0.0}),
                             "sample: method is 7, expected euler, heun or dpmpp_2m", value_error);
        CHECK_THROWS_WITH_AS(evaluations(none, 3), "evaluations: method is 7, expected euler, heun or dpmpp_2m",
                             value_error);
        CHECK_THROWS_WITH_AS(evaluations(sampler::heun, 0), "evaluations: steps is 0, expected at least 1",
                             value_error);
        CHECK_THROWS_WITH_AS(sample(sampler::heun, gaussian_denoiser{}, 1.0, std::vector{1.0}),
                             "heun: sigmas is [1], expected at least [2]", shape_error);
    }
}
