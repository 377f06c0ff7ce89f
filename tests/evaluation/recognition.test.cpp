// SPDX-License-Identifier: MIT
// Which text is nearest, and how often it is the expected one.
#include <genrender/evaluation/recognition.hpp>

#include <doctest/doctest.h>

#include "support/colour_embedder.hpp"

#include <string>
#include <vector>

using namespace genrender;
using genrender::testing::colour_embedder;

TEST_SUITE("evaluation/recognition") {
    TEST_CASE_TEMPLATE("frames are recognised as the colour they are nearest to", Real, float, double) {
        stack<Real, 4> images({4, 3, 1, 1});
        images(0, 0, 0, 0) = Real(0.9); // red
        images(1, 0, 0, 0) = Real(0.9); // rather red than white
        images(1, 1, 0, 0) = Real(0.2);
        images(2, 0, 0, 0) = images(2, 1, 0, 0) = images(2, 2, 0, 0) = Real(0.1); // white, however dark
        images(3, 2, 0, 0) = Real(0.3);                                           // blue
        colour_embedder<Real> const embedder;
        auto const frames = embed_frames(embedder, images);
        auto const texts = embed_texts(embedder, std::vector<std::string>{"green", "red", "white", "blue"});
        CHECK(nearest_text(frames.view()[0], texts) == 1);
        CHECK(nearest_text(frames.view()[1], texts) == 1);
        CHECK(nearest_text(frames.view()[2], texts) == 2);
        CHECK(nearest_text(frames.view()[3], texts) == 3);
        CHECK(*recognition(frames.view(), texts, 0) == 0.0);
        CHECK(*recognition(frames.view(), texts, 1) == 0.5);
        CHECK(*recognition(frames.view(), texts, 2) == 0.25);
    }

    TEST_CASE("the first of equal texts is the nearest") {
        stack<float, 2> texts({3, 2});
        texts(0, 0) = 1;
        texts(1, 1) = texts(2, 1) = 1;
        stack<float, 1> image({2});
        image(1) = 4;
        CHECK(nearest_text(image.view(), texts) == 1);
    }

    TEST_CASE("what cannot be recognised is refused with a sentence") {
        stack<float, 2> const frames({2, 3});
        stack<float, 2> const texts({4, 3});
        stack<float, 2> const longer({4, 5});
        stack<float, 2> const no_texts({0, 3});
        CHECK_FALSE(recognition(stack<float, 2>({0, 3}).view(), texts, 0).has_value());
        CHECK_THROWS_WITH_AS(recognition(frames.view(), texts, 4), "recognition: expected is 4, expected a row below 4",
                             value_error);
        CHECK_THROWS_WITH_AS(recognition(frames.view(), longer, 0), "nearest_text: texts is [4, 5], expected [4, 3]",
                             shape_error);
        CHECK_THROWS_WITH_AS(nearest_text(frames.view()[0], no_texts),
                             "nearest_text: number of texts is 0, expected at least 1", value_error);
    }
}
