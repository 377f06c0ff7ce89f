// SPDX-License-Identifier: MIT
// Latents as a file that NumPy reads.
#include "examples/support/npy_file.hpp"

#include "../support/scratch_folder.hpp"

#include <doctest/doctest.h>

#include <bit>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

using namespace genrender;

TEST_SUITE("examples_support/npy_file") {
    TEST_CASE("the file is a header of a whole number of 64 bytes and then the elements, the last axis fastest") {
        tests::scratch_folder const folder;
        auto const path = folder / "deeper" / "z.npy";
        std::vector<float> values(2 * 3 * 1 * 2);
        for (std::size_t i = 0; i < values.size(); ++i) {
            values[i] = 0.5F * static_cast<float>(i) - 1;
        }
        examples::write_npy(path, strided_view<float const, 4>(values.data(), {2, 3, 1, 2}));
        std::ifstream file(path, std::ios::binary);
        std::string const bytes{std::istreambuf_iterator<char>(file), {}};
        auto const byte = [&](std::size_t i) {
            return static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[i]));
        };

        CHECK(bytes.substr(0, 8) == std::string("\x93NUMPY\x01\0", 8));
        auto const header = byte(8) + 256 * byte(9);
        CHECK((10 + header) % 64 == 0);
        CHECK(bytes.substr(10, header).find("{'descr': '<f4', 'fortran_order': False, 'shape': (2, 3, 1, 2, ), }") ==
              0);
        CHECK(bytes[10 + header - 1] == '\n');
        REQUIRE(bytes.size() == 10 + header + 4 * values.size());
        for (std::size_t i = 0; i < values.size(); ++i) {
            auto const at = 10 + header + 4 * i;
            auto const bits = byte(at) | byte(at + 1) << 8U | byte(at + 2) << 16U | byte(at + 3) << 24U;
            CHECK(std::bit_cast<float>(bits) == values[i]);
        }
    }

    TEST_CASE("elements of a view that skips memory are written in the view's order") {
        tests::scratch_folder const folder;
        std::vector<float> const every_second{1, -1, 2, -1, 3, -1};
        std::vector<float> const dense{1, 2, 3};
        examples::write_npy(folder / "a.npy",
                            strided_view<float const, 4>(every_second.data(), {1, 1, 1, 3}, {6, 6, 6, 2}));
        examples::write_npy(folder / "b.npy", strided_view<float const, 4>(dense.data(), {1, 1, 1, 3}));
        auto const read = [](std::filesystem::path const& path) {
            std::ifstream file(path, std::ios::binary);
            return std::string{std::istreambuf_iterator<char>(file), {}};
        };
        CHECK(read(folder / "a.npy") == read(folder / "b.npy"));
    }
}
