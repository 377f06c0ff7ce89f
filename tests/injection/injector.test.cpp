// SPDX-License-Identifier: MIT
// [GR alg. 1: Phi(z^i, D^i, c, f_KF, F_bar^i)] The injected pass against equations 1, 2, 5 and 6 written down plainly.
#include <genrender/injection/injector.hpp>
#include "../support/plans_of.hpp"

#include <genrender/attention/attention_processor.hpp>
#include <genrender/core/parallel.hpp>
#include <genrender/injection/host_attention_call.hpp>
#include <genrender/keyframes/recorder.hpp>

#include "dense_equations.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

using namespace genrender;
using namespace genrender::testing;

TEST_SUITE("injection/injector") {
    namespace {

    constexpr std::size_t tokens = 13;
    constexpr std::size_t channels = 8;
    std::vector<frame_index> const KF{{6}, {1}, {4}};
    std::vector<frame_index> const frames{{3}, {4}, {0}, {6}}; // two of them are keyframes
    std::vector<std::size_t> const all_keyframes{0, 1, 2};

    template <class Real>
    using call_of = host_attention_call<Real, matrix_module<Real>>;

    /// A recorded keyframe pass and a plan for every frame and site.
    template <class Real>
    struct recorded_world {
        matrix_module<Real> module{channels, 2, 11};
        host_features<Real> f_KF = random_features<Real>({KF.size(), tokens, channels}, 12);
        host_features<Real> f = random_features<Real>({frames.size(), tokens, channels}, 13);
        host_features<Real> F_KF;
        feature_bank<host_features<Real>> bank{3, 2};
        std::vector<random_plan<Real>> plans;

        /// Records the place of site 1 and `branch` alone.
        explicit recorded_world(std::uint32_t branch = 0) {
            recorder<host_features<Real>> const pass(bank, [](attention_place place) { return place.site.value == 1; });
            call_of<Real> call({{1}, branch}, KF, f_KF, module);
            F_KF = pass(call);
            for (std::uint64_t seed = 0; seed < 24; ++seed) {
                plans.emplace_back(tokens, KF.size(), 20 + seed);
            }
        }
        random_plan<Real> const& plan(site_index site, frame_index frame) const {
            return plans[8 * site.value + frame.value];
        }

        blend_plans<Real> planned() const {
            std::vector<frame_index> const all{{0}, {1}, {2}, {3}, {4}, {5}, {6}, {7}};
            return plans_of<Real>(3, all, [this](site_index s, frame_index i) { return plan(s, i).rows(); });
        }
        injector<host_features<Real>, Real> inject(injection_settings settings = {}) const {
            return {bank, KF, planned(), settings};
        }
        injector<host_features<Real>, Real> inject(std::function<Real(site_index)> alpha) const {
            return {bank, KF, planned(), {}, std::move(alpha)};
        }
        call_of<Real> call(attention_place place) const { return {place, frames, f, module}; }

        /// F_out of entry i at site 1 by the equations, joining the keyframes `joined`, with this alpha.
        token_rows expected(std::size_t i, std::vector<std::size_t> const& joined, double alpha) const {
            auto const own = joined_rows(f, {i});
            auto sources = own;
            auto const others = joined_rows(f_KF, joined);
            sources.insert(sources.end(), others.begin(), others.end());
            return dense_mix(dense_self_attention(module, own, sources), joined_rows(F_KF, all_keyframes),
                             plan({1}, frames[i]).rows(), alpha);
        }
    };

    template <class Real>
    constexpr double tolerance = sizeof(Real) == 4 ? 1e-5 : 1e-13;

    constexpr attention_place taken{{1}, 0};

    } // namespace

    TEST_CASE("an injector is an attention processor") {
        CHECK(attention_processor<injector<int, float> const, attention_call_archetype<int, float>>);
        CHECK_FALSE(attention_processor<injector<int, float> const, attention_call_archetype<char const*, float>>);
    }

    TEST_CASE_TEMPLATE("[GR eq. 1-6] the injected pass equals its equations written plainly", Real, float, double) {
        recorded_world<Real> const world;
        auto const inject = world.inject();
        auto call = world.call(taken);
        auto const F = inject(call);
        for (std::size_t i = 0; i < frames.size(); ++i) {
            CHECK(greatest_difference(F, i, world.expected(i, all_keyframes, 0.7)) < tolerance<Real>);
        }
    }

    TEST_CASE_TEMPLATE("[GR eq. 5] a keyframe without its own copy joins the others alone", Real, float, double) {
        recorded_world<Real> const world;
        injection_settings settings;
        settings.keeps_own_copy = false;
        auto const inject = world.inject(settings);
        auto call = world.call(taken);
        auto const F = inject(call);
        std::vector<std::vector<std::size_t>> const joined{{0, 1, 2}, {0, 1}, {0, 1, 2}, {1, 2}};
        for (std::size_t i = 0; i < frames.size(); ++i) {
            CHECK(greatest_difference(F, i, world.expected(i, joined[i], 0.7)) < tolerance<Real>);
        }
        CHECK(greatest_difference(F, 1, world.expected(1, all_keyframes, 0.7)) > 1e-3);
        CHECK(inject.left_out({3}) == std::nullopt);
        CHECK(inject.left_out({4}) == 2);
        CHECK(inject.left_out({6}) == 0);
        CHECK(world.inject().left_out({4}) == std::nullopt);
    }

    TEST_CASE("[GR eq. 5] without pre-attention injection a frame attends to itself alone") {
        recorded_world<double> const world;
        injection_settings settings;
        settings.pre_attention = false;
        auto const inject = world.inject(settings);
        auto call = world.call(taken);
        auto const F = inject(call);
        for (std::size_t i = 0; i < frames.size(); ++i) {
            CHECK(greatest_difference(F, i, world.expected(i, {}, 0.7)) < 1e-13);
        }
        CHECK(inject.joined_features(taken) == nullptr);
    }

    TEST_CASE("[GR eq. 6] without post-attention injection nothing is mixed and no plan is asked for") {
        recorded_world<double> const world;
        injection_settings settings;
        settings.post_attention = false;
        injector<host_features<double>, double> const inject(world.bank, KF, {}, settings); // no plans at all
        auto call = world.call(taken);
        auto const F = inject(call);
        for (std::size_t i = 0; i < frames.size(); ++i) {
            CHECK(greatest_difference(F, i, world.expected(i, all_keyframes, 0)) < 1e-13);
        }
        CHECK(inject.blended_features(taken) == nullptr);
    }

    TEST_CASE("without both the network stays as it is") {
        recorded_world<double> const world;
        injection_settings settings;
        settings.pre_attention = false;
        settings.post_attention = false;
        auto call = world.call(taken);
        CHECK(equal_bits(world.inject(settings)(call), plain_attention{}(call)));
    }

    TEST_CASE("places that the bank does not hold stay plain") {
        recorded_world<double> const world;
        auto const inject = world.inject();
        for (auto const place : {attention_place{{0}, 0}, attention_place{{2}, 0}, attention_place{{1}, 1}}) {
            auto call = world.call(place);
            CHECK(equal_bits(inject(call), plain_attention{}(call)));
            CHECK(inject.joined_features(place) == nullptr);
            CHECK(inject.blended_features(place) == nullptr);
        }
    }

    TEST_CASE("each guidance branch takes its own features") {
        recorded_world<double> world(0);
        auto const f_other = random_features<double>({KF.size(), tokens, channels}, 99);
        recorder<host_features<double>> const pass(world.bank, [](attention_place) { return true; });
        call_of<double> keyframe_call({{1}, 1}, KF, f_other, world.module);
        auto const F_other = pass(keyframe_call);
        auto const inject = world.inject();
        auto call = world.call(taken);
        auto other_call = world.call({{1}, 1});
        auto const F = inject(call);
        auto const other = inject(other_call);
        CHECK(greatest_difference(F, 0, world.expected(0, all_keyframes, 0.7)) < 1e-13);
        world.f_KF = f_other;
        world.F_KF = F_other;
        CHECK(greatest_difference(other, 0, world.expected(0, all_keyframes, 0.7)) < 1e-13);
        CHECK(greatest_difference(F, 0, world.expected(0, all_keyframes, 0.7)) > 1e-3);
    }

    TEST_CASE("[GR eq. 6] alpha is the one of the site and 0 and 1 are exact") {
        recorded_world<double> const world;
        auto call = world.call(taken);
        auto const F = world.inject([](site_index site) { return site.value == 1 ? 0.25 : 0.9; })(call);
        CHECK(greatest_difference(F, 2, world.expected(2, all_keyframes, 0.25)) < 1e-13);

        auto const F_bar = world.inject([](site_index) { return 1.0; })(call);
        CHECK(greatest_difference(F_bar, 2, world.expected(2, all_keyframes, 1)) < 1e-13);

        auto const F_hat = world.inject([](site_index) { return 0.0; })(call);
        injection_settings settings;
        settings.post_attention = false;
        CHECK(equal_bits(F_hat, world.inject(settings)(call)));
    }

    TEST_CASE("a frame is injected alike alone and in a stack") {
        recorded_world<double> const world;
        auto const inject = world.inject();
        auto call = world.call(taken);
        auto const together = inject(call);
        for (std::size_t i = 0; i < frames.size(); ++i) {
            std::vector<frame_index> const one{frames[i]};
            call_of<double> alone(taken, one, host_features<double>(world.f.view().slice(i, 1)), world.module);
            auto const F = inject(alone);
            CHECK(greatest_difference(F, 0, joined_rows(together, {i})) == 0);
        }
    }

    TEST_CASE("keys and values of keyframes are projected by the recorder alone") {
        recorded_world<double> const world;
        auto const before = world.module.keys.load();
        CHECK(before == KF.size());
        auto call = world.call(taken);
        world.inject()(call);
        CHECK(world.module.keys == before + frames.size());
        CHECK(world.module.values == before + frames.size());
    }

    TEST_CASE("calls for different frames may run at the same time") {
        recorded_world<double> const world;
        auto const inject = world.inject();
        auto call = world.call(taken);
        auto const together = inject(call);
        std::vector<double> differences(64);
        threaded_loop{4}(64, [&](std::size_t at) {
            auto const i = at % frames.size();
            std::vector<frame_index> const one{frames[i]};
            call_of<double> alone(taken, one, host_features<double>(world.f.view().slice(i, 1)), world.module);
            differences[at] = greatest_difference(inject(alone), 0, joined_rows(together, {i}));
        });
        for (auto const difference : differences) {
            CHECK(difference == 0);
        }
    }

    TEST_CASE("features recorded the other way are refused in a sentence") {
        recorded_world<double> const world;
        CHECK_THROWS_WITH_AS(world.inject().joined_features(taken),
                             "injector: f_KF is missing, expected keyframes recorded by record_features", value_error);
        feature_bank<host_features<double>> bank(3, 2);
        recorder<host_features<double>> const pass(bank, [](attention_place) { return true; });
        pass.record(taken, world.f_KF, world.F_KF);
        injector<host_features<double>, double> const inject(bank, KF, world.planned());
        auto call = world.call(taken);
        CHECK_THROWS_WITH_AS(inject(call), "injector: K_KF is missing, expected keyframes recorded by callbacks",
                             value_error);
        CHECK(inject.joined_features(taken)->view().data() == world.f_KF.view().data());
        CHECK(inject.blended_features(taken)->view().data() == world.F_KF.view().data());
    }

    TEST_CASE_TEMPLATE("[GR eq. 5, 6] features kept in 16 bits change F_out by their rounding alone", Real, float,
                       double) {
        recorded_world<Real> const exact;
        auto const run = [](recorded_world<Real> const& world) {
            auto call = world.call({{1}, 0});
            return world.inject()(call);
        };
        auto const expected = run(exact);
        for (auto const& [storage, unit] :
             {std::pair(feature_storage::f16, 0x1p-11), {feature_storage::bf16, 0x1p-8}}) {
            recorded_world<Real> world;
            recorder<host_features<Real>> const pass(
                world.bank, [](attention_place place) { return place.site.value == 1; }, true, storage);
            call_of<Real> keyframes({{1}, 0}, KF, world.f_KF, world.module);
            pass(keyframes);
            auto const found = run(world);
            double worst = 0;
            double largest = 0;
            for (std::size_t e = 0; e < found.view().size(); ++e) {
                worst =
                    std::max(worst, std::abs(static_cast<double>(found.view().data()[e] - expected.view().data()[e])));
                largest = std::max(largest, std::abs(static_cast<double>(expected.view().data()[e])));
            }
            // A logit of some units moves by as many roundings, a weight by that share, values by one more.
            CHECK(worst <= 8 * unit * largest);
            CHECK(worst > 0);
        }
    }

    TEST_CASE("a bank of another number of keyframes is refused in a sentence") {
        recorded_world<float> const world;
        auto call = world.call(taken);
        std::vector<frame_index> const four{{6}, {1}, {4}, {5}};
        injector<host_features<float>, float> const pass(world.bank, four, world.planned());
        CHECK_THROWS_WITH_AS(pass(call), "pre_attention_sources: K_KF is [3, 13, 8], expected [4, 13, 8]", shape_error);
    }

    TEST_CASE("it is plain where the bank holds nothing") {
        recorded_world<float> const world;
        auto const pass = world.inject();
        CHECK(is_plain_at(pass, {{0}, 0}));
        CHECK(is_plain_at(pass, {{1}, 1}));
        CHECK_FALSE(is_plain_at(pass, {{1}, 0}));
        auto call = world.call({{0}, 0});
        CHECK(equal_bits(pass(call), plain_attention{}(call)));
    }
    TEST_CASE("logits are scaled by the number of frames that are joined, a frame each") {
        recorded_world<double> world;
        injection_settings settings;
        settings.keeps_own_copy = false;
        auto const by_count = [](site_index site, std::size_t joined) {
            CHECK(site == site_index{1});
            return 1 + 0.5 * static_cast<double>(joined);
        };
        auto const with_scales = [&](injection_settings of) {
            return injector<host_features<double>, double>(
                world.bank, KF, world.planned(), of, [](site_index) { return 0.7; }, by_count);
        };
        auto call = world.call(taken);
        auto const F = with_scales(settings)(call);
        CHECK(with_scales(settings).scales(taken, frames) == std::vector<double>{3, 2.5, 3, 2.5});
        CHECK(with_scales(settings).scales({{0}, 0}, frames).empty());
        std::vector<std::vector<std::size_t>> const joined{{0, 1, 2}, {0, 1}, {0, 1, 2}, {1, 2}};
        auto const plain_queries = world.module.W_Q;
        for (std::size_t i = 0; i < frames.size(); ++i) {
            for (std::size_t e = 0; e < plain_queries.size(); ++e) {
                world.module.W_Q.data()[e] = plain_queries.data()[e] * by_count({1}, 1 + joined[i].size());
            }
            CHECK(greatest_difference(F, i, world.expected(i, joined[i], 0.7)) < 1e-12);
        }
        world.module.W_Q = plain_queries;
        CHECK(greatest_difference(F, 0, world.expected(0, joined[0], 0.7)) > 1e-3);
        settings.pre_attention = false; // A frame alone is as the network has it.
        injector<host_features<double>, double> const never_joined(
            world.bank, KF, world.planned(), settings, [](site_index) { return 0.7; },
            [](site_index, std::size_t count) { return static_cast<double>(count); });
        CHECK(equal_bits(never_joined(call), world.inject(settings)(call)));
        CHECK(never_joined.scales(taken, frames).empty());
    }

    TEST_CASE("[GR eq. 6] the variance that settings tell is kept") {
        recorded_world<double> const world;
        auto call = world.call(taken);
        injection_settings settings;
        settings.post_attention = false;
        auto const F_hat = world.inject(settings)(call);
        settings.post_attention = true;
        settings.variance.target = variance_target::total;
        auto const F = world.inject(settings)(call);
        for (std::size_t i = 0; i < frames.size(); ++i) {
            mix_rows_keeping_variance(F_hat.view()[i], in_view<double, 3>(world.F_KF.view()),
                                      world.plan({1}, frames[i]).rows(), 0.7, settings.variance);
        }
        CHECK(equal_bits(F, F_hat));
        CHECK_FALSE(equal_bits(F, world.inject()(call)));
    }
    TEST_CASE("keys of one surface point count together for one where settings say so") {
        recorded_world<double> const world;
        injection_settings settings;
        settings.post_attention = false;
        auto const uncounted = world.inject(settings);
        settings.counts_points = true;
        auto const counted = world.inject(settings);
        auto call = world.call(taken);
        auto const F = counted(call);
        auto const K = call.key(call.f());
        auto const V = call.value(call.f());
        auto const& kept = *world.bank.find(taken);
        for (std::size_t i = 0; i < frames.size(); ++i) {
            auto const counts = point_counts(world.plan({1}, frames[i]).rows(), KF.size());
            std::vector<double> const numbers(counts.begin(), counts.end());
            std::vector<key_value_view<double>> blocks;
            auto const add = [&](auto const& keys, auto const& values, std::size_t frame) {
                blocks.push_back({keys.view()[frame], values.view()[frame],
                                  strided_view<double const, 1>(numbers.data() + blocks.size() * tokens, {tokens})});
            };
            add(K, V, i);
            for (std::size_t k = 0; k < KF.size(); ++k) {
                add(*kept.K_KF, *kept.V_KF, k);
            }
            stack<double, 2> expected({tokens, channels});
            scaled_dot_product(expected.view(), call.query(call.f()).view()[i], blocks, 2);
            for (std::size_t t = 0; t < tokens; ++t) {
                for (std::size_t c = 0; c < channels; ++c) {
                    CHECK(F.view()(i, t, c) == doctest::Approx(expected(t, c)).epsilon(1e-12));
                }
            }
        }
        CHECK(counted.counts_keys(taken));
        CHECK_FALSE(counted.counts_keys({{0}, 0}));
        CHECK_FALSE(uncounted.counts_keys(taken));
        CHECK_FALSE(equal_bits(F, uncounted(call)));
    }
}
