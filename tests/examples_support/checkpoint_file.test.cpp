// SPDX-License-Identifier: MIT
// OUT/checkpoint beside what else may lie there.
#include "examples/support/checkpoint_file.hpp"

#include "../support/scratch_folder.hpp"

#include <doctest/doctest.h>

#include <filesystem>
#include <string>

using namespace genrender;

TEST_SUITE("examples_support/checkpoint_file") {
    namespace {

    checkpoint<float> after(std::size_t steps) {
        checkpoint<float> one{steps, latents<float>::from_shape({1, 1, 2, 2}), {}, {1, 2, 3}, {}};
        one.z.fill(static_cast<float>(steps));
        return one;
    }

    } // namespace

    TEST_CASE("each checkpoint takes the place of the one before and leaves nothing else") {
        tests::scratch_folder const folder;
        examples::checkpoint_file file(folder.path());
        CHECK(!file.exists());
        for (std::size_t steps = 1; steps <= 3; ++steps) {
            file.write(after(steps));
            CHECK(file.read().steps == steps);
            CHECK(folder.entries() == 1);
        }
        CHECK(file.bytes() == std::filesystem::file_size(folder / "checkpoint"));
        CHECK(file.seconds() > 0);
        file.remove();
        CHECK(folder.entries() == 0);
    }
    TEST_CASE("one that cannot be written leaves the one before") {
        tests::scratch_folder const folder;
        examples::checkpoint_file file(folder.path());
        file.write(after(1));
        auto wrong = after(2);
        wrong.x0_last = latents<float>::from_shape({1, 1, 2, 3});
        CHECK_THROWS_AS(file.write(wrong), shape_error);
        CHECK(file.read().steps == 1);
        CHECK(folder.entries() == 1);
    }
    TEST_CASE("none, a foreign one and one with something behind it are refused by name") {
        tests::scratch_folder const folder;
        examples::checkpoint_file file(folder.path());
        auto const path = file.path().string();
        CHECK_THROWS_WITH_AS(file.read(),
                             ("--resume: " + path +
                              " is missing, expected the checkpoint of a run that was interrupted (one that is done "
                              "leaves none)")
                                 .c_str(),
                             value_error);
        folder.write("checkpoint", "a letter");
        CHECK_THROWS_WITH_AS(file.read(), (path + ": checkpoint: ends after 8 bytes, expected more").c_str(),
                             file_error);
        file.write(after(1));
        std::ofstream(file.path(), std::ios::app) << "x";
        CHECK_THROWS_WITH_AS(
            file.read(), (path + ": checkpoint: goes on after its end, expected nothing there").c_str(), file_error);
    }
}
