// SPDX-License-Identifier: MIT
// Tests of JSON whose keys occur once.
#include <genrender/reference/checked_json.hpp>

#include <doctest/doctest.h>

using namespace genrender;

using namespace genrender::reference;

TEST_SUITE("reference/checked_json") {
    TEST_CASE("a text becomes its value") {
        auto const json = checked_json(R"({"a": [1, {"b": 2}], "b": {"a": null}})", "x.json", "file", "an object");
        CHECK(json["a"][1]["b"] == 2);
        CHECK(json["b"]["a"].is_null());
    }

    TEST_CASE("a key that occurs twice in an object is refused at any depth") {
        CHECK_THROWS_WITH_AS(checked_json(R"({"a": 1, "b": 2, "a": 1})", "x.json", "file", "an object"),
                             "x.json: file has the key a twice, expected each key once", file_error);
        CHECK_THROWS_WITH_AS(checked_json(R"([{"b": {"c": 1, "c": 2}}])", "x.json", "header", "an object"),
                             "x.json: header has the key c twice, expected each key once", file_error);
    }

    TEST_CASE("what is not JSON is refused") {
        for (auto const* text : {"", "{", "{\"a\": }", "{\"a\": 1} x", "nul", "{\"a\": 1e999}", "\"\xff\""}) {
            CAPTURE(text);
            CHECK_THROWS_AS(checked_json(text, "x.json", "file", "an object"), file_error);
        }
        std::string const deep(100'000, '[');
        CHECK_THROWS_AS(checked_json(deep, "x.json", "file", "an object"), file_error);
    }
}
