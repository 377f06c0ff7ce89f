// SPDX-License-Identifier: MIT
// Tests of the embedding of time.
#include <genrender/reference/time_embedding.hpp>

#include "small_networks.hpp"

#include <doctest/doctest.h>

using namespace genrender;

using namespace genrender::reference;
using namespace genrender::testing;

TEST_SUITE("reference/time_embedding") {
    TEST_CASE_TEMPLATE("cosines come first and frequencies fall from 1", Real, float, double) {
        auto const features = sinusoids(Real(3), 4);
        CHECK(features.size() == 4);
        CHECK(static_cast<double>(features[0]) == doctest::Approx(std::cos(3.0)));
        CHECK(static_cast<double>(features[1]) == doctest::Approx(std::cos(0.03)));
        CHECK(static_cast<double>(features[2]) == doctest::Approx(std::sin(3.0)));
        CHECK(static_cast<double>(features[3]) == doctest::Approx(std::sin(0.03)));
    }

    TEST_CASE_TEMPLATE("the embedding is SiLU after each of two layers", Real, float, double) {
        auto const config = small_config();
        auto source = weights<Real>::seeded(1, "test");
        time_embedding<Real> const embedding(config, source);
        auto const apply = [&](std::vector<Real> in, std::string const& name) {
            auto const out = plain_linear<Real>(strided_view<Real const, 2>(in.data(), {1, in.size()}),
                                                source.take(name + ".weight", {32, in.size()}),
                                                source.take(name + ".bias", {32}), 32);
            std::vector<Real> result(out.data(), out.data() + 32);
            for (auto& x : result) {
                x = x / (1 + std::exp(-x));
            }
            return result;
        };
        auto const expected =
            apply(apply(sinusoids(Real(417.5), 8), "time_embedding.linear_1"), "time_embedding.linear_2");
        auto const found = embedding(Real(417.5));
        check_close<Real const, 1>(strided_view<Real const, 1>(found.data(), {found.size()}),
                                   strided_view<Real const, 1>(expected.data(), {expected.size()}));
    }
}
