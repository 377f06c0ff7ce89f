// SPDX-License-Identifier: MIT
// Frames handed to a program that encodes them.
#include <examples/support/video_file.hpp>

#include "../support/scratch_folder.hpp"

#include <doctest/doctest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

using namespace genrender;
using namespace genrender::examples;
using genrender::tests::scratch_folder;

namespace {

/// A program of the shell that is called ffmpeg.
std::filesystem::path stand_in(scratch_folder const& folder, std::string const& text) {
    auto const path = folder.write("ffmpeg", "#!/bin/sh\n" + text);
    std::filesystem::permissions(path, std::filesystem::perms::owner_all);
    return path;
}

std::string content(std::filesystem::path const& path) {
    std::ifstream stream(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

} // namespace

TEST_SUITE("examples_support/video_file") {
    TEST_CASE("the program gets every frame and its rate and the file appears when it is done") {
        scratch_folder const folder;
        // Takes its words down, and the frames to the file that the last word names.
        auto const ffmpeg = stand_in(folder, "echo \"$@\" > " + (folder / "words").string() +
                                                 "\nfor last; do :; done\ncat > \"$last\"\n");
        std::vector<rgb8_image> const frames{{{2, 3}, {1, 2, 3}}, {{2, 3}, {4, 5, 6}}};
        write_mp4(ffmpeg, folder / "a b.mp4", frames, 12.5);
        std::string expected;
        for (auto const& frame : frames) {
            expected.append(frame.bytes.begin(), frame.bytes.end());
        }
        CHECK(content(folder / "a b.mp4") == expected);
        auto const words = content(folder / "words");
        CHECK(words.find("-s 3x2 -r 12.500000 -i -") != std::string::npos);
    }

    TEST_CASE("a program that fails or reads nothing or is none leaves no file") {
        scratch_folder const folder;
        std::vector<rgb8_image> const frames(20, rgb8_image({64, 64}, {1, 2, 3}));
        for (auto const* const text : {"cat > /dev/null; exit 3\n", "exit 0\n", "kill -9 $$\n"}) {
            CHECK_THROWS_AS(write_mp4(stand_in(folder, text), folder / "a.mp4", frames, 24), file_error);
            CHECK_FALSE(std::filesystem::exists(folder / "a.mp4"));
        }
        CHECK_THROWS_AS(write_mp4(folder / "nowhere", folder / "a.mp4", frames, 24), file_error);
        CHECK_THROWS_AS(write_mp4(folder / "ffmpeg", folder / "a.mp4", {}, 24), value_error);
        CHECK(folder.entries() == 1); // the stand-in alone
    }

    TEST_CASE("a program is looked for in the folders of PATH") {
        CHECK(program_on_path("sh").has_value());
        CHECK_FALSE(program_on_path("a_program_of_no_name").has_value());
    }
}
