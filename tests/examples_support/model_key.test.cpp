// SPDX-License-Identifier: MIT
// Which files of a model tell, and which do not.
#include "examples/support/model_key.hpp"

#include "../support/scratch_folder.hpp"

#include <doctest/doctest.h>

#include <filesystem>
#include <string>

using namespace genrender;

TEST_SUITE("examples_support/model_key") {
    namespace {

    std::uint64_t key_of_model(std::filesystem::path const& path, std::string const& variant = {}) {
        fingerprint all;
        examples::add_model(all, path, variant);
        return all.value();
    }

    } // namespace

    TEST_CASE("weights and settings in a pipeline's folders tell, what else lies there does not") {
        tests::scratch_folder const folder;
        std::filesystem::create_directories(folder / "unet");
        std::filesystem::create_directories(folder / "safety_checker");
        folder.write("unet/config.json", "{}");
        folder.write("unet/weights.safetensors", std::string(3'000'000, 'a'));
        auto const key = key_of_model(folder.path());
        CHECK(key_of_model(folder.path()) == key);
        folder.write("README.md", "A model.");
        folder.write("all_in_one.safetensors", "b");
        folder.write("safety_checker/model.safetensors", "c");
        folder.write("unet/weights.bin", "d");
        folder.write("unet/weights.fp16.safetensors", "e");
        CHECK(key_of_model(folder.path()) == key);
        CHECK(key_of_model(folder.path(), "fp16") != key);
        folder.write("unet/weights.safetensors", std::string(2'999'999, 'a') + "b");
        CHECK(key_of_model(folder.path()) != key);
        folder.write("unet/weights.safetensors", std::string(3'000'000, 'a'));
        CHECK(key_of_model(folder.path()) == key);
        folder.write("unet/config.json", "{ }");
        CHECK(key_of_model(folder.path()) != key);
    }
    TEST_CASE("where a model lies does not tell") {
        tests::scratch_folder const here;
        tests::scratch_folder const there;
        for (auto const* const folder : {&here, &there}) {
            std::filesystem::create_directories(folder->path() / "unet");
            folder->write("unet/weights.fp16.safetensors", "a");
            folder->write("single.safetensors", "b");
        }
        CHECK(key_of_model(here.path()) == key_of_model(there.path()));
        CHECK(key_of_model(here / "unet") == key_of_model(there / "unet"));
        CHECK(key_of_model(here / "single.safetensors") == key_of_model(there / "single.safetensors"));
        CHECK(key_of_model(here.path()) != key_of_model(here / "single.safetensors"));
        CHECK(key_of_model("") != key_of_model(here / "single.safetensors"));
    }
    TEST_CASE("a file that is not there is a sentence") {
        tests::scratch_folder const folder;
        fingerprint all;
        CHECK_THROWS_WITH_AS(examples::add_file(all, folder / "nothing"), doctest::Contains("nothing: cannot be read"),
                             file_error);
    }
}
