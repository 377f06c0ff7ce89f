// SPDX-License-Identifier: MIT
// Tests of the tensors of a file.
#include <genrender/reference/tensor_file.hpp>

#include "safetensors_bytes.hpp"
#include "small_networks.hpp"

#include <genrender/reference/safetensors.hpp>

#include <doctest/doctest.h>

#include <array>
#include <string>
#include <vector>

using namespace genrender;

using namespace genrender::reference;
using testing::bytes_of;
using testing::safetensors_bytes;
using testing::temporary_file;
using testing::write_bytes;

TEST_SUITE("reference/tensor_file") {
    TEST_CASE_TEMPLATE("every kind of number is read as Real", Real, float, double) {
        // The header has 5 bytes too many for aligned data.
        std::string data;
        for (double const value : {1.5, -2.0}) {
            data.append(reinterpret_cast<char const*>(&value), 8);
        }
        data += bytes_of({0.25f, 3.0f});
        for (auto const bits : std::array<std::uint16_t, 4>{0x3C00, 0xC000, 0x3F80, 0xC049}) {
            data.append(reinterpret_cast<char const*>(&bits), 2);
        }
        auto header = std::string(R"({"d":{"dtype":"F64","shape":[2],"data_offsets":[0,16]},)") +
                      R"("f":{"dtype":"F32","shape":[2,1],"data_offsets":[16,24]},)" +
                      R"("h":{"dtype":"F16","shape":[2],"data_offsets":[24,28]},)" +
                      R"("b":{"dtype":"BF16","shape":[1,2],"data_offsets":[28,32]},"__metadata__":{"format":"pt"}})";
        header += std::string((8 - header.size() % 8) % 8 + 5, ' ');
        temporary_file const file("numbers.safetensors");
        write_bytes(file.path(), safetensors_bytes(header, data));
        safetensors_file const tensors(file.path());
        CHECK(tensors.read<Real>("d") == std::vector<Real>{Real(1.5), -2});
        CHECK(tensors.read<Real>("f") == std::vector<Real>{Real(0.25), 3});
        CHECK(tensors.read<Real>("h") == std::vector<Real>{1, -2});
        CHECK(tensors.read<Real>("b") == std::vector<Real>{1, Real(-3.140625)});
        CHECK(tensors.entries().at("f").shape == std::vector<std::size_t>{2, 1});
        CHECK(tensors.metadata().at("format") == "pt");
        CHECK(tensors.entries().size() == 4);
    }

    TEST_CASE("other types are listed and refused when asked for") {
        temporary_file const file("types.safetensors");
        write_bytes(file.path(), safetensors_bytes(R"({"ids":{"dtype":"I64","shape":[1],"data_offsets":[0,8]},)"
                                                   R"("new":{"dtype":"F4","shape":[6],"data_offsets":[8,11]}})",
                                                   "01234567abc"));
        safetensors_file const tensors(file.path());
        CHECK(tensors.entries().at("new").dtype == "F4");
        CHECK_THROWS_WITH_AS(tensors.read<float>("ids"),
                             (file.path() + ": tensor ids has dtype I64, expected F64, F32, F16 or BF16").c_str(),
                             file_error);
        CHECK_THROWS_WITH_AS(tensors.read<float>("new"),
                             (file.path() + ": tensor new has dtype F4, expected F64, F32, F16 or BF16").c_str(),
                             file_error);
        CHECK_THROWS_WITH_AS(tensors.read<float>("old"),
                             (file.path() + ": there is no tensor old, expected one among the 2 of the file").c_str(),
                             file_error);
    }
}
