// SPDX-License-Identifier: MIT
// A call ends behind the last wanted site, which has run.
#include <genrender/reference/stopping_processor.hpp>

#include <genrender/attention/plain_attention.hpp>
#include <support/analytic_denoiser.hpp>

#include <doctest/doctest.h>

#include <array>
#include <cstdint>

TEST_SUITE("reference/stopping_processor") {
    using namespace genrender;
    using namespace genrender::reference;

    TEST_CASE("sites before the last run on and the last ends the call after it ran") {
        std::array<frame_index, 1> const frames{{{0}}};
        auto const f = host_features<float>::allocate({1, 2, 3});
        testing::identity_projections const module;
        std::uint32_t runs = 0;
        auto const counted = [&](auto& call) {
            ++runs;
            return plain_attention{}(call);
        };
        internal::stopping_processor<decltype(counted)> const stopping{&counted, {1}};
        host_attention_call<float, testing::identity_projections> before({{0}, 0}, frames, f, module);
        CHECK(stopping(before).extents() == f.extents());
        host_attention_call<float, testing::identity_projections> last({{1}, 0}, frames, f, module);
        CHECK_THROWS_AS(stopping(last), internal::last_site_has_run);
        CHECK(runs == 2);
    }
}
