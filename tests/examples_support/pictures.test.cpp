// SPDX-License-Identifier: MIT
// Pictures and PNG files, read back.
#include <examples/support/pictures.hpp>

#include "../support/scratch_folder.hpp"

#include <doctest/doctest.h>

#include <fstream>

using namespace genrender;
using namespace genrender::examples;
using genrender::tests::scratch_folder;

namespace {

rgb8_image every_byte() {
    rgb8_image image({5, 17}, {0, 0, 0});
    for (std::size_t i = 0; i < image.bytes.size(); ++i) {
        image.bytes[i] = static_cast<std::uint8_t>(i);
    }
    return image;
}

} // namespace

TEST_SUITE("examples_support/pictures") {
    TEST_CASE("a PNG file gives the same bytes back and nothing else stays in its folder") {
        scratch_folder const folder;
        auto const image = every_byte();
        write_png(folder / "a.png", rgb8_image({1, 1}, {9, 9, 9}));
        write_png(folder / "a.png", image);
        auto const back = read_png(folder / "a.png");
        CHECK(back.grid() == image.grid());
        CHECK(back.bytes == image.bytes);
        CHECK(folder.entries() == 1);
    }

    TEST_CASE("a picture that cannot be written names the folder or file and leaves nothing") {
        scratch_folder const folder;
        auto const file = folder.write("file", "");
        CHECK_THROWS_WITH_AS(write_png(file / "a.png", every_byte()),
                             (file.string() +
                              ": is no folder and cannot be made one (Not a directory), expected a place "
                              "that can be written")
                                 .c_str(),
                             file_error);
        std::filesystem::create_directory(folder / "taken.png");
        CHECK_THROWS_WITH_AS(
            write_png(folder / "taken.png", every_byte()),
            ((folder / "taken.png").string() + ": cannot be replaced (Is a directory), expected a file name").c_str(),
            file_error);
        CHECK(folder.entries() == 2);
        if (std::filesystem::exists("/proc/self")) {
            CHECK_THROWS_AS(write_png("/proc/self/a.png", every_byte()), file_error);
        }
    }

    TEST_CASE("images without pixels or with missing bytes are refused") {
        scratch_folder const folder;
        CHECK_THROWS_WITH_AS(write_png(folder / "a.png", {}), "write_png: image is [0, 0], expected at least one pixel",
                             shape_error);
        auto image = every_byte();
        image.bytes.pop_back();
        CHECK_THROWS_WITH_AS(write_png(folder / "a.png", image), "write_png: image.bytes is [254], expected [255]",
                             shape_error);
    }

    TEST_CASE("files that are no PNG are refused by name") {
        scratch_folder const folder;
        CHECK_THROWS_AS(read_png(folder / "missing.png"), file_error);
        auto const file = folder.write("foreign.png", "not a picture, but a text of some length");
        CHECK_THROWS_WITH_AS(
            read_png(file),
            (file.string() + ": cannot be read as PNG (Not a PNG file), expected a whole PNG file").c_str(),
            file_error);
        write_png(folder / "whole.png", every_byte());
        std::ifstream stream(folder / "whole.png", std::ios::binary);
        std::string const whole{std::istreambuf_iterator<char>(stream), {}};
        CHECK_THROWS_AS(read_png(folder.write("half.png", whole.substr(0, whole.size() / 2))), file_error);
    }

    TEST_CASE("colours are clamped to 0 and 1") {
        tensor<float, 3> rgb = xt::zeros<float>({3, 1, 2});
        rgb(0, 0, 0) = 1.5f;
        rgb(1, 0, 0) = -2;
        rgb(2, 0, 0) = 0.5f;
        rgb(0, 0, 1) = std::numeric_limits<float>::quiet_NaN();
        auto const image = rgb_picture(rgb);
        CHECK(image.at(0, 0) == rgb8{255, 0, 128});
        CHECK(image.at(0, 1) == rgb8{0, 0, 0});
        tensor<float, 3> const grey = xt::zeros<float>({1, 1, 2});
        CHECK_THROWS_WITH_AS(rgb_picture(grey), "rgb_picture: rgb is [1, 1, 2], expected [3, 1, 2]", shape_error);
    }

    TEST_CASE("UV pictures show u in red and v in green and leave the background dark") {
        uv_maps maps(2, {1, 3});
        maps.coverage(1, 0, 0) = maps.coverage(1, 0, 1) = 1;
        maps.uv(1, 0, 0, 0) = 0.76f;
        maps.uv(1, 0, 1, 1) = 0.76f;
        auto const pictures = uv_pictures(maps);
        CHECK(pictures.size() == 2);
        CHECK(pictures[0].at(0, 0) == rgb8{16, 16, 24});
        CHECK(pictures[1].at(0, 2) == rgb8{16, 16, 24});
        CHECK(pictures[1].at(0, 0)[0] > 2 * pictures[1].at(0, 0)[1]);
        CHECK(pictures[1].at(0, 1)[1] > 2 * pictures[1].at(0, 1)[0]);
        maps.object(1, 0, 1) = 1;
        CHECK(uv_pictures(maps)[1].at(0, 1)[2] != pictures[1].at(0, 1)[2]);
    }

    TEST_CASE("depth pictures are bright where near on one scale for all frames") {
        depth_maps maps(2, {1, 2});
        maps.coverage(0, 0, 0) = maps.coverage(1, 0, 0) = 1;
        maps.depth(0, 0, 0) = 1;
        maps.depth(1, 0, 0) = 4;
        auto const pictures = depth_pictures(maps);
        CHECK(pictures[0].at(0, 0) == rgb8{255, 255, 255});
        CHECK(pictures[1].at(0, 0) == rgb8{51, 51, 51});
        CHECK(pictures[1].at(0, 1) == rgb8{0, 0, 0});
    }

    TEST_CASE("enlarging makes squares of pixels") {
        rgb8_image image({1, 2}, {1, 2, 3});
        image.set(0, 1, {4, 5, 6});
        auto const large = enlarge(image, 3);
        CHECK(large.grid() == grid_extents{3, 6});
        CHECK(large.at(2, 2) == rgb8{1, 2, 3});
        CHECK(large.at(0, 3) == rgb8{4, 5, 6});
        CHECK_THROWS_WITH_AS(enlarge(image, 0), "enlarge: factor is 0, expected at least 1", value_error);
    }
}
