// SPDX-License-Identifier: MIT
// What is known of 16 bits before a run.
#include <genrender/sampling/storing_denoiser.hpp>

#include <genrender/testing/analytic_denoiser.hpp>

#include <doctest/doctest.h>

#include <optional>

using namespace genrender;

TEST_SUITE("sampling/storing_denoiser") {
    namespace {

    using host = testing::analytic_denoiser<float>;
    struct names_a_storing_call : host {
        using call_type = host_attention_call<float, testing::identity_projections>;
    };
    struct names_another : host {
        using call_type = attention_call_archetype<host_features<float>, float>;
    };
    struct names_nonsense : host {
        using call_type = int;
    };
    struct opaque {};

    // Whether 16 bits for a denoiser of this type compile.
    static_assert(keyframe_storage_for<names_a_storing_call, feature_storage::f16>() == feature_storage::f16);
    static_assert(keyframe_storage_for<host, feature_storage::bf16>() == feature_storage::bf16);
    static_assert(keyframe_storage_for<names_another, feature_storage::same>() == feature_storage::same);
    static_assert(keyframe_storage_for<denoiser_archetype<float, opaque>, feature_storage::f16>() ==
                  feature_storage::f16);

    static_assert(call_naming_denoiser<names_a_storing_call> && call_naming_denoiser<names_another>);
    static_assert(!call_naming_denoiser<host> && !call_naming_denoiser<names_nonsense>);
    static_assert(stores_16_bits<names_a_storing_call>() == true);
    static_assert(stores_16_bits<names_another>() == false);
    static_assert(stores_16_bits<host>() == true);
    static_assert(stores_16_bits<denoiser_archetype<float, opaque>>() == std::nullopt);

    } // namespace

    TEST_CASE("16 bits are refused of a denoiser whose calls have no stored, and of no other") {
        CHECK_THROWS_WITH_AS(require_storage<names_another>(feature_storage::bf16),
                             "render: settings.keyframe_storage is of 16 bits, expected feature_storage::same for a "
                             "denoiser whose call_type has no `stored`",
                             value_error);
        CHECK_NOTHROW(require_storage<names_another>(feature_storage::same));
        CHECK_NOTHROW(require_storage<names_a_storing_call>(feature_storage::f16));
        CHECK_NOTHROW(require_storage<host>(feature_storage::f16));
        CHECK_NOTHROW(require_storage<denoiser_archetype<float, opaque>>(feature_storage::f16));
    }
}
