// SPDX-License-Identifier: MIT
// Tests of the pointwise functions.
#include <genrender/reference/activation.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <type_traits>
#include <vector>

using namespace genrender;

using namespace genrender::reference;

TEST_SUITE("reference/activation") {
    TEST_CASE_TEMPLATE("SiLU is x over 1 + exp(-x)", Real, float, double) {
        std::vector<Real> values;
        for (int i = -300; i <= 300; ++i) {
            values.push_back(static_cast<Real>(i) / 10);
        }
        auto result = values;
        silu<Real>(result);
        for (std::size_t i = 0; i < values.size(); ++i) {
            auto const x = static_cast<double>(values[i]);
            CHECK(static_cast<double>(result[i]) == doctest::Approx(x / (1 + std::exp(-x))).epsilon(1e-5));
        }
        CHECK(result[300] == 0);
    }

    TEST_CASE_TEMPLATE("SiLU of far values is 0 or the value itself", Real, float, double) {
        std::vector<Real> values{-1000, 1000};
        silu<Real>(values);
        CHECK(std::abs(values[0]) < Real(1e-30));
        CHECK(values[1] == 1000);
    }

    TEST_CASE_TEMPLATE("SiLU of an element is the same to the bit wherever it lies", Real, float, double) {
        std::vector<Real> values(200);
        for (std::size_t i = 0; i < values.size(); ++i) {
            values[i] = Real(0.1) * static_cast<Real>(i % 40) - 2;
        }
        for (std::size_t begin = 0; begin < 9; ++begin) {
            auto copy = values;
            silu(std::span<Real>(copy).subspan(begin, 40 + begin));
            std::vector<Real> alone{values[begin + 3]};
            silu<Real>(alone);
            CHECK(copy[begin + 3] == alone[0]);
        }
    }

    TEST_CASE_TEMPLATE("GELU and its stand-in replace each value at any size", Real, float, double) {
        auto const bound = std::is_same_v<Real, float> ? 1e-6 : 1e-14;
        for (std::size_t size = 1; size < 70; ++size) {
            std::vector<Real> values(size);
            for (std::size_t i = 0; i < size; ++i) {
                values[i] = Real(0.37) * static_cast<Real>(i * 29 % 41) - Real(7);
            }
            auto exact = values;
            auto quick = values;
            gelu(std::span(exact));
            quick_gelu(std::span(quick));
            for (std::size_t i = 0; i < size; ++i) {
                auto const x = static_cast<double>(values[i]);
                REQUIRE(std::abs(static_cast<double>(exact[i]) - x * 0.5 * std::erfc(-x / std::sqrt(2.0))) <=
                        bound * std::max(1.0, std::abs(x)));
                REQUIRE(std::abs(static_cast<double>(quick[i]) - x / (1 + std::exp(-1.702 * x))) <=
                        bound * std::max(1.0, std::abs(x)));
            }
        }
        std::vector<Real> far{-1000, 1000};
        quick_gelu(std::span(far));
        CHECK(std::abs(far[0]) < Real(1e-30));
        CHECK(far[1] == doctest::Approx(1000).epsilon(1e-6));
    }

    TEST_CASE_TEMPLATE("gating by GELU agrees with the error function at any size and value", Real, float, double) {
        auto const bound = std::is_same_v<Real, float> ? 3e-7 : 1e-15;
        for (std::size_t size = 1; size < 40; ++size) {
            std::vector<Real> gates(size);
            for (std::size_t i = 0; i < size; ++i) {
                gates[i] = Real(0.37) * static_cast<Real>(i * 29 % 41) - Real(7);
            }
            std::vector<Real> values(size, Real(2));
            gate_by_gelu<Real>(values, gates);
            for (std::size_t i = 0; i < size; ++i) {
                auto const b = static_cast<double>(gates[i]);
                auto const expected = b * std::erfc(-b / std::sqrt(2.0));
                REQUIRE(std::abs(static_cast<double>(values[i]) - expected) <=
                        bound * std::max(1.0, std::abs(expected)));
            }
        }
        for (int i = -4000; i <= 4000; ++i) {
            auto const x = static_cast<Real>(i) / 250;
            auto const expected = static_cast<double>(x) * 0.5 * std::erfc(-static_cast<double>(x) / std::sqrt(2.0));
            REQUIRE(std::abs(static_cast<double>(gelu(x)) - expected) <= bound * std::max(1.0, std::abs(expected)));
        }
        CHECK(std::abs(gelu(Real(-1000))) < Real(1e-30));
        CHECK(gelu(Real(1000)) == 1000);
        CHECK(std::isnan(gelu(std::numeric_limits<Real>::quiet_NaN())));
    }

    TEST_CASE_TEMPLATE("GELU is x times the normal distribution function", Real, float, double) {
        CHECK(gelu(Real(0)) == 0);
        CHECK(static_cast<double>(gelu(Real(1))) == doctest::Approx(0.8413447460685429).epsilon(1e-6));
        CHECK(static_cast<double>(gelu(Real(-1))) == doctest::Approx(-0.15865525393145707).epsilon(1e-6));
        for (auto const x : {Real(0.3), Real(2), Real(5)}) {
            CHECK(static_cast<double>(gelu(x) - gelu(-x)) == doctest::Approx(static_cast<double>(x)).epsilon(1e-6));
        }
    }
}
