// SPDX-License-Identifier: MIT
// Tests of the words of the reference network.
#include <genrender/reference/prompt_vocabulary.hpp>

#include <doctest/doctest.h>

#include <vector>

using namespace genrender;

using namespace genrender::reference;

TEST_SUITE("reference/prompt_vocabulary") {
    TEST_CASE("texts are split at everything but letters and digits") {
        CHECK(prompt_rows("") == std::vector<std::size_t>{0});
        CHECK(prompt_rows(" ,.;\n") == std::vector<std::size_t>{0});
        CHECK(prompt_rows("plain") == std::vector<std::size_t>{0, 1});
        CHECK(prompt_rows("Red, CAMO;white-dots.") == std::vector<std::size_t>{0, 6, 5, 11, 4});
        CHECK(prompt_rows("blue blue") == std::vector<std::size_t>{0, 9, 9});
    }

    TEST_CASE("an unknown word is named with those that are known") {
        auto const known = std::string("plain stripes checker dots camo red yellow green blue purple white");
        CHECK_THROWS_WITH_AS(prompt_rows("red Statue"),
                             ("prompt_vocabulary: word is statue, expected one of " + known).c_str(), value_error);
        CHECK_THROWS_WITH_AS(prompt_rows("n\xC3\xA9on,"),
                             ("prompt_vocabulary: word is n\xC3\xA9on, expected one of " + known).c_str(), value_error);
    }

    TEST_CASE_TEMPLATE("tokens are rows of the table", Real, float, double) {
        auto source = weights<Real>::seeded(1, "prompt");
        prompt_vocabulary<Real> const vocabulary(source, 5);
        auto const table = source.take("token_embedding.weight", {12, 5});
        auto const tokens = vocabulary("stripes");
        CHECK(tokens.extents() == std::array<std::size_t, 2>{2, 5});
        for (std::size_t c = 0; c < 5; ++c) {
            CHECK(tokens(0, c) == table[c]);
            CHECK(tokens(1, c) == table[2 * 5 + c]);
        }
        CHECK(vocabulary("").extent(0) == 1);
        CHECK(vocabulary.words() == std::vector<std::string>{prompt_words.begin(), prompt_words.end()});
    }

    TEST_CASE("words of its own replace the default ones") {
        auto source = weights<float>::seeded(1, "prompt");
        prompt_vocabulary<float> const vocabulary(source, 3, {"gold", "silk"});
        CHECK(source.taken().at("token_embedding.weight") == std::vector<std::size_t>{3, 3});
        CHECK(vocabulary("Silk gold silk").extent(0) == 4);
        CHECK_THROWS_WITH_AS(vocabulary("plain"), "prompt_vocabulary: word is plain, expected one of gold silk",
                             value_error);
    }
}
