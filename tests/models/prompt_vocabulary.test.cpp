// SPDX-License-Identifier: MIT
// Tests of the words of the reference network.
#include <genrender/models/prompt_vocabulary.hpp>

#include <doctest/doctest.h>

#include <vector>

using namespace genrender;

TEST_SUITE("models/prompt_vocabulary") {
    TEST_CASE("texts are split at everything but letters and digits") {
        CHECK(prompt_rows("") == std::vector<std::size_t>{0});
        CHECK(prompt_rows(" ,.;\n") == std::vector<std::size_t>{0});
        CHECK(prompt_rows("checker") == std::vector<std::size_t>{0, 1});
        CHECK(prompt_rows("Marble, CAMO;plain-dots.") == std::vector<std::size_t>{0, 5, 8, 7, 3});
        CHECK(prompt_rows("rings rings") == std::vector<std::size_t>{0, 6, 6});
    }

    TEST_CASE("an unknown word is named with those that are known") {
        auto const known = std::string("checker stripes dots bricks marble rings plain camo");
        CHECK_THROWS_WITH_AS(prompt_rows("marble Statue"),
                             ("prompt_vocabulary: word is statue, expected one of " + known).c_str(), value_error);
        CHECK_THROWS_WITH_AS(prompt_rows("n\xC3\xA9on,"),
                             ("prompt_vocabulary: word is n\xC3\xA9on, expected one of " + known).c_str(), value_error);
    }

    TEST_CASE_TEMPLATE("tokens are rows of the table", Real, float, double) {
        auto source = weights<Real>::seeded(1, "prompt");
        prompt_vocabulary<Real> const vocabulary(source, 5);
        auto const table = source.take("token_embedding.weight", {9, 5});
        auto const tokens = vocabulary("stripes");
        CHECK(tokens.extents() == std::array<std::size_t, 2>{2, 5});
        for (std::size_t c = 0; c < 5; ++c) {
            CHECK(tokens(0, c) == table[c]);
            CHECK(tokens(1, c) == table[2 * 5 + c]);
        }
        CHECK(vocabulary("").extent(0) == 1);
    }
}
