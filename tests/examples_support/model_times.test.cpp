// SPDX-License-Identifier: MIT
// Which animations play and which times are rendered of them, asked of a scene of which only the takes are known.
#include <examples/support/model_times.hpp>

#include <doctest/doctest.h>

#include <string>
#include <vector>

using namespace genrender;
using namespace genrender::examples;

namespace {

/// A scene that knows its takes and its rate.
class takes_alone final : public model_scene {
public:
    explicit takes_alone(std::vector<model_take> takes, double rate = 24) : takes_(std::move(takes)), rate_(rate) {}

    std::vector<model_take> const& takes() const override { return takes_; }
    std::vector<model_lens> const& lenses() const override { return lenses_; }
    std::vector<model_object_report> const& objects() const override { return objects_; }
    double frames_per_second() const override { return rate_; }
    std::vector<std::string> const& notes() const override { return notes_; }
    void play(std::span<std::size_t const>) override {}
    std::vector<posed_object> objects_at(double) const override { return {}; }
    camera eye_at(std::size_t, double, float, float) const override { return {}; }

private:
    std::vector<model_take> takes_;
    double rate_;
    std::vector<model_lens> lenses_;
    std::vector<model_object_report> objects_;
    std::vector<std::string> notes_;
};

using take_indices = std::vector<std::size_t>;

std::vector<model_take> const takes_apart{{"left", 0, 1, {"a", "b"}}, {"none", 2, 2, {"a"}}, {"right", 0.5, 3, {"c"}}};
std::vector<model_take> const takes_alike{
    {"Walk", 0, 1.25, {"hip", "knee"}}, {"Run", 0, 3, {"knee"}}, {"1", 0, 2, {"hip"}}, {"Stand", 1, 1, {}}};

model_times times_of(std::vector<model_take> const& takes, model_time_options const& options, double rate = 24) {
    return choose_times(takes_alone(takes, rate), choose_takes(takes, options.animation), options);
}

void check_seconds(std::vector<double> const& seconds, std::vector<double> const& expected) {
    REQUIRE(seconds.size() == expected.size());
    for (std::size_t i = 0; i < seconds.size(); ++i) {
        CHECK(seconds[i] == doctest::Approx(expected[i]));
    }
}

} // namespace

