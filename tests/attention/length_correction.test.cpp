// SPDX-License-Identifier: MIT
// The length-corrected temperature: its numbers, and who may be asked for it.
#include <genrender/attention/length_correction.hpp>

#include "../injection/dense_equations.hpp"

#include <genrender/attention/extended_attention.hpp>
#include <genrender/injection/host_attention_call.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

using namespace genrender;
using namespace genrender::testing;

TEST_SUITE("attention/length_correction") {
    namespace {

    using features = host_features<double>;
    using scaling_call = host_attention_call<double, matrix_module<double>>;

    /// The same call without the capability.
    struct call_without_scales : private scaling_call {
        using scaling_call::attend;
        using scaling_call::f;
        using scaling_call::frames;
        using scaling_call::key;
        using scaling_call::mix;
        using scaling_call::place;
        using scaling_call::query;
        using scaling_call::scaling_call;
        using scaling_call::value;
        using typename scaling_call::features_type;
        using typename scaling_call::real_type;
    };

    std::vector<frame_index> const frames{{0}, {1}};

    } // namespace

    TEST_CASE("by hand: 16 keys where the network has 4 are twice as sharp") {
        CHECK(length_correction(4, 16, 1) == doctest::Approx(2));
        CHECK(length_correction(4, 16, 0.5) == doctest::Approx(std::sqrt(2.0)));
        CHECK(length_correction(256, 1280, 1) == doctest::Approx(1 + std::log(5.0) / std::log(256.0)));
        CHECK(length_correction(16, 4, 1) == doctest::Approx(0.5));
    }
    TEST_CASE("it is 1 to the bit with power 0, with as many keys, and where a logarithm says nothing") {
        CHECK(length_correction(256, 1280, 0) == 1.0);
        CHECK(length_correction(256, 256, 1) == 1.0);
        CHECK(length_correction(1, 5, 1) == 1.0);
        CHECK(length_correction(0, 5, 1) == 1.0);
    }
    TEST_CASE("the odds of a key against n squared keys are the square of those against n") {
        auto const odds = [](double keys, double logit, double scale) { return std::exp(scale * logit) / keys; };
        auto const scale = length_correction(10, 100, 1);
        CHECK(odds(100, 3, scale) == doctest::Approx(odds(10, 3, 1) * odds(10, 3, 1)));
    }
    TEST_CASE("a power that is negative or no number is refused in a sentence") {
        CHECK_THROWS_WITH_AS(length_correction(4, 16, -1),
                             "length_correction: power is -1.000000, expected a finite number, 0 or more", value_error);
        CHECK_THROWS_AS(length_correction(4, 16, std::numeric_limits<double>::quiet_NaN()), value_error);
        CHECK_THROWS_AS(length_correction(4, 16, std::numeric_limits<double>::infinity()), value_error);
    }
    TEST_CASE("the scale of a site is that of its own tokens, and none of a power of 0") {
        std::vector<attention_site> sites(2);
        sites[0].grid = {2, 2};
        sites[1].grid = {16, 16};
        auto const scale_of = length_scale(sites, 1);
        CHECK(scale_of({0}, 4) == doctest::Approx(2));
        CHECK(scale_of({0}, 1) == 1.0);
        CHECK(scale_of({1}, 5) == length_correction(256, 1280, 1));
        CHECK_FALSE(length_scale(sites, 0));
    }
    TEST_CASE("each frame is scaled by the blocks that it attends to") {
        int const K = 0;
        attention_sources<int> sources(2);
        sources[0] = {{&K, &K, 0}};
        sources[1] = {{&K, &K, 0}, {&K, &K, 1}, {&K, &K, 2}};
        scale_by_length(sources, {7}, [](site_index site, std::size_t joined) {
            CHECK(site == site_index{7});
            return static_cast<double>(joined);
        });
        CHECK(sources.scale(0) == 1);
        CHECK(sources.scale(1) == 3);
        auto same = sources;
        scale_by_length(same, {7}, {});
        CHECK(same.scale(1) == 3);
    }
    TEST_CASE("a call without scales is refused where something is scaled, and there alone") {
        CHECK(scaling_attention_call<scaling_call>);
        CHECK(attention_call<call_without_scales>);
        CHECK_FALSE(scaling_attention_call<call_without_scales>);
        matrix_module<double> const module(4, 2, 11);
        auto const f = random_features<double>({2, 5, 4}, 12);
        call_without_scales without({}, frames, f, module);
        scaling_call with({}, frames, f, module);
        auto const Q = with.query(f);
        auto const K = with.key(f);
        auto const V = with.value(f);
        auto sources = extended_attention_sources(K, V, 2);
        CHECK(equal_bits(attend_scaled(without, Q, sources), with.attend(Q, sources)));
        sources.set_scales({1, 1});
        CHECK(equal_bits(attend_scaled(without, Q, sources), with.attend(Q, sources)));
        sources.set_scales({1, 1.5});
        CHECK_THROWS_WITH_AS(attend_scaled(without, Q, sources),
                             "attend_scaled: logits are scaled, expected a length_correction of 0 for an attention "
                             "call without `scales_logits`",
                             value_error);
        CHECK_NOTHROW(attend_scaled(with, Q, sources));
    }
}
