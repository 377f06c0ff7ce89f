// SPDX-License-Identifier: MIT
// What is kept comes back to the bit under its own key and under no other.
#include <examples/evaluation/run_store.hpp>

#include <genrender/core/stack.hpp>

#include <doctest/doctest.h>

#include "../support/scratch_folder.hpp"

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

using namespace genrender;
using namespace genrender::examples;

TEST_SUITE("evaluation_program/run_store") {
    TEST_CASE("a run comes back to the bit under its key and not under another") {
        tests::scratch_folder const folder;
        run_store const store(folder.path());
        CHECK_FALSE(store.find("alpha = 0.7"));
        store.keep("alpha = 0.7", {{{"error", 0.1 + 0.2}, {"pairs", 3}}, 1.5});
        auto const kept = run_store(folder.path()).find("alpha = 0.7");
        REQUIRE(kept);
        CHECK(kept->figures == measures{{"error", 0.1 + 0.2}, {"pairs", 3}});
        CHECK(kept->seconds == 1.5);
        CHECK_FALSE(store.find("alpha = 0.8"));
    }

    TEST_CASE("a file that is cut, or of a key with the same number, is as if it was not there") {
        tests::scratch_folder const folder;
        run_store const store(folder.path());
        store.keep("one", {{{"error", 0.5}}, 1});
        auto const path = folder.path() / (hexadecimal(number_of("one")) + ".json");
        REQUIRE(std::filesystem::exists(path));
        std::ifstream file(path);
        std::string const text{std::istreambuf_iterator<char>(file), {}};
        std::ofstream(path) << text.substr(0, text.size() / 2);
        CHECK_FALSE(store.find("one"));
        std::ofstream(path) << R"({"key": "two", "seconds": 1, "figures": {"error": 0.5}})";
        CHECK_FALSE(store.find("one"));
        std::ofstream(path) << R"({"key": "one", "seconds": 1, "figures": {"error": "0.5"}})";
        CHECK_FALSE(store.find("one"));
    }

    TEST_CASE("frames come back in their order, as many as there are") {
        tests::scratch_folder const folder;
        run_store const store(folder.path());
        CHECK_FALSE(store.frames("one", 2));
        stack<float, 4> images({2, 3, 4, 5});
        images(1, 0, 3, 2) = 1;
        store.keep_frames("one", images.view());
        auto const frames = store.frames("one", 2);
        REQUIRE(frames);
        REQUIRE(frames->size() == 2);
        CHECK(frames->at(1).at(3, 2) == rgb8{255, 0, 0});
        CHECK(frames->at(0).at(3, 2) == rgb8{0, 0, 0});
        CHECK(frames->at(0).grid() == grid_extents{4, 5});
        CHECK_FALSE(store.frames("one", 3));
    }

    TEST_CASE("another byte, another name and no files at all change a folder's digest") {
        tests::scratch_folder const folder;
        std::filesystem::create_directories(folder.path() / "unet");
        CHECK_THROWS_AS(digest_of(folder.path()), file_error);
        std::ofstream(folder.path() / "unet" / "weights") << "abc";
        auto const first = digest_of(folder.path());
        CHECK(digest_of(folder.path()) == first);
        std::ofstream(folder.path() / "unet" / "weights") << "abd";
        CHECK(digest_of(folder.path()) != first);
        std::ofstream(folder.path() / "unet" / "weights") << "abc";
        CHECK(digest_of(folder.path()) == first);
        std::filesystem::rename(folder.path() / "unet" / "weights", folder.path() / "unet" / "weighs");
        CHECK(digest_of(folder.path()) != first);
    }

    TEST_CASE("numbers of texts are FNV-1a's") {
        CHECK(hexadecimal(number_of("")) == "cbf29ce484222325");
        CHECK(hexadecimal(number_of("a")) == "af63dc4c8601ec8c");
        CHECK(hexadecimal(number_of("foobar")) == "85944171f73967e8");
    }
}
