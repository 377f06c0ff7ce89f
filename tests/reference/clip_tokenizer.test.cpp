// SPDX-License-Identifier: MIT
// Tests of CLIP's tokenizer.
#include <genrender/reference/clip_tokenizer.hpp>

#include "../support/golden_file.hpp"

#include <genrender/reference/clip_tokenizer_folder.hpp>

#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

using namespace genrender;

using namespace genrender::reference;
using namespace genrender::testing;

namespace {

/// Tokens of single letters and of `cat`; four tokens of text have room.
clip_tokenizer small_tokenizer(std::size_t context_length = 6) {
    byte_pair_encoding encoding({{"c", 0},
                                 {"a", 1},
                                 {"t</w>", 2},
                                 {"a</w>", 3},
                                 {"ca", 4},
                                 {"cat</w>", 5},
                                 {"!</w>", 6},
                                 {"<|startoftext|>", 7},
                                 {"<|endoftext|>", 8}},
                                "<|endoftext|>");
    encoding.add_merge("c", "a");
    encoding.add_merge("ca", "t</w>");
    clip_special_tokens special;
    special.context_length = context_length;
    special.padding = "pad";
    return clip_tokenizer(std::move(encoding), special);
}

using id_list = std::vector<std::size_t>;

} // namespace

TEST_SUITE("reference/clip_tokenizer") {
    TEST_CASE("a prompt is the start, its tokens, the end and padding") {
        auto const tokenizer = small_tokenizer();
        auto const prompt = tokenizer("Cat a");
        CHECK(prompt.ids == id_list{7, 5, 3, 8, 9, 9});
        CHECK(prompt.tokens == 2);
        CHECK(prompt.cut == 0);
        CHECK(prompt.cut_text().empty());
        REQUIRE(prompt.words.size() == 2);
        CHECK(prompt.words[0].text == "cat");
        CHECK(prompt.words[0].tokens == 1);
        CHECK(tokenizer("").ids == id_list{7, 8, 9, 9, 9, 9});
        CHECK(tokenizer(" \n ").ids == id_list{7, 8, 9, 9, 9, 9});
    }

    TEST_CASE("a prompt that is too long is cut, and what is cut is told") {
        auto const prompt = small_tokenizer()("a cat caca! cat");
        CHECK(prompt.ids == id_list{7, 3, 5, 4, 0, 8});
        CHECK(prompt.tokens == 4);
        CHECK(prompt.cut == 3);
        CHECK(prompt.cut_text() == "caca ! cat");
        REQUIRE(prompt.words.size() == 5);
        CHECK(prompt.words[2].tokens == 3);
        CHECK(prompt.words[2].kept == 2);
        CHECK(prompt.words[3].kept == 0);
        // As long as there is room for.
        CHECK(small_tokenizer()("a a a a").ids == id_list{7, 3, 3, 3, 3, 8});
        CHECK(small_tokenizer()("a a a a").cut == 0);
        CHECK(small_tokenizer(2)("a").ids == id_list{7, 8});
        CHECK(small_tokenizer(2)("a").cut == 1);
    }

    TEST_CASE("bytes without a token are unknown and counted by word") {
        auto const prompt = small_tokenizer()("\xc3\xa4 cat");
        CHECK(prompt.ids == id_list{7, 8, 8, 5, 8, 9});
        REQUIRE(prompt.words.size() == 2);
        CHECK(prompt.words[0].text == "\xc3\xa4");
        CHECK(prompt.words[0].unknown == 2);
        CHECK(prompt.words[1].unknown == 0);
    }

    TEST_CASE("words that are no token as a whole are told") {
        CHECK(small_tokenizer(9)("a cat caca \xc3\xa4").split_text() == "caca \xc3\xa4");
        CHECK(small_tokenizer()("a cat a").split_text().empty());
    }

    TEST_CASE("names of special tokens in a text are these tokens") {
        auto const prompt = small_tokenizer()("a<|endoftext|>cat pad");
        CHECK(prompt.ids == id_list{7, 3, 8, 5, 9, 8});
        CHECK(prompt.words.at(1).text == "<|endoftext|>");
        CHECK(small_tokenizer()("a<|ENDOFTEXT|>").words.size() == 4);
    }

    TEST_CASE("special tokens that the vocabulary lacks come behind it") {
        auto const tokenizer = small_tokenizer();
        CHECK(tokenizer.start() == 7);
        CHECK(tokenizer.end() == 8);
        CHECK(tokenizer.padding() == 9);
        CHECK(tokenizer.id_of("pad") == 9);
        CHECK(tokenizer.size() == 10);
        CHECK(tokenizer.context_length() == 6);
    }

    TEST_CASE("a prompt that is no UTF-8 is refused with the place") {
        CHECK_THROWS_WITH_AS(
            small_tokenizer()("cat \xed\xa0\x80"),
            "clip_tokenizer: text is byte 237 at offset 4, which begins no character, expected valid UTF-8",
            value_error);
        CHECK_THROWS_WITH_AS(small_tokenizer(1), "clip_tokenizer: context_length is 1, expected at least 2",
                             value_error);
    }

    TEST_CASE("prompts have the ids that transformers gives them") {
        auto const golden = golden_file("clip_tokenizer/golden.json");
        auto const prompts = golden.at("prompts").get<std::vector<std::string>>();
        CHECK(prompts.size() >= 190);
        CHECK(golden.at("folders").size() == 6);
        for (auto const& folder : golden.at("folders")) {
            auto const name = folder.at("name").get<std::string>();
            CAPTURE(name);
            clip_tokenizer_files files{"folder", {}};
            for (auto const& file : folder.at("shared")) {
                auto const text_name = file.get<std::string>();
                std::ifstream text(std::filesystem::path(GENRENDER_TEST_DATA) / "clip_tokenizer" / text_name);
                files.texts[text_name] = {std::istreambuf_iterator<char>(text), std::istreambuf_iterator<char>()};
            }
            for (auto const& [file, content] : folder.at("files").items()) {
                files.texts[file] = content.dump();
            }
            auto const tokenizer = make_clip_tokenizer(files);
            CHECK(tokenizer.context_length() == folder.at("context_length"));
            CHECK(tokenizer.padding() == folder.at("padding"));
            auto const& outputs = folder.at("cut_and_ids");
            REQUIRE(outputs.size() == prompts.size());
            for (std::size_t i = 0; i < prompts.size(); ++i) {
                CAPTURE(prompts[i]);
                auto expected = outputs[i].get<id_list>();
                auto const cut = expected.front();
                expected.erase(expected.begin());
                expected.resize(tokenizer.context_length(), tokenizer.padding());
                auto const found = tokenizer(prompts[i]);
                CHECK(found.ids == expected);
                CHECK(found.cut == cut);
            }
        }
    }
}
