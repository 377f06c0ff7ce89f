// SPDX-License-Identifier: MIT
// Who may be asked to keep the variance of eq. 6.
#include <genrender/attention/kept_variance.hpp>

#include "../injection/dense_equations.hpp"

#include <genrender/injection/host_attention_call.hpp>

#include <doctest/doctest.h>

#include <cstdint>
#include <limits>
#include <vector>

using namespace genrender;
using namespace genrender::testing;

TEST_SUITE("attention/kept_variance") {
    namespace {

    using keeping_call = host_attention_call<double, matrix_module<double>>;

    /// The same call without the capability.
    struct call_without_variance : private keeping_call {
        using keeping_call::attend;
        using keeping_call::f;
        using keeping_call::frames;
        using keeping_call::keeping_call;
        using keeping_call::key;
        using keeping_call::mix;
        using keeping_call::place;
        using keeping_call::query;
        using keeping_call::value;
        using typename keeping_call::features_type;
        using typename keeping_call::real_type;
    };

    } // namespace

    TEST_CASE("a call that cannot is refused where variance is to be kept, and there alone") {
        CHECK(variance_keeping_call<keeping_call>);
        CHECK(attention_call<call_without_variance>);
        CHECK_FALSE(variance_keeping_call<call_without_variance>);
        std::vector<frame_index> const frames{{0}};
        matrix_module<double> const module(4, 2, 11);
        auto const f = random_features<double>({1, 3, 4}, 12);
        std::vector<std::uint32_t> const offsets{0, 2, 3, 3};
        std::vector<std::uint32_t> const sources{0, 1, 2};
        std::vector<double> const weights{0.5, 0.5, 1};
        std::vector<sparse_rows<double>> const rows{{offsets, sources, weights}};
        auto const F_KF = random_features<double>({1, 3, 4}, 13);
        auto const F_hat = [] { return random_features<double>({1, 3, 4}, 14); };
        call_without_variance without({}, frames, f, module);
        keeping_call with({}, frames, f, module);
        auto const mixed = with.mix(F_hat(), F_KF, rows, 0.7);
        CHECK(equal_bits(mixed_features(without, F_hat(), F_KF, rows, 0.7, {}), mixed));
        CHECK(equal_bits(mixed_features(with, F_hat(), F_KF, rows, 0.7, {}), mixed));
        CHECK_FALSE(equal_bits(mixed_features(with, F_hat(), F_KF, rows, 0.7, {variance_target::total}), mixed));
        CHECK_THROWS_WITH_AS(mixed_features(without, F_hat(), F_KF, rows, 0.7, {variance_target::total}),
                             "mixed_features: variance is to be kept, expected variance_target::none for an attention "
                             "call without `mix_keeping_variance`",
                             value_error);
    }
    TEST_CASE("a greatest gain below 1 or that is no number is refused in a sentence") {
        CHECK_NOTHROW(require_kept_variance("here", {variance_target::total, 1}));
        CHECK_THROWS_WITH_AS(require_kept_variance("here", {variance_target::total, 0.5}),
                             "here: most_gain is 0.500000, expected a finite number, 1 or more", value_error);
        CHECK_THROWS_AS(
            require_kept_variance("here", {variance_target::total, std::numeric_limits<double>::quiet_NaN()}),
            value_error);
    }
}
