// SPDX-License-Identifier: MIT
// [GR alg. 1: f_KF, F_KF] The keyframe pass: extended attention where places take part, features kept once.
#include <genrender/keyframes/recorder.hpp>

#include <genrender/attention/attention_processor.hpp>
#include <genrender/core/parallel.hpp>
#include <genrender/injection/host_attention_call.hpp>

#include <doctest/doctest.h>

#include "support/matrix_module.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

using namespace genrender;
using genrender::testing::matrix_module;
using genrender::testing::random_stack;

TEST_SUITE("keyframes/recorder") {
    namespace {

    using features = host_features<double>;
    using module_type = matrix_module<double>;
    using call_type = host_attention_call<double, module_type>;

    constexpr std::size_t keyframes = 3;
    constexpr std::size_t tokens = 5;
    constexpr std::size_t channels = 4;
    std::vector<frame_index> const drawn{{7}, {2}, {4}};

    bool always(attention_place) { return true; }
    bool never(attention_place) { return false; }

    bool equal_bits(features const& a, features const& b) {
        return a.extents() == b.extents() &&
               std::equal(a.view().data(), a.view().data() + a.view().size(), b.view().data());
    }

    /// Features that are contiguous and the handle's own.
    features input(std::uint64_t seed) {
        auto const f = features::allocate({keyframes, tokens, channels});
        auto const values = random_stack<double, 3>({keyframes, tokens, channels}, seed);
        copy(f.view(), values.view());
        return f;
    }

    features extended(call_type const& call) {
        auto const K = call.key(call.f());
        auto const V = call.value(call.f());
        return call.attend(call.query(call.f()), extended_attention_sources(K, V, keyframes));
    }

    } // namespace

    TEST_CASE("[GR alg. 1] a place that takes part attends over all keyframes and is kept") {
        module_type const module(channels, 2, 1);
        feature_bank<features> bank(2, 1);
        recorder<features> const pass(bank, always);
        call_type call({{1}, 0}, drawn, input(3), module);
        auto const F = pass(call);
        CHECK(equal_bits(F, extended(call)));

        auto const* const kept = bank.find({{1}, 0});
        REQUIRE(kept != nullptr);
        REQUIRE(kept->K_KF.has_value());
        REQUIRE(kept->V_KF.has_value());
        REQUIRE(kept->F_KF.has_value());
        CHECK_FALSE(kept->f_KF.has_value());
        CHECK(equal_bits(*kept->K_KF, call.key(call.f())));
        CHECK(equal_bits(*kept->V_KF, call.value(call.f())));
        CHECK(equal_bits(*kept->F_KF, F));
        CHECK(bank.find({{0}, 0}) == nullptr);
    }

    TEST_CASE("[GR alg. 1] K_KF and V_KF are projected exactly once per keyframe and place") {
        module_type const module(channels, 1, 1);
        feature_bank<features> bank(1, 1);
        recorder<features> const pass(bank, always);
        call_type call({}, drawn, input(3), module);
        pass(call);
        CHECK(module.queries == keyframes);
        CHECK(module.keys == keyframes);
        CHECK(module.values == keyframes);
    }

    TEST_CASE("places that the filter leaves out keep plain attention and leave nothing in the bank") {
        module_type const module(channels, 2, 1);
        feature_bank<features> bank(2, 1);
        recorder<features> const pass(bank, [](attention_place place) { return place.site.value == 1; });
        call_type left_out({{0}, 0}, drawn, input(3), module);
        call_type taken({{1}, 0}, drawn, input(3), module);
        CHECK(equal_bits(pass(left_out), plain_attention{}(left_out)));
        CHECK(bank.find({{0}, 0}) == nullptr);
        CHECK_FALSE(equal_bits(pass(taken), plain_attention{}(taken)));
        CHECK(bank.find({{1}, 0}) != nullptr);
    }

    TEST_CASE("a recorder that records nowhere is plain attention") {
        module_type const module(channels, 1, 1);
        feature_bank<features> bank(1, 1);
        recorder<features> const pass(bank, never);
        call_type call({}, drawn, input(5), module);
        CHECK(equal_bits(pass(call), plain_attention{}(call)));
        CHECK(bank.find({}) == nullptr);
        CHECK_FALSE(pass.records({}));
        CHECK_FALSE(pass.attends_to_stack({}));
    }

    TEST_CASE("guidance branches are kept apart") {
        module_type const module(channels, 1, 1);
        feature_bank<features> bank(1, 2);
        recorder<features> const pass(bank, always);
        call_type unconditional({{0}, 0}, drawn, input(1), module);
        call_type conditional({{0}, 1}, drawn, input(2), module);
        auto const F_0 = pass(unconditional);
        auto const F_1 = pass(conditional);
        CHECK(equal_bits(*bank.find({{0}, 0})->F_KF, F_0));
        CHECK(equal_bits(*bank.find({{0}, 1})->F_KF, F_1));
        CHECK_FALSE(equal_bits(F_0, F_1));
        CHECK(equal_bits(*bank.find({{0}, 0})->K_KF, unconditional.key(unconditional.f())));
        CHECK(equal_bits(*bank.find({{0}, 1})->K_KF, conditional.key(conditional.f())));
    }

    TEST_CASE("without extension keyframes attend to themselves and are kept all the same") {
        module_type const module(channels, 1, 1);
        feature_bank<features> bank(1, 1);
        recorder<features> const pass(bank, always, false);
        call_type call({}, drawn, input(5), module);
        auto const F = pass(call);
        CHECK(equal_bits(F, plain_attention{}(call)));
        REQUIRE(bank.find({}) != nullptr);
        CHECK(equal_bits(*bank.find({})->F_KF, F));
        CHECK(pass.records({}));
        CHECK_FALSE(pass.attends_to_stack({}));
    }

    TEST_CASE("one keyframe alone is plain attention") {
        module_type const module(channels, 1, 1);
        feature_bank<features> bank(1, 1);
        recorder<features> const pass(bank, always);
        std::vector<frame_index> const one{{3}};
        auto const f = features::allocate({1, tokens, channels});
        copy(f.view(), random_stack<double, 3>({1, tokens, channels}, 8).view());
        call_type call({}, one, f, module);
        CHECK(equal_bits(pass(call), plain_attention{}(call)));
    }

    TEST_CASE("what is kept does not change when the engine reuses the memory of f") {
        module_type const module(channels, 1, 1);
        feature_bank<features> bank(1, 1);
        recorder<features> const pass(bank, always);
        auto engine = random_stack<double, 3>({keyframes, tokens, channels}, 4);
        {
            call_type call({}, drawn, features(engine.view()), module);
            pass(call);
        }
        auto const before = (*bank.find({})->F_KF).view()(2, 4, 3);
        auto const key_before = (*bank.find({})->K_KF).view()(2, 4, 3);
        std::fill(engine.data(), engine.data() + engine.size(), -1.0);
        CHECK((*bank.find({})->F_KF).view()(2, 4, 3) == before);
        CHECK((*bank.find({})->K_KF).view()(2, 4, 3) == key_before);
    }

    TEST_CASE("the filter is asked once per place and pass") {
        module_type const module(channels, 1, 1);
        feature_bank<features> bank(1, 1);
        int asked = 0;
        recorder<features> const pass(bank, [&](attention_place) {
            ++asked;
            return true;
        });
        call_type call({}, drawn, input(5), module);
        pass(call);
        CHECK(asked == 1);
    }

    TEST_CASE("features of a static graph are kept where the place takes part") {
        feature_bank<features> bank(2, 1);
        recorder<features> const pass(bank, [](attention_place place) { return place.site.value == 0; });
        auto const f = input(1);
        auto const F = input(2);
        pass.record({{0}, 0}, f, F);
        pass.record({{1}, 0}, f, F);
        REQUIRE(bank.find({{0}, 0}) != nullptr);
        CHECK(bank.find({{0}, 0})->f_KF->view().data() == f.view().data());
        CHECK(bank.find({{0}, 0})->F_KF->view().data() == F.view().data());
        CHECK_FALSE(bank.find({{0}, 0})->K_KF.has_value());
        CHECK(bank.find({{1}, 0}) == nullptr);
    }

    TEST_CASE("features of a static graph are kept in the format asked for or refused") {
        feature_bank<features> bank(1, 1);
        recorder<features>(bank, always, true, feature_storage::bf16).record({}, input(3), input(4));
        REQUIRE(bank.find({}) != nullptr);
        CHECK(bank.find({})->f_KF->storage() == feature_storage::bf16);
        CHECK(bank.find({})->F_KF->storage() == feature_storage::bf16);

        feature_bank<int> of_an_engine(1, 1);
        recorder<int> const pass(of_an_engine, always, true, feature_storage::bf16);
        CHECK_THROWS_WITH_AS(pass.record({}, 1, 2),
                             "stored_features: storage is of 16 bits, expected feature_storage::same for features "
                             "without `stored`",
                             value_error);
        CHECK_NOTHROW(recorder<int>(of_an_engine, never, true, feature_storage::bf16).record({}, 1, 2));
    }

    TEST_CASE("16 bits that an engine cannot store are refused before anything is computed") {
        struct without_stored : attention_call_archetype<features, double> {
            attention_place where;
            std::size_t* projected;
            attention_place place() const { return where; }
            std::span<frame_index const> frames() const { return drawn; }
            features f() const { return input(1); }
            features query(features const& f) const { return ++*projected, f; }
            features attend(features const& Q, attention_sources<features> const&) const { return Q; }
            features key(features const& f) const { return f; }
            features value(features const& f) const { return f; }
        };
        static_assert(attention_call<without_stored> && !storing_attention_call<without_stored>);
        std::size_t projected = 0;
        without_stored call;
        call.where = {{1}, 0};
        call.projected = &projected;
        feature_bank<features> bank(2, 1);
        CHECK_THROWS_WITH_AS(recorder<features>(bank, always, true, feature_storage::f16)(call),
                             "stored_features: storage is of 16 bits, expected feature_storage::same for an attention "
                             "call without `stored`",
                             value_error);
        CHECK(projected == 0);
        CHECK_NOTHROW(recorder<features>(bank, never, true, feature_storage::f16)(call));
        CHECK_NOTHROW(recorder<features>(bank, always)(call));
        CHECK(projected == 2);

        // A static graph is refused before it runs.
        feature_bank<int> of_an_engine(1, 1);
        CHECK_THROWS_WITH_AS(recorder<int>(of_an_engine, always, true, feature_storage::bf16).records({}),
                             "stored_features: storage is of 16 bits, expected feature_storage::same for features "
                             "without `stored`",
                             value_error);
        CHECK(!recorder<int>(of_an_engine, never, true, feature_storage::bf16).records({}));
        CHECK(recorder<int>(of_an_engine, always).records({}));
    }
    TEST_CASE("calls at different places may run at the same time") {
        module_type const module(channels, 1, 1);
        feature_bank<features> bank(12, 2);
        recorder<features> const pass(bank, always);
        threaded_loop{4}(24, [&](std::size_t at) {
            call_type call({{static_cast<std::uint32_t>(at / 2)}, static_cast<std::uint32_t>(at % 2)}, drawn, input(at),
                           module);
            pass(call);
        });
        CHECK(module.keys == 24 * keyframes);
        for (std::uint32_t at = 0; at < 24; ++at) {
            call_type call({{at / 2}, at % 2}, drawn, input(at), module);
            REQUIRE(bank.find({{at / 2}, at % 2}) != nullptr);
            CHECK(equal_bits(*bank.find({{at / 2}, at % 2})->F_KF, extended(call)));
        }
    }

    TEST_CASE("features are kept in the format asked for and keyframes attend before they are rounded") {
        module_type const module(channels, 2, 1);
        feature_bank<features> bank(1, 1);
        recorder<features> const pass(bank, always, true, feature_storage::f16);
        call_type call({}, drawn, input(3), module);
        auto const F = pass(call);
        CHECK(equal_bits(F, extended(call)));
        auto const& kept = *bank.find({});
        for (auto const* const one : {&*kept.K_KF, &*kept.V_KF, &*kept.F_KF}) {
            CHECK(one->storage() == feature_storage::f16);
        }
        kept.F_KF->visit([&](auto const& view) {
            CHECK(static_cast<double>(view(1, 2, 3)) == doctest::Approx(F.view()(1, 2, 3)).epsilon(0x1p-11));
        });
    }

    TEST_CASE("it is plain where it keeps nothing") {
        feature_bank<features> bank(2, 1);
        recorder<features> const pass(bank, [](attention_place place) { return place.site.value == 1; });
        CHECK(is_plain_at(pass, {{0}, 0}));
        CHECK_FALSE(is_plain_at(pass, {{1}, 0}));
    }
    TEST_CASE("logits are scaled by the number of keyframes where they attend to each other, and there alone") {
        module_type const module(channels, 2, 1);
        module_type sharper(channels, 2, 1);
        for (std::size_t e = 0; e < sharper.W_Q.size(); ++e) {
            sharper.W_Q.data()[e] *= 3;
        }
        feature_bank<features> bank(2, 1);
        auto const by_count = [](site_index site, std::size_t joined) {
            CHECK(site == site_index{1});
            return static_cast<double>(joined);
        };
        call_type call({{1}, 0}, drawn, input(3), module);
        call_type expected({{1}, 0}, drawn, input(3), sharper);
        recorder<features> const pass(bank, always, true, feature_storage::same, by_count);
        auto const F = pass(call);
        auto const F_expected = extended(expected);
        for (std::size_t e = 0; e < F.view().size(); ++e) {
            CHECK(F.view().data()[e] == doctest::Approx(F_expected.view().data()[e]).epsilon(1e-12));
        }
        CHECK(pass.scales({{1}, 0}, keyframes) == std::vector<double>(keyframes, 3.0));
        CHECK(pass.scales({{1}, 0}, 1).empty());
        recorder<features> const alone(bank, always, false, feature_storage::same, by_count);
        CHECK(equal_bits(alone(call), plain_attention{}(call)));
        CHECK(alone.scales({{1}, 0}, keyframes).empty());
        CHECK(recorder<features>(bank, always).scales({{1}, 0}, keyframes).empty());
        recorder<features> const elsewhere(bank, never, true, feature_storage::same, by_count);
        CHECK(equal_bits(elsewhere(call), plain_attention{}(call)));
    }
    TEST_CASE("keys count as they are told where keyframes attend to each other, and there alone") {
        module_type const module(channels, 2, 1);
        feature_bank<features> bank(2, 1);
        call_type call({{1}, 0}, drawn, input(3), module);
        auto const halves = [](site_index, frame_index) { return std::vector<float>(keyframes * tokens, 0.5F); };
        auto const by_frame = [](site_index, frame_index) {
            std::vector<float> counts(keyframes * tokens, 1.0F);
            std::fill_n(counts.begin(), tokens, 0.25F);
            return counts;
        };
        recorder<features> const alike(bank, always, true, feature_storage::same, {}, halves);
        recorder<features> const pass(bank, always, true, feature_storage::same, {}, by_frame);
        auto const F = alike(call);
        auto const plain = extended(call);
        for (std::size_t e = 0; e < F.view().size(); ++e) {
            CHECK(F.view().data()[e] == doctest::Approx(plain.view().data()[e]).epsilon(1e-12));
        }
        CHECK_FALSE(equal_bits(pass(call), plain));
        CHECK(pass.counts_keys({{1}, 0}));
        recorder<features> const alone(bank, always, false, feature_storage::same, {}, by_frame);
        CHECK(equal_bits(alone(call), plain_attention{}(call)));
        CHECK_FALSE(alone.counts_keys({{1}, 0}));
    }
}
