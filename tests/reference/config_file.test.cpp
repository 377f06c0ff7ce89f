// SPDX-License-Identifier: MIT
// Tests of the reader of options.
#include <genrender/reference/config_file.hpp>

#include "small_networks.hpp"

#include <doctest/doctest.h>

#include <fstream>
#include <string>
#include <vector>

using namespace genrender;

using namespace genrender::reference;
using namespace genrender::testing;

namespace {

/// A file of this text, opened.
struct written_config {
    temporary_file file{"config.json"};
    config_file config;

    explicit written_config(std::string const& text) : config(written(file.path(), text)) {}
    static std::string const& written(std::string const& path, std::string const& text) {
        std::ofstream(path) << text;
        return path;
    }
    std::string text(std::string const& sentence) const { return file.path() + ": " + sentence; }
};

} // namespace

TEST_SUITE("reference/config_file") {
    TEST_CASE("options have their values or what stands for their absence") {
        written_config written(
            R"({"n": 3, "x": 0.5, "yes": true, "word": "silu", "list": [1, 2], "words": ["a", "b"]})");
        auto& config = written.config;
        CHECK(config.count("n", 1) == 3);
        CHECK(config.number("x", 1) == 0.5);
        CHECK(config.number("n", 1) == 3);
        CHECK(config.flag("yes", false));
        CHECK(config.text("word", "") == "silu");
        CHECK(config.counts("list", {}) == std::vector<std::size_t>{1, 2});
        CHECK(config.texts("words", {}) == std::vector<std::string>{"a", "b"});
        CHECK(config.count_a_level("list", 2, 7) == std::vector<std::size_t>{1, 2});
        CHECK(config.count_a_level("n", 2, 7) == std::vector<std::size_t>{3, 3});
        CHECK(config.same_count("n", 2, 7) == 3);
        CHECK(config["word"] == "silu");
        CHECK_NOTHROW(config.require_all_taken());

        CHECK(config.count("no", 1) == 1);
        CHECK(config.number("no", 0.25) == 0.25);
        CHECK(config.flag("no", true));
        CHECK(config.text("no", "x") == "x");
        CHECK(config.counts("no", {5}) == std::vector<std::size_t>{5});
        CHECK(config.texts("no", {"y"}) == std::vector<std::string>{"y"});
        CHECK(config.count_a_level("no", 2, 7) == std::vector<std::size_t>{7, 7});
        CHECK(config["no"].is_null());
    }

    TEST_CASE("a value of another kind is named") {
        written_config written(R"({"a": "3", "b": -1, "c": 2.5, "d": null, "e": [1, 0], "f": [], "g": [2, 3],
                                   "h": 1000001, "long": "12345678901234567890123456789012345678901234567890)"
                               R"(12345678901234567890123456789012345"})");
        auto& config = written.config;
        auto const check = [&](auto read, char const* sentence) {
            CHECK_THROWS_WITH_AS(read(), written.text(sentence).c_str(), file_error);
        };
        check([&] { config.count("a", 1); }, "option a is \"3\", expected a whole number from 1 to 1000000");
        check([&] { config.count("b", 1); }, "option b is -1, expected a whole number from 1 to 1000000");
        check([&] { config.count("c", 1); }, "option c is 2.5, expected a whole number from 1 to 1000000");
        check([&] { config.count("d", 1); }, "option d is null, expected a whole number from 1 to 1000000");
        check([&] { config.count("h", 1); }, "option h is 1000001, expected a whole number from 1 to 1000000");
        check([&] { config.number("a", 1); }, "option a is \"3\", expected a number");
        check([&] { config.flag("b", true); }, "option b is -1, expected true or false");
        check([&] { config.text("b", ""); }, "option b is -1, expected a text");
        check([&] { config.texts("e", {}); }, "option e is [1,0], expected a list of texts");
        check([&] { config.counts("e", {}); }, "option e is [1,0], expected a list of whole numbers from 1 to 1000000");
        check([&] { config.counts("f", {}); }, "option f is [], expected a list of whole numbers from 1 to 1000000");
        check([&] { config.count_a_level("g", 3, 1); }, "option g is [2,3], expected one number or 3");
        check([&] { config.same_count("g", 2, 1); }, "option g is [2,3], expected the same number for each level");
        check([&] { config.flag("long", true); },
              "option long is \"1234567890123456789012345678901234567890123456789012345678901234567890123456..., "
              "expected true or false");
    }

    TEST_CASE("an option with supported values may be absent and nothing else") {
        written_config written(R"({"eps": 1e-05, "scale": 1.0, "act": "relu"})");
        auto& config = written.config;
        CHECK_NOTHROW(config.expect("eps", {1e-5}));
        CHECK_NOTHROW(config.expect("scale", {1}));
        CHECK_NOTHROW(config.expect("no", {true}));
        CHECK_THROWS_WITH_AS(config.expect("act", {"silu", nullptr}),
                             written.text("option act is \"relu\", expected \"silu\" or null").c_str(), file_error);
    }

    TEST_CASE("options that nobody takes are named") {
        written_config written(R"({"a": 1, "b": 2, "c": 3, "d": 4, "e": 5, "f": 6, "g": 7})");
        CHECK_THROWS_WITH_AS(written.config.require_all_taken(),
                             written.text("7 options are unknown: a, b, c, d, e, ..., expected none").c_str(),
                             file_error);
        written.config.ignore({"a", "b", "c", "d", "e", "f"});
        CHECK_THROWS_WITH_AS(written.config.require_all_taken(),
                             written.text("1 options are unknown: g, expected none").c_str(), file_error);
    }

    TEST_CASE("files that are no object of options are refused") {
        temporary_file const none("none.json");
        CHECK_THROWS_WITH_AS(config_file{none.path()},
                             (none.path() + ": file cannot be opened, expected a readable JSON file").c_str(),
                             file_error);
        CHECK_THROWS_AS(config_file{std::filesystem::temp_directory_path()}, file_error);
        temporary_file const list("list.json");
        std::ofstream(list.path()) << "[1]";
        CHECK_THROWS_WITH_AS(config_file{list.path()},
                             (list.path() + ": file is a JSON array, expected an object of options").c_str(),
                             file_error);
        std::ofstream(list.path()) << "";
        CHECK_THROWS_AS(config_file{list.path()}, file_error);
    }
}
