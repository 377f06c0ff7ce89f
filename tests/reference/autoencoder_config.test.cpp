// SPDX-License-Identifier: MIT
// Tests of the autoencoder's architecture.
#include <genrender/reference/autoencoder_config.hpp>

#include <doctest/doctest.h>

#include <limits>

using namespace genrender;

using namespace genrender::reference;

TEST_SUITE("reference/autoencoder_config") {
    TEST_CASE("a config that cannot be built is told") {
        auto const check = [](auto change, char const* sentence) {
            autoencoder_config config;
            change(config);
            CHECK_THROWS_WITH_AS(require_config(config), sentence, value_error);
        };
        CHECK_NOTHROW(require_config(autoencoder_config{}));
        check([](auto& config) { config.block_out_channels.clear(); },
              "autoencoder_config: block_out_channels.size() is 0, expected 1 to 16");
        check([](auto& config) { config.latent_channels = 0; }, "autoencoder_config: a count is 0, expected above 0");
        check([](auto& config) { config.block_out_channels[1] = 100; },
              "autoencoder_config: block_out_channels is 100, expected multiples of norm_num_groups");
        check([](auto& config) { config.scaling_factor = -1; },
              "autoencoder_config: scaling_factor is -1.000000, expected a finite number above 0");
        check([](auto& config) { config.shift_factor = std::numeric_limits<double>::infinity(); },
              "autoencoder_config: shift_factor is inf, expected a finite number");
    }

    TEST_CASE("pictures must be halved as often as the encoder does") {
        CHECK_NOTHROW(require_picture_grid({}, {8, 24}));
        CHECK_THROWS_WITH_AS(require_picture_grid({}, {12, 24}),
                             "autoencoder_config: height of the picture is 12, expected a multiple of 8 above 0",
                             value_error);
        CHECK_THROWS_WITH_AS(require_picture_grid({}, {8, 0}),
                             "autoencoder_config: width of the picture is 0, expected a multiple of 8 above 0",
                             value_error);
    }
}
