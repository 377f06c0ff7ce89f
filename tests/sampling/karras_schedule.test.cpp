// SPDX-License-Identifier: MIT
// [EDM eq. 5] The noise levels a sampler visits.
#include <genrender/sampling/karras_schedule.hpp>

#include <doctest/doctest.h>

#include "golden.hpp"

#include <cmath>
#include <limits>
#include <string>
#include <vector>

using namespace genrender;

namespace {

template <class Real, class Golden>
void check_levels(Golden const& expected, double bound) {
    auto const sigmas = karras_schedule<Real>(expected.size() - 1);
    REQUIRE(sigmas.size() == expected.size());
    for (std::size_t i = 0; i < expected.size(); ++i) {
        CHECK(std::abs(static_cast<double>(sigmas[i]) - expected[i]) <= bound * expected[i]);
    }
}

} // namespace

TEST_SUITE("sampling/karras_schedule") {
    TEST_CASE("[EDM eq. 5] rho 1 spaces the levels evenly") {
        CHECK(karras_schedule(4, 1.0, 7.0, 1.0) == std::vector{7.0, 5.0, 3.0, 1.0, 0.0});
    }

    TEST_CASE("[EDM eq. 5] rho 2 spaces the square roots of the levels evenly") {
        auto const sigmas = karras_schedule(3, 1.0, 9.0, 2.0);
        REQUIRE(sigmas.size() == 4);
        CHECK(sigmas[1] == doctest::Approx(4.0).epsilon(1e-14));
    }

    TEST_CASE("[EDM eq. 5] the levels agree with k-diffusion") {
        check_levels<double>(golden::karras(1), 1e-13);
        check_levels<double>(golden::karras(2), 1e-13);
        check_levels<double>(golden::karras(10), 1e-13);
        check_levels<double>(golden::karras(50), 1e-13);
    }

    TEST_CASE("[EDM eq. 5] levels in single precision are as exact as single precision is") {
        check_levels<float>(golden::karras(1), 1.2e-7);
        check_levels<float>(golden::karras(2), 1.2e-7);
        check_levels<float>(golden::karras(10), 1.2e-7);
        check_levels<float>(golden::karras(50), 1.2e-7);
    }

    TEST_CASE_TEMPLATE("levels fall from sigma_max to sigma_min and then to 0", Real, float, double) {
        for (std::size_t const steps : {2U, 3U, 7U, 50U, 1000U}) {
            auto const sigmas = karras_schedule<Real>(steps, Real(0.02), Real(80), Real(7));
            REQUIRE(sigmas.size() == steps + 1);
            CHECK(sigmas[0] == Real(80));
            CHECK(sigmas[steps - 1] == Real(0.02));
            CHECK(sigmas[steps] == Real(0));
            for (std::size_t i = 1; i <= steps; ++i) {
                CHECK(sigmas[i] < sigmas[i - 1]);
            }
        }
    }

    TEST_CASE_TEMPLATE("one step goes from sigma_max to 0", Real, float, double) {
        CHECK(karras_schedule<Real>(1) == std::vector<Real>{Real(14.6146), Real(0)});
        CHECK(karras_schedule<Real>(1, Real(2), Real(2)) == std::vector<Real>{Real(2), Real(0)});
    }

    TEST_CASE("impossible schedules are refused") {
        auto const nan = std::numeric_limits<double>::quiet_NaN();
        auto const infinity = std::numeric_limits<double>::infinity();
        auto const text = [](char const* found) {
            return std::string("karras_schedule: ") + found + ", expected a finite number above 0";
        };
        CHECK_THROWS_WITH_AS(karras_schedule<double>(0), "karras_schedule: steps is 0, expected at least 1",
                             value_error);
        CHECK_THROWS_WITH_AS(karras_schedule(5, 0.0), text("sigma_min is 0.000000").c_str(), value_error);
        CHECK_THROWS_WITH_AS(karras_schedule(5, -1.0), text("sigma_min is -1.000000").c_str(), value_error);
        CHECK_THROWS_WITH_AS(karras_schedule(5, nan), text("sigma_min is nan").c_str(), value_error);
        CHECK_THROWS_WITH_AS(karras_schedule(5, 1.0, infinity), text("sigma_max is inf").c_str(), value_error);
        CHECK_THROWS_WITH_AS(karras_schedule(5, 1.0, nan), text("sigma_max is nan").c_str(), value_error);
        CHECK_THROWS_WITH_AS(karras_schedule(5, 1.0, 2.0, 0.0), text("rho is 0.000000").c_str(), value_error);
        CHECK_THROWS_WITH_AS(karras_schedule(5, 1.0, 2.0, nan), text("rho is nan").c_str(), value_error);
        CHECK_THROWS_WITH_AS(karras_schedule(1, 2.0, 1.0),
                             "karras_schedule: sigma_max is 1.000000, expected at least sigma_min", value_error);
        CHECK_THROWS_WITH_AS(karras_schedule(2, 2.0, 2.0),
                             "karras_schedule: sigma_max is 2.000000, expected above sigma_min for more than one step",
                             value_error);
    }
}
