// SPDX-License-Identifier: MIT
// Samplers that go on where another call of them was left.
#include <genrender/sampling/sampler_history.hpp>

#include <genrender/sampling/karras_schedule.hpp>
#include <genrender/sampling/sampler.hpp>

#include <Eigen/Core>
#include <doctest/doctest.h>

#include <cstddef>
#include <vector>

using namespace genrender;

TEST_SUITE("sampling/sampler_history") {
    namespace {

    using pair_of_latents = Eigen::Array2d;

    std::vector<double> five_steps() { return karras_schedule<double>(5, 0.1, 10.0, 7.0); }

    /// An estimate that is neither of z alone nor of sigma alone.
    pair_of_latents bent(pair_of_latents const& z, double sigma) { return z / (1 + sigma) + sigma * (z * 0.3).sin(); }

    constexpr auto all_samplers = {sampler_kind::euler, sampler_kind::heun, sampler_kind::dpmpp_2m};

    /// Where a run is after each of its steps.
    struct place {
        pair_of_latents z;
        sampler_history<pair_of_latents> history;
    };
    std::vector<place> places_of(sampler_kind sampler, std::size_t& evaluations) {
        std::vector<place> places{{{3, -2}, {}}};
        sampler_history<pair_of_latents> history;
        auto const D = [&](pair_of_latents const& z, double sigma) {
            ++evaluations;
            return bent(z, sigma);
        };
        sample(
            sampler, D, places[0].z, five_steps(),
            [&](std::size_t, pair_of_latents const& z) {
                places.push_back({z, history});
            },
            &history);
        return places;
    }

    } // namespace

    TEST_CASE("a sampler that goes on from any of its steps comes to the same latents, to the bit") {
        for (auto const sampler : all_samplers) {
            CAPTURE(static_cast<int>(sampler));
            auto const in_one_go = sample(sampler, bent, pair_of_latents(3, -2), five_steps());
            std::size_t count = 0;
            auto const places = places_of(sampler, count);
            REQUIRE(places.size() == 6);
            for (auto const& [z, history] : places) {
                auto past = history;
                std::size_t after = history.steps;
                auto const end = sample(
                    sampler, bent, z, five_steps(),
                    [&](std::size_t step, pair_of_latents const&) { CHECK(step == after++); }, &past);
                CHECK((end == in_one_go).all());
                CHECK(after == 5);
                CHECK(past.steps == 5);
            }
        }
    }
    TEST_CASE("a history changes nothing and costs no evaluation") {
        for (auto const sampler : all_samplers) {
            std::size_t count = 0;
            auto const places = places_of(sampler, count);
            CHECK((places.back().z == sample(sampler, bent, pair_of_latents(3, -2), five_steps())).all());
            CHECK(count == evaluations(sampler, 5));
        }
    }
    TEST_CASE("it holds the last estimate, which a step to level 0 ends at") {
        for (auto const sampler : all_samplers) {
            std::size_t count = 0;
            auto const places = places_of(sampler, count);
            CHECK(!places.front().history.x0_last);
            CHECK(places.back().history.steps == 5);
            CHECK((*places.back().history.x0_last == places.back().z).all());
        }
    }
    TEST_CASE("DPM++ 2M alone needs the estimate: without it the next step is of first order") {
        for (auto const sampler : all_samplers) {
            std::size_t count = 0;
            auto const places = places_of(sampler, count);
            sampler_history<pair_of_latents> without{2, {}};
            auto const end = sample(sampler, bent, places[2].z, five_steps(), nothing_after_step{}, &without);
            CHECK((end == places.back().z).all() == !remembers_estimates(sampler));
        }
    }
    TEST_CASE("more steps than there are is refused") {
        sampler_history<pair_of_latents> history{6, {}};
        CHECK_THROWS_WITH_AS(heun(bent, pair_of_latents(3, -2), five_steps(), nothing_after_step{}, &history),
                             "heun: history.steps is 6, expected at most 5, one less than there are noise levels",
                             value_error);
    }
}
