// SPDX-License-Identifier: MIT
// Tests of the autoencoder's attention.
#include <genrender/reference/vae_attention.hpp>

#include "small_vae.hpp"

#include <doctest/doctest.h>

#include <utility>

using namespace genrender;

using namespace genrender::reference;
using namespace genrender::testing;

TEST_SUITE("reference/vae_attention") {
    TEST_CASE_TEMPLATE("attention is that of one head over the normalised tokens, added to them", Real, float, double) {
        auto source = weights<Real>::seeded(1, "test");
        vae_attention<Real> const attention(small_vae_config(), source, "a", 8);
        for (auto const& loop : {any_loop{}, any_loop(threaded_loop(3))}) {
            auto x = random_map<Real>({3, 5}, 8, 3);
            auto const expected = plain_vae_attention<Real>(source, "a", std::as_const(x).view());
            attention(x, {loop});
            check_close<Real, 2>(x.view(), expected);
        }
    }

    TEST_CASE("a map of other channels is told") {
        auto source = weights<float>::seeded(1, "test");
        vae_attention<float> const attention(small_vae_config(), source, "a", 8);
        auto x = random_map<float>({3, 5}, 4, 3);
        CHECK_THROWS_WITH_AS(attention(x, {}), "group_norm: in is [15, 4], expected [15, 8]", shape_error);
    }
}
