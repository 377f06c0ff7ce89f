// SPDX-License-Identifier: MIT
// From their threshold on findings are recommendations, in the order in which one looks at them.
#include <genrender/inspection/map_recommendations.hpp>

#include <doctest/doctest.h>

#include <vector>

namespace map_recommendations_test {

using namespace genrender;

/// A check of two frames with one faultless object.
inline map_check sound() {
    map_check check{2, {64, 64}, {}, {}, {{0}, {1}}};
    frame_check frame;
    frame.pixels = 4096;
    frame.covered = 2000;
    frame.objects = {{0}};
    check.frames = {frame, frame};
    auto& object = check.objects.emplace_back();
    object.pixels = 4000;
    object.frames = {{0}, {1}};
    object.looked_at = object.asked = 4000;
    object.pairs = 8000;
    object.edges = 400;
    object.levels.resize(2);
    return check;
}

/// The one recommendation that a change of the faultless check calls for.
template <class Change>
recommendation only(Change&& change) {
    auto check = sound();
    change(check);
    auto const all = recommendations_on(check, {16, 16});
    REQUIRE(all.size() == 1);
    return all[0];
}

} // namespace map_recommendations_test

TEST_SUITE("inspection/map_recommendations") {
    using namespace genrender;
    using namespace map_recommendations_test;
    using enum recommendation_kind;

    TEST_CASE("nothing is said of what is sound") { CHECK(recommendations_on(sound(), {16, 16}).empty()); }

    TEST_CASE("every finding of an object calls for its own recommendation") {
        auto const is = [](recommendation const& one, recommendation_kind kind, double figure) {
            CHECK(one.kind == kind);
            CHECK(one.figure == doctest::Approx(figure));
            CHECK(one.object == object_index{0});
        };
        is(only([](map_check& c) { c.objects[0].mirrored = 1920; }), mirrored, 0.48);
        is(only([](map_check& c) { c.objects[0].overlapping = 400; }), overlapping, 0.1);
        is(only([](map_check& c) { c.objects[0].tiled = c.objects[0].out_of_range = 1000; }), tiled, 0.25);
        is(only([](map_check& c) { c.objects[0].out_of_range = 40; }), out_of_range, 0.01);
        is(only([](map_check& c) { c.objects[0].blended_edges = 300; }), blended_edges, 0.75);
        is(only([](map_check& c) { c.objects[0].seams = 800; }), many_seams, 0.1);
        is(only([](map_check& c) { c.objects[0].without_footprint = 4000; }), degenerate, 1);
        is(only([](map_check& c) { c.objects[0].pixels = 20; }), tiny_object, 10); // a token has 16
        auto const broken = only([](map_check& c) {
            c.objects[0].not_finite = 3;
            c.objects[0].not_finite_frames = {{1}};
        });
        is(broken, not_finite, 3);
        CHECK(broken.forbids_run());
        CHECK(broken.frames == std::vector<frame_index>{{1}});
    }

    TEST_CASE("rounding is told once and explains flat pixels and leaps") {
        auto const round = [](map_check& c, bool eight_bit) {
            auto& levels = c.objects[0].levels[1];
            levels.quantum = 1 / 255.0;
            levels.quantum_in_pixels = 2;
            levels.is_eight_bit = eight_bit;
            levels.is_rough = true;
            c.objects[0].without_footprint = 4000;
            c.objects[0].seams = 4000;
        };
        CHECK(only([&](map_check& c) { round(c, true); }).kind == eight_bit);
        auto const other = only([&](map_check& c) { round(c, false); });
        CHECK(other.kind == quantised);
        CHECK(other.figure == 2);
    }

    TEST_CASE("frames that show nothing or the same or no background are listed") {
        auto const empty = only([](map_check& c) { c.frames[1].covered = 0; });
        CHECK(empty.kind == nothing_visible);
        CHECK(empty.frames == std::vector<frame_index>{{1}});
        CHECK(only([](map_check& c) { c.frames[0].covered = 4096; }).kind == no_background);
        CHECK(only([](map_check& c) { c.frames[1].same_as_previous = true; }).kind == identical_frames);
        CHECK(only([](map_check& c) { c.frames.pop_back(); }).kind == one_frame);
    }

    TEST_CASE("frames without background are no finding for a run that needs none") {
        auto check = sound();
        check.frames[0].covered = 4096;
        CHECK(recommendations_on(check, {16, 16}, {}, true).size() == 1);
        CHECK(recommendations_on(check, {16, 16}, {}, false).empty());
    }

    TEST_CASE("maps without frames or pixels end the report") {
        auto const none = only([](map_check& c) { c.frames.clear(); });
        CHECK(none.kind == no_frames);
        CHECK(none.forbids_run());
        CHECK(only([](map_check& c) { c.grid = {0, 64}; }).kind == no_frames);
    }

    TEST_CASE("thresholds are the caller's") {
        auto check = sound();
        check.objects[0].overlapping = 400;
        CHECK(recommendations_on(check, {16, 16}, {.overlapping = 0.2}).empty());
    }
}
