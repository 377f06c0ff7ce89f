// SPDX-License-Identifier: MIT
// Tests of CLIP's cleaning and of its words.
#include <genrender/reference/clip_words.hpp>

#include <doctest/doctest.h>

#include <string>
#include <string_view>
#include <vector>

using namespace genrender;

using namespace genrender::reference;

namespace {

using word_list = std::vector<std::u32string_view>;

} // namespace

TEST_SUITE("reference/clip_words") {
    TEST_CASE("a cleaned text is composed, in lower case, and has single spaces") {
        CHECK(clip_cleaned(U"  A\t\n\u3000B\u2028") == U" a b ");
        CHECK(clip_cleaned(U"CAFE\u0301") == U"caf\u00e9");
        CHECK(clip_cleaned(U"a\u200bb") == U"a\u200bb");
        // Lower case comes last: what it takes apart stays so.
        CHECK(clip_cleaned(U"\u0130\u0301") == U"i\u0307\u0301");
        CHECK(clip_cleaned(U"").empty());
    }

    TEST_CASE("words are letters, single numbers and what is neither") {
        CHECK(clip_words(U"a red ball, 42 x1!! (ok)") ==
              word_list{U"a", U"red", U"ball", U",", U"4", U"2", U"x", U"1", U"!!", U"(", U"ok", U")"});
        CHECK(clip_words(U"\u00bd\u0663\u2177") == word_list{U"\u00bd", U"\u0663", U"\u2177"});
        CHECK(clip_words(U" \u00a0 ").empty());
        CHECK(clip_words(U"").empty());
    }

    TEST_CASE("a combining mark that is left over ends a word") {
        CHECK(clip_words(U"q\u0323a") == word_list{U"q", U"\u0323", U"a"});
        CHECK(clip_words(U"\U0001f469\u200d\U0001f680\ufe0fx") == word_list{U"\U0001f469\u200d\U0001f680\ufe0f", U"x"});
    }

    TEST_CASE("English endings are words") {
        CHECK(clip_words(U"it's don't we're they've i'm she'll he'd") == word_list{U"it", U"'s", U"don", U"'t", U"we",
                                                                                   U"'re", U"they", U"'ve", U"i", U"'m",
                                                                                   U"she", U"'ll", U"he", U"'d"});
        CHECK(clip_words(U"'sun 'x' ''s 'r 're") ==
              word_list{U"'s", U"un", U"'", U"x", U"'", U"''", U"s", U"'", U"r", U"'re"});
        // Only where a word begins: behind other signs the apostrophe belongs to them.
        CHECK(clip_words(U"!'s") == word_list{U"!'", U"s"});
        CHECK(clip_words(U"it\u2019s") == word_list{U"it", U"\u2019", U"s"});
    }

    TEST_CASE("names of special tokens are cut where a word begins") {
        CHECK(clip_words(U"<|startoftext|>!") == word_list{U"<|", U"startoftext", U"|>", U"!"});
        CHECK(clip_words(U"a<|endoftext|><|endoftext|>") ==
              word_list{U"a", U"<|", U"endoftext", U"|>", U"<|", U"endoftext", U"|>"});
        CHECK(clip_words(U"!<|endoftext|>!") == word_list{U"!<|", U"endoftext", U"|>!"});
        CHECK(clip_words(U"<|endoftext|") == word_list{U"<|", U"endoftext", U"|"});
    }
}
