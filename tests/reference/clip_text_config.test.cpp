// SPDX-License-Identifier: MIT
// Tests of the text encoder's architecture.
#include <genrender/reference/clip_text_config.hpp>

#include <doctest/doctest.h>

using namespace genrender;

using namespace genrender::reference;

TEST_SUITE("reference/clip_text_config") {
    TEST_CASE("a config that cannot be built is told") {
        auto const check = [](auto change, char const* sentence) {
            clip_text_config config;
            change(config);
            CHECK_THROWS_WITH_AS(require_config(config), sentence, value_error);
        };
        CHECK_NOTHROW(require_config(clip_text_config{}));
        check([](auto& config) { config.vocab_size = 0; }, "clip_text_config: a count is 0, expected above 0");
        check([](auto& config) { config.num_attention_heads = 5; },
              "clip_text_config: num_attention_heads is 5, expected a divisor of hidden_size");
        check([](auto& config) { config.layer_norm_eps = 1; },
              "clip_text_config: layer_norm_eps is 1.000000, expected a number in (0, 1)");
    }
}