TEST_SUITE("examples_support/model_times") {
    TEST_CASE("takes that move different things play together and else the longest plays") {
        CHECK(choose_takes(takes_apart, "") == take_indices{0, 2}); // the one of no length moves nothing
        CHECK(choose_takes(takes_alike, "") == take_indices{1});
        CHECK(choose_takes(std::span(takes_alike).first(1), "") == take_indices{0});
        CHECK(choose_takes(std::span(takes_alike).last(1), "").empty());
        CHECK(choose_takes({}, "").empty());
    }

    TEST_CASE("a take is named before it is numbered and all are all") {
        CHECK(choose_takes(takes_alike, "Walk") == take_indices{0});
        CHECK(choose_takes(takes_alike, "1") == take_indices{2});
        CHECK(choose_takes(takes_alike, "0") == take_indices{0});
        CHECK(choose_takes(takes_alike, "3") == take_indices{3});
        CHECK(choose_takes(takes_alike, "all") == take_indices{0, 1, 2, 3});
        CHECK(choose_takes({}, "all").empty());
    }

    TEST_CASE("a take that is not there is refused with the names and lengths of those that are") {
        for (std::string const choice : {"walk", "4", "-1", "1x", "99999999999999999999999"}) {
            CHECK_THROWS_WITH_AS(choose_takes(takes_alike, choice),
                                 ("load_model: options.time.animation is " + choice +
                                  ", expected the name or number of one of the file's: 0 Walk (1.25 s), 1 Run (3 s), "
                                  "2 1 (2 s), 3 Stand (0 s)")
                                     .c_str(),
                                 value_error);
        }
        CHECK_THROWS_WITH_AS(choose_takes({}, "0"),
                             "load_model: options.time.animation is 0, expected none, as the file holds no animation",
                             value_error);
        std::vector<model_take> const many(500, {"one", 0, 1, {}});
        try {
            choose_takes(many, "two");
            FAIL("takes an animation that is not there");
        } catch (value_error const& error) {
            CHECK(std::string(error.what()).size() < 400);
            CHECK(std::string(error.what()).find("11 one (1 s) and 488 more") != std::string::npos);
        }
    }

    TEST_CASE("without a number of frames the whole plays in real time at the file's rate") {
        auto const times = times_of({{"Walk", 1, 1.5, {"a"}}}, {.frames = 0}, 10);
        check_seconds(times.seconds, {1, 1.1, 1.2, 1.3, 1.4}); // 1.5 looks as 1 does
        CHECK(times.frames_per_second == doctest::Approx(10));
        CHECK(times.duration == doctest::Approx(0.5));
        CHECK(times.name == "Walk");
        CHECK(times.notes == std::vector<std::string>{"Plays Walk (0.5 s), the file's animation."});
    }

    TEST_CASE("a long take is cut at 48 frames unless a rate is asked for and that is said") {
        std::vector<model_take> const take{{"Walk", 0, 10, {"a"}}};
        auto const cut = times_of(take, {.frames = 0});
        CHECK(cut.seconds.size() == 48);
        CHECK(cut.seconds.back() == doctest::Approx(47.0 / 24));
        CHECK(cut.notes == std::vector<std::string>{
                               "Plays Walk (10 s), the file's animation.",
                               "Shows the first 48 of 240 frames; a number of frames or a rate shows the whole."});
        auto const whole = times_of(take, {.frames = 0, .frames_per_second = 24});
        CHECK(whole.seconds.size() == 240);
        CHECK(whole.notes.size() == 1);
        CHECK(times_of({{"Walk", 0, 2, {"a"}}}, {.frames = 0}).notes.size() == 1); // 48 of 48
    }

    TEST_CASE("a number of frames is spread over the range and shown as long as it lasts") {
        auto const times = times_of({{"Walk", 1, 3, {"a"}}}, {.frames = 4});
        check_seconds(times.seconds, {1, 1.5, 2, 2.5});
        CHECK(times.frames_per_second == doctest::Approx(2));
    }

    TEST_CASE("a number of frames at a rate starts again behind the end") {
        auto const times = times_of({{"Walk", 1, 3, {"a"}}}, {.frames = 5, .frames_per_second = 1.5});
        check_seconds(times.seconds, {1, 1 + 2 / 3.0, 1 + 4 / 3.0, 1, 1 + 2 / 3.0});
        CHECK(times.frames_per_second == doctest::Approx(1.5));
    }

    TEST_CASE("first and last frame are counted on the file's time line and both are shown") {
        std::vector<model_take> const take{{"Walk", 0, 10, {"a"}}};
        auto const all = times_of(take, {.frames = 0, .start = 12, .end = 15}, 12);
        check_seconds(all.seconds, {1, 13 / 12.0, 14 / 12.0, 1.25});
        auto const spread = times_of(take, {.frames = 4, .start = 12, .end = 15}, 12);
        check_seconds(spread.seconds, {1, 13 / 12.0, 14 / 12.0, 1.25});
        CHECK(spread.frames_per_second == doctest::Approx(12));
        auto const at_twice = times_of(take, {.frames = 0, .frames_per_second = 24, .start = 12, .end = 13}, 12);
        check_seconds(at_twice.seconds, {1, 1 + 1 / 24.0, 1 + 1 / 12.0});
        auto const from = times_of(take, {.frames = 0, .start = 117}, 12);
        check_seconds(from.seconds, {117 / 12.0, 118 / 12.0, 119 / 12.0});
        auto const one = times_of(take, {.frames = 3, .start = 6, .end = 6}, 12);
        check_seconds(one.seconds, {0.5, 0.5, 0.5});
        CHECK_THROWS_WITH_AS(times_of(take, {.start = 7, .end = 6}, 12),
                             "load_model: options.time.start is 7.000000, expected a frame that is not after the "
                             "last, 6.000000",
                             value_error);
    }

    TEST_CASE("takes that play together last from the first key to the last") {
        auto const times = times_of(takes_apart, {.frames = 3});
        check_seconds(times.seconds, {0, 1, 2});
        CHECK(times.duration == doctest::Approx(3));
        CHECK(times.name == "left, right");
        CHECK(times.notes == std::vector<std::string>{"Plays 2 together of 3 animations: 0 left (1 s), 1 none (0 s), "
                                                      "2 right (2.5 s)."});
    }

    TEST_CASE("which of several takes plays is said with the names of the others") {
        CHECK(times_of(takes_alike, {.frames = 2}).notes ==
              std::vector<std::string>{
                  "Plays Run, one of 4 animations: 0 Walk (1.25 s), 1 Run (3 s), 2 1 (2 s), 3 Stand (0 s)."});
    }

    TEST_CASE("where nothing moves the frames are those asked for") {
        auto const times = times_of({}, {.frames = 3}, 30);
        check_seconds(times.seconds, {0, 0, 0});
        CHECK(times.frames_per_second == doctest::Approx(30));
        CHECK(times.name.empty());
        CHECK(times_of({}, {.frames = 3, .frames_per_second = 8}).frames_per_second == doctest::Approx(8));
        CHECK(times_of({}, {.frames = 0, .frames_at_rest = 24}).seconds.size() == 24);
        CHECK(times_of({}, {.frames = 5, .frames_at_rest = 24}).seconds.size() == 5);
        CHECK(times_of(takes_alike, {.frames = 0, .frames_at_rest = 24}).seconds.size() == 48); // the animation decides
    }

    TEST_CASE("rates that are none are refused by name") {
        for (double const rate : {0.0, -1.0, std::numeric_limits<double>::infinity()}) {
            CHECK_THROWS_AS(times_of(takes_alike, {.frames_per_second = rate}), value_error);
        }
        CHECK_THROWS_WITH_AS(times_of({}, {.frames_per_second = -1}),
                             "load_model: options.time.frames_per_second is -1.000000, expected a rate above 0",
                             value_error);
    }
}
