// SPDX-License-Identifier: MIT
// Files that are being written, by programs that live and that do not.
#include "examples/support/output_file.hpp"

#include "../support/scratch_folder.hpp"

#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include <sys/wait.h>
#include <unistd.h>

using namespace genrender;

TEST_SUITE("examples_support/output_file") {
    TEST_CASE("a file has its name after the commit, and before it there is the old one") {
        for (auto const is_on_disk : {false, true}) {
            tests::scratch_folder const folder;
            auto const path = folder.write("file", "old");
            {
                examples::output_file file(path);
                std::ofstream(file.temporary()) << "new one";
                CHECK(std::filesystem::file_size(path) == 3);
                is_on_disk ? file.commit_to_disk() : file.commit();
                CHECK(std::filesystem::file_size(path) == 7);
            }
            CHECK(folder.entries() == 1);
        }
    }
    TEST_CASE("what a program that was killed left is removed, what is being written and other names are not") {
        tests::scratch_folder const folder;
        auto const child = ::fork();
        if (child == 0) {
            examples::output_file const file(folder / "a file.png");
            ::_exit(0); // without its destructor, as who is killed
        }
        REQUIRE(child > 0);
        REQUIRE(::waitpid(child, nullptr, 0) == child);
        CHECK(folder.entries() == 1);
        examples::output_file const under_way(folder / "file");
        for (auto const* const name : {"x.part", ".x-1-1.png", ".part.x"}) {
            folder.write(name, "");
        }
        examples::remove_left_parts(folder.path());
        CHECK(folder.entries() == 4);
        CHECK(std::filesystem::exists(under_way.temporary()));
        CHECK_NOTHROW(examples::remove_left_parts(folder / "nowhere"));
    }
}
