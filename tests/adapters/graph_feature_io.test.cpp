// SPDX-License-Identifier: MIT
// [GR alg. 1: Phi as a static graph] Fixed tensors are made once a run, written before a graph and handed over behind it.
#include <genrender/adapters/graph_feature_io.hpp>

#include "../support/plans_of.hpp"
#include "numbered_memory.hpp"

#include <doctest/doctest.h>

#include <array>
#include <cstddef>
#include <vector>

using namespace genrender;
using namespace genrender::testing;

TEST_SUITE("adapters/graph_feature_io") {
    namespace {

    using numbered_injector = injector<numbered_features, float>;

    attention_site const numbered_site{"attn1", network_kind::denoising, network_part::decoder, {3, 4}, 8};
    std::array const numbered_sites{numbered_site, numbered_site};
    std::vector<frame_index> const numbered_keyframes{{5}, {2}};
    std::vector<frame_index> const numbered_frames{{1}, {2}, {3}};

    /// Both branches of site 1 take part.
    run_shapes shapes_of_two_branches() {
        run_shapes shapes;
        shapes.keyframes = numbered_keyframes.size();
        shapes.places = {{{1}, 0}, {{1}, 1}};
        shapes.lists_sources = false;
        return shapes;
    }

    /// A bank in which a keyframe pass has recorded features of both branches, of memory `first` and on.
    void fill(feature_bank<numbered_features>& bank, int first) {
        recorder<numbered_features> const records(bank, [](attention_place) { return true; });
        for (std::uint32_t branch = 0; branch < 2; ++branch) {
            inputs_at<numbered_features, float>(records, {{1}, branch}, numbered_keyframes);
            auto const memory = first + 2 * static_cast<int>(branch);
            record_features(records, {{1}, branch}, numbered_features{memory}, numbered_features{memory + 1});
        }
    }

    auto empty_plans() {
        return plans_of<float>(2, numbered_frames, [](site_index, frame_index) { return sparse_rows<float>{}; });
    }

    } // namespace

    TEST_CASE("places that take part have features of their own, others have none") {
        numbered_feature_io const io({}, shapes_of_two_branches(), numbered_sites);
        REQUIRE(io.bank({{1}, 0}) != nullptr);
        REQUIRE(io.bank({{1}, 1}) != nullptr);
        CHECK(io.bank({{1}, 0})->f_KF == 1);
        CHECK(io.bank({{1}, 1})->F_KF == 4);
        CHECK(io.bank({{0}, 0}) == nullptr);
    }

    TEST_CASE("a plan is made once for a site and a number of frames") {
        numbered_feature_io io({}, shapes_of_two_branches(), numbered_sites);
        auto& plan = io.plan({1}, 3);
        CHECK(plan.frames == 3);
        CHECK(plan.tokens == 12);
        CHECK(&io.plan({1}, 3) == &plan);
        CHECK(&io.plan({1}, 2) != &plan);
    }

    TEST_CASE("what the keyframe pass of a branch recorded is handed over, and of no other branch") {
        numbered_feature_io io({}, shapes_of_two_branches(), numbered_sites);
        feature_bank<numbered_features> bank(2, 2);
        recorder<numbered_features> const records(bank, [](attention_place) { return true; });
        REQUIRE(io.pass_of(records, numbered_keyframes) == graph_pass::keyframe);
        for (std::uint32_t branch = 0; branch < 2; ++branch) {
            io.write(records, graph_pass::keyframe, branch, numbered_keyframes);
            io.record(records, branch, numbered_keyframes);
        }
        auto const plans = empty_plans();
        numbered_injector const injects(bank, numbered_keyframes, plans);
        for (std::uint32_t branch = 0; branch < 2; ++branch) {
            auto const in = inputs_at<numbered_features, float>(injects, {{1}, branch}, numbered_frames);
            REQUIRE(in.f_KF != nullptr);
            CHECK(in.f_KF->memory == io.bank({{1}, branch})->f_KF);
            CHECK(in.F_KF->memory == io.bank({{1}, branch})->F_KF);
        }
    }

    TEST_CASE("an injected pass writes rows, alpha and what each frame leaves out") {
        numbered_feature_io io({}, shapes_of_two_branches(), numbered_sites);
        feature_bank<numbered_features> bank(2, 2);
        fill(bank, 1);
        auto const plans = empty_plans();
        injection_settings settings;
        settings.keeps_own_copy = false;
        numbered_injector const injects(bank, numbered_keyframes, plans, settings, [](site_index) { return 0.25f; });
        REQUIRE(io.pass_of(injects, numbered_frames) == graph_pass::injected);
        io.write(injects, graph_pass::injected, 0, numbered_frames);
        auto const& plan = io.plan({1}, 3);
        CHECK(plan.alphas == std::vector<float>{0.25f});
        CHECK(plan.left_out == std::vector<std::optional<std::size_t>>{std::nullopt, 1, std::nullopt});
        CHECK(io.plan({1}, 2).alphas.empty());
    }

    TEST_CASE("scales are written in the passes that join keys, ones where a place has none") {
        auto shapes = shapes_of_two_branches();
        shapes.scales_logits = true;
        numbered_feature_io io({}, shapes, numbered_sites, true);
        auto const by_count = [](site_index, std::size_t joined) { return static_cast<double>(joined); };
        feature_bank<numbered_features> bank(2, 2);
        auto const always = [](attention_place) { return true; };
        recorder<numbered_features> const records(bank, always, true, feature_storage::same, by_count);
        REQUIRE(io.pass_of(records, numbered_keyframes) == graph_pass::keyframe);
        for (std::uint32_t branch = 0; branch < 2; ++branch) {
            io.write(records, graph_pass::keyframe, branch, numbered_keyframes);
            io.record(records, branch, numbered_keyframes);
        }
        REQUIRE(io.scales({{1}, 0}, graph_pass::keyframe, 2) != nullptr);
        CHECK(io.scales({{1}, 0}, graph_pass::keyframe, 2)->values == std::vector<double>{2, 2});
        CHECK(io.scales({{1}, 1}, graph_pass::keyframe, 2) == io.scales({{1}, 0}, graph_pass::keyframe, 2));
        CHECK(io.scales({{1}, 0}, graph_pass::plain, 2) == nullptr);
        CHECK(io.scales({{0}, 0}, graph_pass::keyframe, 2) == nullptr);

        auto const plans = empty_plans();
        injection_settings settings;
        settings.keeps_own_copy = false;
        auto const alpha = [](site_index) { return 0.25f; };
        numbered_injector const injects(bank, numbered_keyframes, plans, settings, alpha, by_count);
        io.write(injects, graph_pass::injected, 0, numbered_frames);
        CHECK(io.scales({{1}, 0}, graph_pass::injected, 3)->values == std::vector<double>{3, 2, 3});
        numbered_injector const unscaled(bank, numbered_keyframes, plans);
        io.write(unscaled, graph_pass::injected, 0, numbered_frames);
        CHECK(io.scales({{1}, 0}, graph_pass::injected, 3)->values == std::vector<double>{1, 1, 1});

        // A run whose shapes do not say so has no scales, and refuses them.
        numbered_feature_io other({}, shapes_of_two_branches(), numbered_sites, true);
        CHECK(other.scales({{1}, 0}, graph_pass::injected, 3) == nullptr);
        CHECK_THROWS_WITH_AS(other.write(injects, graph_pass::injected, 0, numbered_frames),
                             doctest::Contains("logits are scaled"), value_error);
    }

    TEST_CASE("features of another memory and inputs of another pass are refused") {
        numbered_feature_io io({}, shapes_of_two_branches(), numbered_sites);
        feature_bank<numbered_features> bank(2, 2);
        fill(bank, 7);
        auto const plans = empty_plans();
        numbered_injector const injects(bank, numbered_keyframes, plans);
        CHECK_THROWS_WITH_AS(io.write(injects, graph_pass::injected, 0, numbered_frames),
                             doctest::Contains("features of another memory"), value_error);
        CHECK_THROWS_WITH_AS(io.write(plain_attention{}, graph_pass::injected, 0, numbered_frames),
                             doctest::Contains("of another pass"), value_error);
    }

    TEST_CASE("runs that static graphs cannot do are refused before they begin") {
        auto shapes = shapes_of_two_branches();
        shapes.places.push_back({{2}, 0});
        CHECK_THROWS_WITH_AS(numbered_feature_io({}, shapes, numbered_sites), doctest::Contains("shapes.places is 2"),
                             value_error);
        shapes.banks = 2;
        CHECK_THROWS_WITH_AS(numbered_feature_io({}, shapes, numbered_sites), doctest::Contains("one bank"),
                             value_error);
        shapes.lists_sources = true;
        CHECK_THROWS_WITH_AS(numbered_feature_io({}, shapes, numbered_sites), doctest::Contains("shapes.lists_sources"),
                             value_error);
    }
}
