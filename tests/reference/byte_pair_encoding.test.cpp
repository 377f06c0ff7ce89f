// SPDX-License-Identifier: MIT
// Tests of byte-pair encoding.
#include <genrender/reference/byte_pair_encoding.hpp>

#include <doctest/doctest.h>

#include <map>
#include <optional>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

using namespace genrender;

using namespace genrender::reference;

namespace {

using merge_list = std::vector<std::pair<std::string, std::string>>;

/// Single letters, within and at the end of words, then what merges make; the unknown token is the last.
struct small_vocabulary {
    std::vector<std::string> tokens;
    std::unordered_map<std::string, std::uint32_t> ids;

    small_vocabulary(std::string const& letters, merge_list const& merges) {
        auto const add = [&](std::string const& token) {
            if (ids.emplace(token, static_cast<std::uint32_t>(tokens.size())).second) {
                tokens.push_back(token);
            }
        };
        for (auto const letter : letters) {
            add(std::string(1, letter));
            add(std::string(1, letter) + "</w>");
        }
        for (auto const& [left, right] : merges) {
            add(left + right);
        }
        add("?");
    }

    byte_pair_encoding encoding(merge_list const& merges) const {
        byte_pair_encoding made(ids, "?");
        for (auto const& [left, right] : merges) {
            made.add_merge(left, right);
        }
        return made;
    }

    std::vector<std::string> encoded(byte_pair_encoding const& encoding, std::string const& word) const {
        std::vector<std::size_t> found;
        encoding.encode(word, found);
        std::vector<std::string> names;
        for (auto const id : found) {
            names.push_back(tokens.at(id));
        }
        return names;
    }
};

/// The plain way: look at all neighbours for the first merge in the list, do it, begin again.
std::vector<std::string> encoded_plainly(merge_list const& merges, std::string const& word) {
    std::vector<std::string> parts;
    for (auto const letter : word) {
        parts.emplace_back(1, letter);
    }
    parts.back() += "</w>";
    for (auto merge = merges.begin(); merge != merges.end();) {
        auto was_found = false;
        for (std::size_t i = 0; i + 1 < parts.size(); ++i) {
            if (parts[i] == merge->first && parts[i + 1] == merge->second) {
                parts[i] += parts[i + 1];
                parts.erase(parts.begin() + static_cast<std::ptrdiff_t>(i) + 1);
                was_found = true;
                break;
            }
        }
        merge = was_found ? merges.begin() : merge + 1;
    }
    return parts;
}

} // namespace

