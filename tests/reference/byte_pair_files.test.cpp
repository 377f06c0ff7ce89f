// SPDX-License-Identifier: MIT
// Tests of a byte-pair encoding's files.
#include <genrender/reference/byte_pair_files.hpp>

#include <doctest/doctest.h>

#include <nlohmann/json.hpp>

#include <string>
#include <vector>

using namespace genrender;

using namespace genrender::reference;

namespace {

std::string const seven_tokens = R"({"a": 0, "b": 1, "b</w>": 2, "ab": 3, "ab</w>": 4, "aab</w>": 5, "?": 6})";

byte_pair_encoding encoding_of(std::string const& vocabulary_text, std::string const& merges) {
    return encoding_of_vocabulary_and_merges(vocabulary_text, "v.json", merges, "m.txt", "?");
}

byte_pair_encoding encoding_of_model(std::string const& model) {
    return encoding_of_tokenizer(nlohmann::json::parse("{\"model\": " + model + "}"), "t.json", "?");
}

std::vector<std::size_t> ids_of_word(byte_pair_encoding const& encoding, std::string const& word) {
    std::vector<std::size_t> ids;
    encoding.encode(word, ids);
    return ids;
}

} // namespace

TEST_SUITE("reference/byte_pair_files") {
    TEST_CASE("merges are lines in the order of their use") {
        using ids = std::vector<std::size_t>;
        for (auto const* merges :
             {"#version: 0.2\na b</w>\na ab</w>\na b\n", "a b</w>\na ab</w>\na b", "a b</w>\r\na ab</w>\r\na b\r\n"}) {
            CAPTURE(merges);
            auto const encoding = encoding_of(seven_tokens, merges);
            CHECK(ids_of_word(encoding, "aab") == ids{5});
            CHECK(ids_of_word(encoding, "abb") == ids{3, 2});
        }
        CHECK(ids_of_word(encoding_of(seven_tokens, "a b\na b</w>\n"), "aab") == ids{0, 4});
        CHECK(ids_of_word(encoding_of(seven_tokens, ""), "aab") == ids{0, 0, 2});
    }

    TEST_CASE("a bad line is named") {
        auto const check = [](char const* merges, char const* sentence) {
            CHECK_THROWS_WITH_AS(encoding_of(seven_tokens, merges), sentence, file_error);
        };
        check("#version: 0.2\na b\nab\n", "m.txt: line 3 is 'ab', expected two tokens with one space between");
        check("a b\n\na b\n", "m.txt: line 2 is '', expected two tokens with one space between");
        check("a b b\n", "m.txt: line 1 is 'a b b', expected two tokens with one space between");
        check("a b\na c\n",
              "m.txt: line 2: byte_pair_encoding: token of a merge is c, expected a token of the vocabulary");
        check("b a\n", "m.txt: line 1: byte_pair_encoding: token of a merge is ba, expected a token of the vocabulary");
    }

    TEST_CASE("a bad vocabulary is refused with the key") {
        auto const check = [](char const* text, char const* sentence) {
            CHECK_THROWS_WITH_AS(encoding_of(text, ""), sentence, file_error);
        };
        check("[1]", "v.json: file is a JSON array, expected an object");
        check(R"({"a": -1, "?": 0})", "v.json: key a is -1, expected the token's id, a whole number from 0");
        check(R"({"a": "0"})", "v.json: key a is \"0\", expected the token's id, a whole number from 0");
        check(R"({"a": 4294967296})", "v.json: key a is 4294967296, expected the token's id, a whole number from 0");
        check(R"({"a": [1, 2]})", "v.json: key a is a JSON array, expected the token's id, a whole number from 0");
        check(R"({"a": 0, "a": 1})", "v.json: file has the key a twice, expected each key once");
        check(R"({"a": 0})", "v.json: byte_pair_encoding: unknown token is ?, expected a token of the vocabulary");
        check(R"({"a": 0, "?": 2})",
              "v.json: byte_pair_encoding: id of the token ? is 2, expected one below 2, the number "
              "of tokens, that no other token has");
        CHECK_THROWS_AS(encoding_of("{", ""), file_error);
        CHECK_THROWS_AS(encoding_of("", ""), file_error);
    }

    TEST_CASE("a tokenizer.json has merges as texts and as pairs") {
        auto const encoding =
            encoding_of_model(R"({"type": "BPE", "continuing_subword_prefix": "", "end_of_word_suffix": )"
                              R"("</w>", "merges": ["a b</w>", ["a", "ab</w>"]], "vocab": )" +
                              seven_tokens + "}");
        CHECK(ids_of_word(encoding, "aab") == std::vector<std::size_t>{5});
        CHECK(ids_of_word(
                  encoding_of_model(R"({"end_of_word_suffix": "</w>", "merges": [], "vocab": )" + seven_tokens + "}"),
                  "ab") == std::vector<std::size_t>{0, 2});
    }

    TEST_CASE("a tokenizer.json of another kind is refused with the key") {
        auto const check = [](std::string const& model, char const* sentence) {
            CHECK_THROWS_WITH_AS(encoding_of_model(model), sentence, file_error);
        };
        auto const with = [](std::string const& merges) {
            return R"({"end_of_word_suffix": "</w>", "vocab": )" + seven_tokens + R"(, "merges": )" + merges + "}";
        };
        check("null", "t.json: key model is null, expected an object");
        check(R"({"type": "Unigram"})", "t.json: key model.type is \"Unigram\", expected \"BPE\", as CLIP's is");
        check(R"({"type": "BPE"})", "t.json: key model.end_of_word_suffix is null, expected \"</w>\", as CLIP's is");
        check(R"({"end_of_word_suffix": "</w>", "continuing_subword_prefix": "##"})",
              "t.json: key model.continuing_subword_prefix is \"##\", expected \"\", as CLIP's is");
        check(R"({"end_of_word_suffix": "</w>", "vocab": [["a", 0]]})",
              "t.json: key model.vocab is a JSON array, expected an object of ids by tokens");
        check(R"({"end_of_word_suffix": "</w>", "vocab": {"a": null}, "merges": []})",
              "t.json: key model.vocab.a is null, expected the token's id, a whole number from 0");
        check(R"({"end_of_word_suffix": "</w>", "vocab": {"?": 0}})",
              "t.json: key model.merges is null, expected a list of merges");
        check(with("[1]"), "t.json: key model.merges[0] is 1, expected two tokens");
        check(with(R"(["a b", ["a"]])"), "t.json: key model.merges[1] is a JSON array, expected two tokens");
        check(with(R"(["ab"])"), "t.json: key model.merges[0] is 'ab', expected two tokens with one space between");
        check(with(R"([["a b", "b"]])"),
              "t.json: key model.merges[0] is 'a b b', expected two tokens with one space between");
        check(with(R"([["b", "b"]])"),
              "t.json: key model.merges[0]: byte_pair_encoding: token of a merge is bb, expected a "
              "token of the vocabulary");
    }
}
