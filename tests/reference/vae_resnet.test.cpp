// SPDX-License-Identifier: MIT
// Tests of the autoencoder's residual block.
#include <genrender/reference/vae_resnet.hpp>

#include "small_vae.hpp"

#include <doctest/doctest.h>

#include <cstddef>
#include <utility>

using namespace genrender;

using namespace genrender::reference;
using namespace genrender::testing;

TEST_SUITE("reference/vae_resnet") {
    template <class Real>
    void check_vae_resnet(std::size_t in, std::size_t out, bool has_spare) {
        autoencoder_config config;
        config.norm_num_groups = 4;
        auto source = weights<Real>::seeded(1, "test");
        vae_resnet<Real> const block(config, source, "r", in, out);
        CHECK(block.out_channels() == out);
        grid_extents const grid{6, 5};
        for (std::size_t const bytes : {1U, 700U, 100000U}) {
            auto x = random_map<Real>(grid, has_spare ? 2 * in : in, 3);
            x.keep_channels(x.channels() - in, in);
            auto const expected = plain_vae_resnet<Real>(source, "r", std::as_const(x).view(), grid, out);
            auto const y = block(std::move(x), {{}, bytes});
            CHECK(y.grid() == grid);
            CHECK(y.channels() == out);
            check_close<Real const, 2>(y.view(), expected);
        }
    }

    TEST_CASE_TEMPLATE("a block is the sum of its branch and its input", Real, float, double) {
        check_vae_resnet<Real>(8, 8, false);
        check_vae_resnet<Real>(8, 8, true);
    }

    TEST_CASE_TEMPLATE("a block that changes the channels projects its input", Real, float, double) {
        check_vae_resnet<Real>(8, 12, false);
        check_vae_resnet<Real>(12, 8, false);
    }

    TEST_CASE_TEMPLATE("a block that halves the channels does so in its input's memory", Real, float, double) {
        check_vae_resnet<Real>(16, 8, false);
        check_vae_resnet<Real>(24, 8, false);
        autoencoder_config config;
        config.norm_num_groups = 4;
        auto source = weights<Real>::seeded(1, "test");
        vae_resnet<Real> const block(config, source, "r", 16, 8);
        auto x = random_map<Real>({6, 5}, 16, 3);
        auto const* const memory = x.view().data();
        auto const y = block(std::move(x), {});
        CHECK(y.view().data() == memory);
        CHECK(y.spare_size() == y.size());
    }
}
