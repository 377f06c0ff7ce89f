// SPDX-License-Identifier: MIT
// Mean cosines between frames and a prompt by hand.
#include <genrender/evaluation/prompt_fidelity.hpp>

#include <doctest/doctest.h>

#include "support/colour_embedder.hpp"

#include <cmath>
#include <string>
#include <vector>

using namespace genrender;
using genrender::testing::colour_embedder;

TEST_SUITE("evaluation/prompt_fidelity") {
    TEST_CASE_TEMPLATE("[GR sec. 4] a red and a green frame for the prompts red and white", Real, float, double) {
        stack<Real, 4> images({2, 3, 1, 1});
        images(0, 0, 0, 0) = Real(0.5);
        images(1, 1, 0, 0) = Real(0.25);
        colour_embedder<Real> const embedder;
        auto const embeddings = embed_frames(embedder, images);
        auto const prompts = embed_texts(embedder, std::vector<std::string>{"red", "white"});
        CHECK(*prompt_fidelity(embeddings.view(), prompts.view()[0]) == doctest::Approx(0.5));
        CHECK(*prompt_fidelity(embeddings.view(), prompts.view()[1]) == doctest::Approx(1 / std::sqrt(3.0)));
    }

    TEST_CASE("no frames have no fidelity and other dimensions are refused") {
        stack<float, 2> const none({0, 3});
        stack<float, 2> const two({2, 3});
        stack<float, 1> const prompt({3});
        stack<float, 1> const longer({4});
        CHECK_FALSE(prompt_fidelity(none.view(), prompt).has_value());
        CHECK_THROWS_WITH_AS(prompt_fidelity(two.view(), longer), "prompt_fidelity: prompt is [4], expected [3]",
                             shape_error);
    }
}