TEST_SUITE("reference/byte_pair_encoding") {
    TEST_CASE("bytes are written in letters that can be seen, each in its own") {
        CHECK(byte_letter('!') == U'!');
        CHECK(byte_letter('~') == U'~');
        CHECK(byte_letter(0) == 0x100);
        CHECK(byte_letter(' ') == 0x120);
        CHECK(byte_letter(0x7f) == 0x121);
        CHECK(byte_letter(0xa0) == 0x142);
        CHECK(byte_letter(0xad) == 0x143);
        CHECK(byte_letter(0xff) == 0xff);
        std::set<char32_t> letters;
        for (unsigned byte = 0; byte < 256; ++byte) {
            letters.insert(byte_letter(static_cast<unsigned char>(byte)));
        }
        CHECK(letters.size() == 256);
    }

    TEST_CASE("the merge that was added first is done first, the leftmost of equals") {
        merge_list const merges{{"b", "c"},       {"a", "b"},     {"a", "a"},     {"bc", "d</w>"},
                                {"aa", "aa</w>"}, {"a", "a</w>"}, {"aa", "a</w>"}};
        small_vocabulary const vocabulary("abcd", merges);
        auto const encoding = vocabulary.encoding(merges);
        auto const encoded = [&](char const* word) { return vocabulary.encoded(encoding, word); };
        using tokens = std::vector<std::string>;
        CHECK(encoded("abc") == tokens{"ab", "c</w>"}); // b and c</w> have no merge
        CHECK(encoded("abca") == tokens{"a", "bc", "a</w>"});
        CHECK(encoded("bcd") == tokens{"bcd</w>"});
        CHECK(encoded("aaa") == tokens{"aaa</w>"});
        CHECK(encoded("aaaa") == tokens{"aaaa</w>"});
        CHECK(encoded("aaaaa") == tokens{"aa", "aaa</w>"}); // a a from the left
        CHECK(encoded("a") == tokens{"a</w>"});
        CHECK(encoded("d") == tokens{"d</w>"});
        CHECK(encoded("").empty());
    }

    TEST_CASE("a merge that is added again comes later") {
        merge_list const merges{{"a", "b"}, {"b", "a"}, {"a", "b"}};
        small_vocabulary const vocabulary("ab", merges);
        CHECK(vocabulary.encoded(vocabulary.encoding(merges), "abab") == std::vector<std::string>{"a", "ba", "b</w>"});
    }

    TEST_CASE("random words become what the plain way makes of them") {
        std::mt19937 draw(3);
        auto const below = [&](std::size_t count) { return draw() % count; };
        std::string const letters = "abc";
        for (int round = 0; round < 60; ++round) {
            std::vector<std::string> parts;
            for (auto const letter : letters) {
                parts.emplace_back(1, letter);
                parts.push_back(std::string(1, letter) + "</w>");
            }
            merge_list merges;
            std::set<std::string> made(parts.begin(), parts.end());
            while (merges.size() < 25) {
                auto const left = parts[below(parts.size())];
                auto const right = parts[below(parts.size())];
                if (left.ends_with("</w>") || left.size() + right.size() > 12 || !made.insert(left + right).second) {
                    continue;
                }
                parts.push_back(left + right);
                merges.insert(merges.begin() + static_cast<std::ptrdiff_t>(below(merges.size() + 1)), {left, right});
            }
            small_vocabulary const vocabulary(letters, merges);
            auto const encoding = vocabulary.encoding(merges);
            for (int word = 0; word < 40; ++word) {
                std::string text;
                for (auto left = 1 + below(30); left > 0; --left) {
                    text += letters[below(letters.size())];
                }
                CAPTURE(text);
                CHECK(vocabulary.encoded(encoding, text) == encoded_plainly(merges, text));
            }
        }
    }

    TEST_CASE("a byte without a token becomes the unknown one and is counted") {
        small_vocabulary const vocabulary("ab", {{"a", "b"}});
        auto const encoding = vocabulary.encoding({{"a", "b"}});
        std::vector<std::size_t> ids{7};
        CHECK(encoding.encode("aba\xc3\xa4", ids) == 2);
        auto const unknown = encoding.unknown();
        CHECK(ids == std::vector<std::size_t>{7, *encoding.id_of("ab"), *encoding.id_of("a"), unknown, unknown});
        CHECK(encoding.size() == 6);
        CHECK(!encoding.id_of("x"));
    }

    TEST_CASE("a long word is encoded in a moment") {
        small_vocabulary const vocabulary("a", {{"a", "a"}, {"aa", "aa"}});
        auto const encoding = vocabulary.encoding({{"a", "a"}, {"aa", "aa"}});
        std::vector<std::size_t> ids;
        CHECK(encoding.encode(std::string(400'001, 'a'), ids) == 0);
        CHECK(ids.size() == 100'001);
    }

    TEST_CASE("a vocabulary or a merge that cannot be is refused") {
        CHECK_THROWS_WITH_AS(
            byte_pair_encoding({{"a", 0}, {"b", 0}}, "a"),
            doctest::Contains("is 0, expected one below 2, the number of tokens, that no other token has"),
            value_error);
        CHECK_THROWS_WITH_AS(
            byte_pair_encoding({{"a", 0}, {"b", 2}}, "a"),
            "byte_pair_encoding: id of the token b is 2, expected one below 2, the number of tokens, that "
            "no other token has",
            value_error);
        CHECK_THROWS_WITH_AS(byte_pair_encoding({{"a", 0}}, "b"),
                             "byte_pair_encoding: unknown token is b, expected a token of the vocabulary", value_error);
        byte_pair_encoding encoding({{"a", 0}, {"b", 1}}, "a");
        CHECK_THROWS_WITH_AS(encoding.add_merge("a", "c"),
                             "byte_pair_encoding: token of a merge is c, expected a token of the vocabulary",
                             value_error);
        CHECK_THROWS_WITH_AS(encoding.add_merge("a", "b"),
                             "byte_pair_encoding: token of a merge is ab, expected a token of the vocabulary",
                             value_error);
    }
}
