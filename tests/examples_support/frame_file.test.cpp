// SPDX-License-Identifier: MIT
// Frames as PNG of 8 and 16 bits and as EXR, with alpha.
#include <examples/support/exr_file.hpp>
#include <examples/support/frame_file.hpp>
#include <examples/support/pictures.hpp>

#include <genrender/core/tensor.hpp>

#include "../support/scratch_folder.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

using namespace genrender;
using namespace genrender::examples;
using genrender::tests::scratch_folder;

namespace {

/// [3, 2, 3], from 0 to 1 with two values beyond.
tensor<float, 3> ramp() {
    auto picture = tensor<float, 3>::from_shape({3, 2, 3});
    for (std::size_t i = 0; i < picture.size(); ++i) {
        picture.data()[i] = static_cast<float>(i) / 17;
    }
    picture.data()[0] = -1;
    picture.data()[17] = 2;
    return picture;
}

tensor<float, 2> half_mask() {
    auto mask = tensor<float, 2>::from_shape({2, 3});
    mask.fill(1);
    mask(0, 0) = 0;
    mask(1, 2) = 0.5f;
    return mask;
}

/// The values of a file of 16 bits, channel by channel, pixel by pixel.
std::vector<long> values_of(std::filesystem::path const& path) {
    auto* file = std::fopen(path.c_str(), "rb");
    REQUIRE(file != nullptr);
    auto* png = png_create_read_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
    auto* info = png_create_info_struct(png);
    png_init_io(png, file);
    png_read_png(png, info, PNG_TRANSFORM_IDENTITY, nullptr);
    std::vector<long> values;
    auto** const rows = png_get_rows(png, info);
    for (png_uint_32 row = 0; row < png_get_image_height(png, info); ++row) {
        for (std::size_t i = 0; i < png_get_rowbytes(png, info); i += 2) {
            values.push_back(256L * rows[row][i] + rows[row][i + 1]);
        }
    }
    png_destroy_read_struct(&png, &info, nullptr);
    std::fclose(file);
    return values;
}

/// Bit depth and colour type of a PNG file, as its header says.
std::pair<int, int> header_of(std::filesystem::path const& path) {
    std::ifstream stream(path, std::ios::binary);
    std::string const bytes(std::istreambuf_iterator<char>(stream), {});
    REQUIRE(bytes.size() > 26);
    return {bytes[24], bytes[25]};
}

} // namespace

TEST_SUITE("examples_support/frame_file") {
    TEST_CASE("8 bits a channel are the picture that people see") {
        scratch_folder const folder;
        auto const picture = ramp();
        auto const path = folder.path() / "8.png";
        write_frame(path, to_view(picture), {}, frame_format::png8);
        CHECK(header_of(path) == std::pair(8, 2));
        CHECK(read_png(path).bytes == rgb_picture(to_view(picture)).bytes);
    }

    TEST_CASE("16 bits a channel keep what 8 round") {
        scratch_folder const folder;
        auto const picture = ramp();
        auto const mask = half_mask();
        auto const path = folder.path() / "16.png";
        write_frame(path, to_view(picture), to_view(mask), frame_format::png16);
        CHECK(header_of(path) == std::pair(16, 6));

        auto const values = values_of(path);
        REQUIRE(values.size() == 2 * 3 * 4);
        for (std::size_t row = 0; row < 2; ++row) {
            for (std::size_t column = 0; column < 3; ++column) {
                auto const* const pixel = &values[(row * 3 + column) * 4];
                CHECK(pixel[3] == std::lround(65535 * mask(row, column)));
                for (std::size_t c = 0; c < 3; ++c) {
                    CHECK(pixel[c] == std::lround(65535 * std::clamp(picture(c, row, column), 0.0f, 1.0f)));
                }
            }
        }
    }

    TEST_CASE("EXR holds light times alpha") {
        scratch_folder const folder;
        auto const picture = ramp();
        auto const mask = half_mask();
        auto const path = folder.path() / "f.exr";
        write_frame(path, to_view(picture), to_view(mask), frame_format::exr);
        exr_file const file(path);
        REQUIRE(file.find("R") != nullptr);
        REQUIRE(file.find("A") != nullptr);
        auto const red = file.plane(*file.find("R"), -1);
        auto const alpha = file.plane(*file.find("A"), -1);
        CHECK(alpha[0] == 0);
        CHECK(alpha[5] == 0.5f);
        CHECK(red[0] == 0);
        CHECK(red[5] == doctest::Approx(0.5f * linear_of_srgb(5.0f / 17)));
    }

    TEST_CASE("the light of a value follows the standard") {
        CHECK(linear_of_srgb(0) == 0);
        CHECK(linear_of_srgb(1) == doctest::Approx(1));
        CHECK(linear_of_srgb(0.5f) == doctest::Approx(0.21404114));
        CHECK(linear_of_srgb(0.04f) == doctest::Approx(0.04 / 12.92));
    }

    TEST_CASE("shapes that differ and folders that cannot be written are refused") {
        scratch_folder const folder;
        auto const picture = ramp();
        auto const mask = tensor<float, 2>::from_shape({3, 3});
        CHECK_THROWS_AS(write_frame(folder.path() / "a.png", to_view(picture), to_view(mask), frame_format::png8),
                        shape_error);
        CHECK_THROWS_AS(write_frame("/dev/null/a.png", to_view(picture), {}, frame_format::png8), file_error);
        CHECK_FALSE(std::filesystem::exists(folder.path() / "a.png"));
    }
}
