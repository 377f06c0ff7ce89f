// SPDX-License-Identifier: MIT
// How many runs a study has, and of what.
#include <examples/evaluation/studies.hpp>

#include <doctest/doctest.h>

#include <cstddef>
#include <set>
#include <string>
#include <tuple>

using namespace genrender;
using namespace genrender::examples;

TEST_SUITE("evaluation_program/studies") {
    TEST_CASE("methods have twelve runs a row, ablations four, beside as many painted renders") {
        auto const usual = usual_studies();
        REQUIRE(usual.size() == 2);
        CHECK(runs_of(usual[0]).size() == (11 + 1) * 12);
        CHECK(rows_of(usual[1]).size() == 17); // with both presets
        CHECK(runs_of(usual[1]).size() == (17 + 1) * 4);
    }

    TEST_CASE("each caption is paired with one scene, and begins again with the first") {
        std::set<std::tuple<std::size_t, std::size_t>> pairs;
        for (auto const& run : runs_of(ablations_study())) {
            pairs.insert({run.caption, run.scene});
        }
        CHECK(pairs == std::set<std::tuple<std::size_t, std::size_t>>{{0, 0}, {1, 1}, {2, 2}, {3, 0}});
    }

    TEST_CASE("what settings are chosen on is not what methods are compared on") {
        for (auto const& study : development_studies()) {
            CHECK(study.set == scene_set::development);
            for (auto const& scene : scenes_of(study)) {
                for (auto const& held_out : scene_names(scene_set::held_out)) {
                    CHECK(scene != held_out);
                }
            }
        }
        for (auto const& studies : {usual_studies(), quick_studies(), full_studies(), long_studies()}) {
            for (auto const& study : studies) {
                CHECK(study.set == scene_set::held_out);
            }
        }
    }

    TEST_CASE("named rows come first and once, and a name that no row has is refused") {
        study some{"some", "Some", {"method"}, {"vivid"}};
        auto const rows = rows_of(some);
        CHECK(rows.size() == 11);
        CHECK(rows.front().name == "vivid");
        some.rows = {"vivvid"};
        CHECK_THROWS_AS(rows_of(some), value_error);
    }

    TEST_CASE("a development scene has as many things as its name says, and they move or the camera does") {
        for (std::size_t k = 0; k < development_names.size(); ++k) {
            development_world const world(development_names[k], 4);
            auto const things = world.layouts().size() - 1;
            CHECK((k == 2 ? things >= 3 : things == k + 1));
            auto const first = world.frame({0});
            auto const last = world.frame({3});
            CHECK(first.objects.size() == things + 1);
            CHECK(first.objects[0].positions == last.objects[0].positions);
            CHECK((first.objects[1].positions != last.objects[1].positions) == (k != 1));
            CHECK((first.camera.view != last.camera.view) == (k == 1));
        }
        CHECK_THROWS_AS(development_world("walking_figure", 4), value_error);
    }

    TEST_CASE("a scene is as fast in few frames as in many") {
        for (auto const& name : scene_names(scene_set::held_out)) {
            auto const few = compared_animation(name, 4).frame({3});
            auto const many = compared_animation(name, 30).frame({3});
            CHECK(few.camera.view == many.camera.view);
            CHECK(few.objects[1].positions == many.objects[1].positions);
        }
    }
}
