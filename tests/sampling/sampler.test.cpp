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
        CHECK(sample(sampler_kind::euler, D, 9.0, sigmas) == euler(D, 9.0, sigmas));
        CHECK(sample(sampler_kind::heun, D, 9.0, sigmas) == heun(D, 9.0, sigmas));
        CHECK(sample(sampler_kind::dpmpp_2m, D, 9.0, sigmas) == dpmpp_2m(D, 9.0, sigmas));
        CHECK(euler(D, 9.0, sigmas) != heun(D, 9.0, sigmas));
        CHECK(euler(D, 9.0, sigmas) != dpmpp_2m(D, 9.0, sigmas));
    }

    TEST_CASE("evaluations of 50 steps") {
        CHECK(evaluations(sampler_kind::euler, 50) == 50);
        CHECK(evaluations(sampler_kind::heun, 50) == 99);
        CHECK(evaluations(sampler_kind::dpmpp_2m, 50) == 50);
    }

    TEST_CASE("[EDM alg. 1] Euler's method is a sampler of first order") {
        check_sampler_properties(sampler_by_name{sampler_kind::euler}, facts_of(sampler_kind::euler));
    }

    TEST_CASE("[EDM alg. 1] Heun's method is a sampler of second order") {
        check_sampler_properties(sampler_by_name{sampler_kind::heun}, facts_of(sampler_kind::heun));
    }

    TEST_CASE("[DPM++ alg. 2] DPM-Solver++(2M) is a sampler of second order") {
        check_sampler_properties(sampler_by_name{sampler_kind::dpmpp_2m}, facts_of(sampler_kind::dpmpp_2m));
    }

    TEST_CASE("[DPM++ alg. 2] the same number of evaluations goes further than with Euler's method") {
        for (std::size_t const steps : {10U, 20U, 50U}) {
            CHECK(error_of(sampler_by_name{sampler_kind::dpmpp_2m}, steps) <
                  0.5 * error_of(sampler_by_name{sampler_kind::euler}, steps));
        }
    }

    TEST_CASE("estimates of other extents are refused") {
        auto const levels = karras_schedule<double>(3, 0.1, 10.0, 7.0);
        auto const D = [](tensor<double, 4> const&, double) { return tensor<double, 4>::from_shape({1, 1, 2, 2}); };
        for (auto const method : {sampler_kind::euler, sampler_kind::heun, sampler_kind::dpmpp_2m}) {
            auto const z = tensor<double, 4>::from_shape({2, 1, 2, 2});
            CHECK_THROWS_WITH_AS(sample(method, D, z, levels),
                                 "sampler: D(z, sigma) is [1, 1, 2, 2], expected [2, 1, 2, 2]", shape_error);
        }
    }

    TEST_CASE("D is told its noise level where it asks for it, and gives the same") {
        std::vector const sigmas{8.0, 3.0, 1.0, 0.0};
        for (auto const sampler : {sampler_kind::euler, sampler_kind::heun, sampler_kind::dpmpp_2m}) {
            std::vector<std::size_t> told(3);
            auto const D = [&](double z, double sigma, std::size_t i) {
                CHECK(sigma == sigmas.at(i));
                ++told[i];
                return gaussian_denoiser{}(z, sigma);
            };
            CHECK(sample(sampler, D, 9.0, sigmas) == sample(sampler, gaussian_denoiser{}, 9.0, sigmas));
            for (std::size_t i = 0; i < 3; ++i) {
                CHECK(told[i] == evaluations_at(sampler, i));
            }
        }
        CHECK(evaluations_at(sampler_kind::heun, 0) == 1);
        CHECK(evaluations_at(sampler_kind::heun, 1) == 2);
        CHECK(evaluations_at(sampler_kind::dpmpp_2m, 1) == 1);
    }
    TEST_CASE("what names no sampler and no step is refused") {
        auto const none = static_cast<sampler_kind>(7);
        CHECK_THROWS_WITH_AS(sample(none, gaussian_denoiser{}, 1.0, std::vector{1.0, 0.0}),
                             "sample: sampler is 7, expected euler, heun or dpmpp_2m", value_error);
        CHECK_THROWS_WITH_AS(evaluations(none, 3), "evaluations: sampler is 7, expected euler, heun or dpmpp_2m",
                             value_error);
        CHECK_THROWS_WITH_AS(evaluations(sampler_kind::heun, 0), "evaluations: steps is 0, expected at least 1",
                             value_error);
        CHECK_THROWS_WITH_AS(sample(sampler_kind::heun, gaussian_denoiser{}, 1.0, std::vector{1.0}),
                             "heun: sigmas is [1], expected at least [2]", shape_error);
    }
}
