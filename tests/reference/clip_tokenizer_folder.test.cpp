// SPDX-License-Identifier: MIT
// Tests of a tokenizer's folder.
#include <genrender/reference/clip_tokenizer_folder.hpp>

#include "small_networks.hpp"

#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <vector>

using namespace genrender;

using namespace genrender::reference;
using namespace genrender::testing;

namespace {

using file_texts = std::map<std::string, std::string>;
using id_list = std::vector<std::size_t>;

/// Two words; the start is 3 and the end 4.
file_texts small_files() {
    return {{"vocab.json", R"({"a</w>": 0, "b</w>": 1, "!": 2, "<|startoftext|>": 3, "<|endoftext|>": 4})"},
            {"merges.txt", "#version: 0.2\n"},
            {"tokenizer_config.json", R"({"model_max_length": 6})"}};
}

/// The small files and others, which replace those of the same name.
clip_tokenizer tokenizer_with(file_texts const& others) {
    clip_tokenizer_files files{"f", small_files()};
    for (auto const& [name, text] : others) {
        files.texts[name] = text;
    }
    return make_clip_tokenizer(files);
}

} // namespace

TEST_SUITE("reference/clip_tokenizer_folder") {
    TEST_CASE("a folder is read, with and without its configuration") {
        temporary_file const folder("tokenizer");
        std::filesystem::create_directories(folder.path());
        for (auto const& [name, text] : small_files()) {
            std::ofstream(std::filesystem::path(folder.path()) / name) << text;
        }
        CHECK(load_clip_tokenizer(folder.path())("a B").ids == id_list{3, 0, 1, 4, 4, 4});
        std::filesystem::remove(std::filesystem::path(folder.path()) / "tokenizer_config.json");
        CHECK(load_clip_tokenizer(folder.path())("a B").ids.size() == 77);
    }

    TEST_CASE("what lacks or cannot be read is named") {
        temporary_file const folder("tokenizer");
        auto const path = std::filesystem::path(folder.path());
        auto const sentence = [&](char const* name, char const* rest) { return (path / name).string() + ": " + rest; };
        CHECK_THROWS_WITH_AS(load_clip_tokenizer(path),
                             sentence("vocab.json", "there is no such file, expected vocab.json and merges.txt, or "
                                                    "tokenizer.json")
                                 .c_str(),
                             file_error);
        std::filesystem::create_directories(path);
        std::ofstream(path / "vocab.json") << "{}";
        CHECK_THROWS_WITH_AS(load_clip_tokenizer(path),
                             sentence("merges.txt", "there is no such file, expected vocab.json and merges.txt, or "
                                                    "tokenizer.json")
                                 .c_str(),
                             file_error);
        std::filesystem::create_directories(path / "merges.txt");
        CHECK_THROWS_WITH_AS(load_clip_tokenizer(path),
                             sentence("merges.txt", "file cannot be read, expected a readable file").c_str(),
                             file_error);
    }

    TEST_CASE("tokenizer.json counts before vocab.json and merges.txt") {
        auto const tokenizer =
            tokenizer_with({{"tokenizer.json", R"({"model": {"end_of_word_suffix": "</w>", "merges": [],
            "vocab": {"b</w>": 0, "<|startoftext|>": 1, "<|endoftext|>": 2}}})"}});
        CHECK(tokenizer("b a").ids == id_list{1, 0, 2, 2, 2, 2});
        CHECK(tokenizer.size() == 3);
    }

    TEST_CASE("padding is what the files say, and stands in texts by its name") {
        auto const tokenizer = tokenizer_with({{"special_tokens_map.json", R"({"pad_token": "!"})"}});
        CHECK(tokenizer("a!").ids == id_list{3, 0, 2, 4, 2, 2});
        CHECK(tokenizer.padding() == 2);
    }

    TEST_CASE("of several declarations of a name the one counts that transformers adds last") {
        auto const finds_capitals = [](char const* config) {
            return tokenizer_with({{"tokenizer_config.json", config}})("<|ENDOFTEXT|>").ids.at(1) == 4 &&
                   tokenizer_with({{"tokenizer_config.json", config}})("<|ENDOFTEXT|>").tokens == 1;
        };
        std::string const as_cleaned = R"({"content": "<|endoftext|>", "normalized": true})";
        auto const end = R"({"eos_token": )" + as_cleaned + R"(, "unk_token": )" + as_cleaned;
        CHECK(finds_capitals((end + R"(, "pad_token": )" + as_cleaned + "}").c_str()));
        CHECK(!finds_capitals((end + "}").c_str())); // padding is only a name, and that comes last
        CHECK(finds_capitals((R"({"eos_token": "<|endoftext|>", "unk_token": )" + as_cleaned + "}").c_str()));
        CHECK(!finds_capitals("{}"));
        // Special tokens are looked for as they are written where nothing else is said.
        CHECK(!finds_capitals(R"({"eos_token": {"content": "<|endoftext|>"}})"));
        CHECK(finds_capitals(R"({"added_tokens_decoder": {"4": {"content": "<|endoftext|>", "normalized": true}}})"));
    }

    TEST_CASE("tokens that were learnt later come behind the vocabulary, in the order of their ids") {
        auto const tokenizer = tokenizer_with({{"added_tokens.json", R"({"<dog>": 6, "<cat>": 5})"}});
        CHECK(tokenizer("a<CAT><dog>").ids == id_list{3, 0, 5, 6, 4, 4});
        CHECK(tokenizer.size() == 7);
    }

    TEST_CASE("many tokens and long names are read and found in a moment") {
        auto names = std::string(R"({"additional_special_tokens": [)");
        auto ids_by_name = std::string("{");
        for (int i = 0; i < 3'000; ++i) {
            auto const name = "\"" + std::string(static_cast<std::size_t>(i % 300), 'a') + std::to_string(i) + "\"";
            names += (i == 0 ? "" : ", ") + name;
            ids_by_name += (i == 0 ? "" : ", ") + name + ": " + std::to_string(5 + i);
        }
        auto const tokenizer =
            tokenizer_with({{"special_tokens_map.json", names + "]}"}, {"added_tokens.json", ids_by_name + "}"}});
        CHECK(tokenizer.size() == 3'005);
        auto const prompt = tokenizer(std::string(50'000, 'a') + "baaa2703");
        CHECK(prompt.ids.back() == 4);
        CHECK(prompt.words.back().text == "aaa2703");
    }

    TEST_CASE("an id that is not that of the vocabulary is refused") {
        CHECK_THROWS_WITH_AS(tokenizer_with({{"added_tokens.json", R"({"<cat>": 9})"}}),
                             "f/added_tokens.json: key <cat>: id of the token <cat> is 9, expected 5, its id in the "
                             "vocabulary or the next one behind that",
                             file_error);
        CHECK_THROWS_WITH_AS(
            tokenizer_with({{"tokenizer_config.json", R"({"added_tokens_decoder": {"3": {"content": "!"}}})"}}),
            "f/tokenizer_config.json: key added_tokens_decoder.3: id of the token ! is 3, expected 2, its id in the "
            "vocabulary or the next one behind that",
            file_error);
    }

    TEST_CASE("a special token that is null or lacks is refused") {
        CHECK_THROWS_WITH_AS(tokenizer_with({{"tokenizer_config.json", R"({"pad_token": null})"}}),
                             "f/tokenizer_config.json: key pad_token is null, expected a token", file_error);
        CHECK_THROWS_WITH_AS(
            tokenizer_with({{"tokenizer_config.json", R"({"unk_token": "what"})"}}),
            "f/vocab.json: byte_pair_encoding: unknown token is what, expected a token of the vocabulary", file_error);
    }
}
