// SPDX-License-Identifier: MIT
// Tests of tokens that stand in texts by their names.
#include <genrender/reference/clip_added_tokens.hpp>

#include <doctest/doctest.h>

#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

using namespace genrender;

using namespace genrender::reference;

namespace {

/// The parts of a text: cleaned text in brackets, tokens as their ids.
std::string parts_of(clip_added_tokens const& tokens, std::u32string_view text) {
    std::string parts;
    tokens.visit(
        text, [&](std::u32string_view cleaned) { parts += "[" + utf8_text(cleaned) + "]"; },
        [&](std::size_t id, std::u32string_view) { parts += std::to_string(id); });
    return parts;
}

byte_pair_encoding three_tokens() { return byte_pair_encoding({{"?", 0}, {"<s>", 1}, {"x", 2}}, "?"); }

} // namespace

TEST_SUITE("reference/clip_added_tokens") {
    TEST_CASE("a name is one token, and what is between is cleaned") {
        clip_added_tokens const tokens(three_tokens(), {{"<s>", false}});
        CHECK(parts_of(tokens, U"A<s>B<s><s>") == "[a]1[b]11");
        CHECK(parts_of(tokens, U"<S>") == "[<s>]");
        CHECK(parts_of(tokens, U"a <s> \t b") == "[a ]1[ b]");
        CHECK(parts_of(tokens, U"<s") == "[<s]");
        CHECK(parts_of(tokens, U"").empty());
        // A mark behind a name does not reach over it.
        CHECK(parts_of(tokens, U"e<s>\u0301") == "[e]1[\u0301]");
    }

    TEST_CASE("a name of cleaned text is found in any case") {
        clip_added_tokens const tokens(three_tokens(), {{"<S>", true}, {"Caf\u00e9 au", true}, {"<s>", false}});
        CHECK(tokens.id_of("<S>") == 3);
        CHECK(parts_of(tokens, U"x<S>CAFE\u0301\n AU") == "[x]34");
        // What is looked for in the text as written comes first.
        CHECK(parts_of(tokens, U"<s><S>") == "13");
    }

    TEST_CASE("of names that begin at one place the longest counts") {
        clip_added_tokens const tokens(three_tokens(), {{"x", false}, {"xyz", false}, {"xy", false}});
        CHECK(parts_of(tokens, U"xxyxyzy") == "243[y]");
        CHECK(parts_of(tokens, U"yx") == "[y]2");
    }

    TEST_CASE("a name that is not in the vocabulary gets the next number") {
        clip_added_tokens const tokens(three_tokens(), {{"b", false}, {"<s>", false}, {"a", false}, {"b", false}});
        CHECK(tokens.id_of("b") == 3);
        CHECK(tokens.id_of("<s>") == 1);
        CHECK(tokens.id_of("a") == 4);
        CHECK(tokens.size() == 5);
        CHECK_THROWS_AS(tokens.id_of("x"), std::out_of_range);
    }

    TEST_CASE("of equal names the last one says how it is looked for") {
        CHECK(parts_of({three_tokens(), {{"<s>", true}, {"<s>", false}}}, U"<s><S>") == "1[<s>]");
        CHECK(parts_of({three_tokens(), {{"<s>", false}, {"<s>", true}}}, U"<s><S>") == "11");
    }

    TEST_CASE("a name that cannot be is refused") {
        CHECK_THROWS_WITH_AS(clip_added_tokens(three_tokens(), {{"", false}}),
                             "clip_added_tokens: length of a name is 0, expected 1 to 1000 bytes", value_error);
        CHECK_THROWS_WITH_AS(
            clip_added_tokens(three_tokens(), {{"a\xff", false}}),
            "clip_added_tokens: name is byte 255 at offset 1, which begins no character, expected valid "
            "UTF-8",
            value_error);
    }
}
