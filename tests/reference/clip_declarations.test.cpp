// SPDX-License-Identifier: MIT
// Tests of what a tokenizer's files say of special tokens.
#include <genrender/reference/clip_declarations.hpp>

#include <doctest/doctest.h>

#include <nlohmann/json.hpp>

#include <string>

using namespace genrender;

using namespace genrender::reference;

namespace {

clip_declarations declarations_of(std::map<std::string, std::string> texts) {
    clip_tokenizer_files const files{"f", std::move(texts)};
    return read_clip_declarations(files, files.object("tokenizer.json"));
}

clip_declarations declarations_of_config(std::string const& config) {
    return declarations_of({{"tokenizer_config.json", config}});
}

} // namespace

TEST_SUITE("reference/clip_declarations") {
    TEST_CASE("files that are not there say nothing") {
        auto const found = declarations_of({});
        CHECK(found.numbered.empty());
        CHECK(found.named.empty());
        CHECK(found.others.empty());
        CHECK(found.context_length == 77);
    }

    TEST_CASE("a token is a name or says how it is looked for") {
        auto const found = declarations_of_config(R"({"bos_token": "<s>", "eos_token": {"content": "</s>"},
            "pad_token": {"content": "p", "normalized": false, "lstrip": false, "__type": "AddedToken"},
            "unk_token": {"content": "u", "special": true}, "mask_token": null, "model_max_length": 20})");
        CHECK(found.named.at("bos_token")->content == "<s>");
        CHECK(found.named.at("bos_token")->is_name);
        CHECK(!found.named.at("eos_token")->is_name);
        CHECK(!found.named.at("bos_token")->in_cleaned());
        CHECK(found.named.at("eos_token")->in_cleaned());
        CHECK(!found.named.at("pad_token")->in_cleaned());
        CHECK(!found.named.at("unk_token")->in_cleaned());
        CHECK(!found.named.at("mask_token"));
        CHECK(!found.named.contains("sep_token"));
        CHECK(found.context_length == 20);
    }

    TEST_CASE("a length that stands for none leaves CLIP's") {
        CHECK(declarations_of_config(R"({"model_max_length": 1000000000000000019884624838656})").context_length == 77);
        CHECK(declarations_of_config(R"({"model_max_length": null})").context_length == 77);
    }

    TEST_CASE("special_tokens_map.json counts before tokenizer_config.json, and its tokens are special") {
        auto const found =
            declarations_of({{"tokenizer_config.json", R"({"pad_token": "e", "eos_token": "e"})"},
                             {"special_tokens_map.json", R"({"pad_token": "!", "bos_token": {"content": "b"},
                                              "additional_special_tokens": ["x", {"content": "y"}]})"}});
        CHECK(found.named.at("pad_token")->content == "!");
        CHECK(found.named.at("eos_token")->content == "e");
        CHECK(found.named.at("bos_token")->is_special);
        REQUIRE(found.others.size() == 2);
        CHECK(found.others[1].content == "y");
    }

    TEST_CASE("tokens with ids are those of newer writers or else of the older files") {
        std::string const added = R"({"<cat>": 9, "<s>": 8})";
        std::string const tokenizer = R"({"added_tokens": [{"id": 7, "content": "</s>", "special": true},
                                          {"id": 9, "content": "<dog>", "normalized": true}]})";
        std::string const config = R"({"bos_token": "<s>")";
        auto const older = declarations_of(
            {{"tokenizer_config.json", config + "}"}, {"added_tokens.json", added}, {"tokenizer.json", tokenizer}});
        REQUIRE(older.numbered.size() == 3);
        CHECK(older.numbered.at(7).is_special);
        CHECK(!older.numbered.at(8).in_cleaned()); // it has a purpose
        CHECK(older.numbered.at(9).content == "<dog>");
        CHECK(older.places.at(9) == "f/tokenizer.json: key added_tokens[1]");
        CHECK(older.places.at(8) == "f/added_tokens.json: key <s>");

        auto const newer =
            declarations_of({{"tokenizer_config.json",
                              config + R"(, "added_tokens_decoder": {"5": {"content": "<s>", "special": true}}})"},
                             {"special_tokens_map.json", R"({"bos_token": "other"})"},
                             {"added_tokens.json", added},
                             {"tokenizer.json", tokenizer}});
        REQUIRE(newer.numbered.size() == 1);
        CHECK(newer.numbered.at(5).content == "<s>");
        CHECK(newer.named.at("bos_token")->content == "<s>");
        CHECK(newer.places.at(5) == "f/tokenizer_config.json: key added_tokens_decoder.5");
    }

    TEST_CASE("what is not CLIP's tokenizer is refused with the key") {
        auto const check = [](char const* config, std::string const& sentence) {
            CAPTURE(config);
            CHECK_THROWS_WITH_AS(declarations_of_config(config), ("f/tokenizer_config.json: " + sentence).c_str(),
                                 file_error);
        };
        check("[]", "file is a JSON array, expected an object");
        check(R"({"tokenizer_class": "T5Tokenizer"})",
              "key tokenizer_class is \"T5Tokenizer\", expected CLIPTokenizer");
        check(R"({"do_lower_case": false})", "key do_lower_case is false, expected true");
        check(R"({"padding_side": "left"})", "key padding_side is \"left\", expected right");
        check(R"({"truncation_side": "left"})", "key truncation_side is \"left\", expected right");
        check(R"({"split_special_tokens": true})", "key split_special_tokens is true, expected false");
        check(R"({"model_max_length": 1})", "key model_max_length is 1, expected a whole number from 2 to 65536");
        check(R"({"model_max_length": -5})", "key model_max_length is -5, expected a whole number from 2 to 65536");
        check(R"({"model_max_length": 77.5})", "key model_max_length is 77.5, expected a whole number from 2 to 65536");
        check(R"({"model_max_length": 100000})",
              "key model_max_length is 100000, expected a whole number from 2 to 65536");
        check(R"({"model_max_length": "77"})",
              "key model_max_length is \"77\", expected a whole number from 2 to 65536");
        check(R"({"image_token": "<image>"})", "key image_token is \"<image>\", expected no such key");
        check(R"({"extra_special_tokens": {"image": "<image>"}})",
              "key extra_special_tokens is a JSON object, expected a list of tokens");
        check(R"({"pad_token": 3})", "key pad_token is 3, expected a name or an object with content");
        check(R"({"pad_token": ""})", "key pad_token is \"\", expected a name");
        check(R"({"pad_token": {"content": ""}})", "key pad_token.content is \"\", expected a name");
        check(R"({"pad_token": {"content": "a", "lstrip": true}})", "key pad_token.lstrip is true, expected false");
        check(R"({"pad_token": {"content": "a", "single_word": true}})",
              "key pad_token.single_word is true, expected false");
        check(R"({"pad_token": {"content": "a", "special": 1}})", "key pad_token.special is 1, expected true or false");
        check(R"({"added_tokens_decoder": []})",
              "key added_tokens_decoder is [], expected an object of tokens by their ids");
        check(R"({"added_tokens_decoder": {"x": {"content": "a"}}})",
              "key added_tokens_decoder.x is a JSON object, expected a token by its id");
        check(R"({"added_tokens_decoder": {"3": "a"}})",
              "key added_tokens_decoder.3 is \"a\", expected a token by its id");
        // However deep it is.
        auto const deep = R"({"tokenizer_class": )" + std::string(300'000, '[') + std::string(300'000, ']') + "}";
        check(deep.c_str(), "key tokenizer_class is a JSON array, expected CLIPTokenizer");
        CHECK_THROWS_WITH_AS(declarations_of({{"added_tokens.json", R"({"<cat>": "9"})"}}),
                             "f/added_tokens.json: key <cat> is \"9\", expected an id", file_error);
        CHECK_THROWS_WITH_AS(declarations_of({{"tokenizer.json", R"({"added_tokens": 3})"}}),
                             "f/tokenizer.json: key added_tokens is 3, expected a list of tokens", file_error);
        CHECK_THROWS_WITH_AS(declarations_of({{"tokenizer.json", R"({"added_tokens": [{"content": "a"}]})"}}),
                             "f/tokenizer.json: key added_tokens[0] is a JSON object, expected a token with an id",
                             file_error);
    }
}
