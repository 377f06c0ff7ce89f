// SPDX-License-Identifier: MIT
// [GR sec. 4: TokenFlow*] The processor against the plan's matrix written out, both ways into an engine.
#include <genrender/baselines/token_propagation.hpp>

#include "../injection/dense_equations.hpp"
#include "../support/plans_of.hpp"
#include <genrender/testing/attention_processor_laws.hpp>

#include <genrender/injection/host_attention_call.hpp>

#include <doctest/doctest.h>

#include <vector>

using namespace genrender;
using namespace genrender::testing;

TEST_SUITE("baselines/token_propagation") {
    namespace {

    constexpr std::size_t tokens = 7;
    constexpr std::size_t channels = 4;
    constexpr attention_place place{{1}, 0};
    std::vector<frame_index> const frames{{2}, {5}};

    /// A plan in which token t of frame i is two tokens of two keyframes, shared 1 to 3.
    template <class Real>
    struct shared_plan {
        std::vector<std::uint32_t> offsets{0};
        std::vector<std::uint32_t> sources;
        std::vector<Real> weights;

        explicit shared_plan(std::uint32_t i) {
            for (std::uint32_t t = 0; t < tokens; ++t) {
                sources.push_back(static_cast<std::uint32_t>((t + i) % tokens));
                sources.push_back(static_cast<std::uint32_t>(tokens + (2 * t + i) % tokens));
                weights.push_back(Real(0.25));
                weights.push_back(Real(0.75));
                offsets.push_back(2 * t + 2);
            }
        }
        sparse_rows<Real> rows() const { return {offsets, sources, weights}; }
    };

    template <class Real>
    struct recorded_world {
        matrix_module<Real> module{channels, 2, 3};
        host_features<Real> f = random_features<Real>({2, tokens, channels}, 4);
        host_features<Real> F_KF = random_features<Real>({2, tokens, channels}, 5);
        feature_bank<host_features<Real>> bank{2, 2};
        std::vector<shared_plan<Real>> plans;

        recorded_world() {
            keyframe_features<host_features<Real>> kept;
            kept.F_KF = F_KF;
            bank.put(place, kept);
            for (std::uint32_t i = 0; i < 6; ++i) {
                plans.emplace_back(i);
            }
        }
        token_propagation<host_features<Real>, Real> propagate() const {
            return {bank,
                    plans_of<Real>(2, frames, [this](site_index, frame_index i) { return plans[i.value].rows(); })};
        }
        host_attention_call<Real, matrix_module<Real>> call(attention_place at) const {
            return {at, frames, f, module};
        }
    };

    } // namespace

    TEST_CASE("it is an attention processor and its feature I/O") {
        CHECK(attention_processor<token_propagation<int, float> const, attention_call_archetype<int, float>>);
        CHECK(feature_io_processor<token_propagation<int, float>, int, float>);
    }
    TEST_CASE_TEMPLATE("it keeps the laws of attention processors", Real, float, double) {
        recorded_world<Real> const world;
        auto propagate = world.propagate();
        CHECK(check_attention_processor_laws<Real>(propagate, frames, tokens, channels, 2).text() == "");
    }
    TEST_CASE("[GR sec. 4: TokenFlow*] by hand: a token is a quarter of one token and three quarters of another") {
        recorded_world<double> const world;
        auto call = world.call(place);
        auto const F = world.propagate()(call);
        // Frame 5, token 1: token (1 + 5) % 7 of the first keyframe, (2 + 5) % 7 of the second.
        CHECK(F.view()(1, 1, 3) ==
              doctest::Approx(0.25 * world.F_KF.view()(0, 6, 3) + 0.75 * world.F_KF.view()(1, 0, 3)));
    }
    TEST_CASE_TEMPLATE("F is rows times F_KF and the own features have no part in it", Real, float, double) {
        recorded_world<Real> world;
        auto call = world.call(place);
        auto const F = world.propagate()(call);
        auto const F_KF = joined_rows(world.F_KF, {0, 1});
        for (std::size_t i = 0; i < 2; ++i) {
            auto const plan = world.plans[frames[i].value];
            auto const expected = dense_mix(token_rows(tokens, std::vector<double>(channels)), F_KF, plan.rows(), 1);
            CHECK(greatest_difference(F, i, expected) < 1e-6);
        }
        world.f = random_features<Real>({2, tokens, channels}, 99);
        auto other_call = world.call(place);
        CHECK(equal_bits(F, world.propagate()(other_call)));
    }
    TEST_CASE("attention is skipped: no query and no key is projected") {
        recorded_world<double> const world;
        auto call = world.call(place);
        world.propagate()(call);
        CHECK(world.module.queries == 0);
        CHECK(world.module.keys == 0);
    }
    TEST_CASE("places that the bank does not hold stay plain") {
        recorded_world<double> const world;
        for (auto const other : {attention_place{{0}, 0}, attention_place{{1}, 1}}) {
            auto call = world.call(other);
            CHECK(equal_bits(world.propagate()(call), plain_attention{}(call)));
            CHECK(world.propagate().propagated_features(other) == nullptr);
            CHECK(is_plain_at(world.propagate(), other));
        }
    }
    TEST_CASE("where it propagates it is not plain") {
        CHECK_FALSE(is_plain_at(recorded_world<double>().propagate(), place));
    }
    TEST_CASE("a static graph is asked to replace what its attention gave") {
        recorded_world<double> const world;
        auto const propagate = world.propagate();
        auto const inputs = inputs_at<host_features<double>, double>(propagate, place, frames);
        CHECK(inputs.F_KF->view().data() == world.F_KF.view().data());
        CHECK(inputs.alpha == 1);
        CHECK(inputs.f_KF == nullptr);
        CHECK(!inputs.attends_to_stack);
        CHECK(!inputs.is_recorded);
        auto call = world.call(place);
        auto const F_hat = plain_attention{}(call);
        CHECK(equal_bits(call.mix(F_hat, *inputs.F_KF, inputs.rows, inputs.alpha), propagate(call)));
        CHECK(inputs_at<host_features<double>, double>(propagate, {{0}, 0}, frames).F_KF == nullptr);
        CHECK_NOTHROW(record_features(propagate, place, world.f, world.f));
    }
    TEST_CASE("a plan that leaves out a token is refused in a sentence") {
        recorded_world<double> world;
        world.plans[5].offsets.back() = world.plans[5].offsets[tokens - 1];
        auto call = world.call(place);
        CHECK_THROWS_WITH_AS(world.propagate()(call),
                             "token_propagation: rows is empty at a token, expected a plan that covers every token",
                             value_error);
    }
}
