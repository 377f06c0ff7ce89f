// SPDX-License-Identifier: MIT
// A call ends behind the last wanted site, which has run.
#include <genrender/reference/stopping_processor.hpp>

#include <genrender/attention/plain_attention.hpp>
#include <genrender/reference/attention_matrices.hpp>
#include <genrender/reference/weights.hpp>

#include <doctest/doctest.h>

#include <array>
#include <cstdint>

TEST_SUITE("reference/stopping_processor") {
    using namespace genrender;
    using namespace genrender::reference;

    TEST_CASE("sites before the last run on and the last ends the call after it ran") {
        std::array<frame_index, 1> const frames{{{0}}};
        auto const f = host_features<float>::allocate({1, 2, 8});
        auto source = weights<float>::seeded(1, "unet");
        attention_matrices<float> const module(source, "attn1", 8, 8, 2);
        std::uint32_t runs = 0;
        auto const counted = [&](auto& call) {
            ++runs;
            return plain_attention{}(call);
        };
        internal::stopping_processor<float> const stopping{counted, {1}};
        any_processor<float>::call_type before({{0}, 0}, frames, f, module);
        CHECK(stopping(before).extents() == f.extents());
        any_processor<float>::call_type last({{1}, 0}, frames, f, module);
        CHECK_THROWS_AS(stopping(last), internal::last_site_has_run);
        CHECK(runs == 2);
    }
}
