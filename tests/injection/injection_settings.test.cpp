// SPDX-License-Identifier: MIT
// [GR eq. 5, 6] The paper's values.
#include <genrender/injection/injection_settings.hpp>

#include <doctest/doctest.h>

using namespace genrender;

TEST_SUITE("injection/injection_settings") {
    TEST_CASE("[GR sec. 4: Implementation details] the defaults are the paper's") {
        injection_settings const settings;
        CHECK(settings.pre_attention);
        CHECK(settings.post_attention);
        CHECK(settings.keeps_own_copy);
        CHECK(paper_alpha == 0.7);
    }
}
