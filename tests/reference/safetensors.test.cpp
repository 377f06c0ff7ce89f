// SPDX-License-Identifier: MIT
// Tests of the safetensors reader: what it reads, what it refuses and what it says then.
#include <genrender/reference/safetensors.hpp>

#include "safetensors_bytes.hpp"
#include "small_networks.hpp"

#include <doctest/doctest.h>

#include <array>
#include <fstream>
#include <iterator>
#include <limits>
#include <string>
#include <vector>

using namespace genrender;

using namespace genrender::reference;
using testing::bytes_of;
using testing::safetensors_bytes;
using testing::temporary_file;
using testing::write_bytes;

namespace {

void check_refused(std::string const& bytes, std::string const& sentence) {
    temporary_file const file("refused.safetensors");
    write_bytes(file.path(), bytes);
    CHECK_THROWS_WITH_AS(safetensors_file{file.path()}, (file.path() + ": " + sentence).c_str(), file_error);
}

} // namespace

TEST_SUITE("reference/safetensors") {

    TEST_CASE("single values and empty tensors are legal and so is an empty file") {
        temporary_file const file("odd.safetensors");
        write_bytes(
            file.path(),
            safetensors_bytes(R"({"one":{"dtype":"F32","shape":[],"data_offsets":[0,4]},)"
                              R"("none":{"dtype":"F32","shape":[3,0,4611686018427387904],"data_offsets":[4,4]}})",
                              bytes_of({7.0f})));
        safetensors_file const tensors(file.path());
        CHECK(tensors.read<float>("one") == std::vector<float>{7.0f});
        CHECK(tensors.read<float>("none").empty());
        write_bytes(file.path(), safetensors_bytes("{}"));
        CHECK(safetensors_file(file.path()).entries().empty());
    }

    TEST_CASE("a file that ends too early is refused") {
        CHECK_THROWS_WITH_AS(safetensors_file("/nowhere/w.safetensors"),
                             "/nowhere/w.safetensors: file cannot be opened, expected a readable safetensors file",
                             file_error);
        check_refused("", "file has 0 bytes, expected at least the 8 of the header's length");
        check_refused("1234567", "file has 7 bytes, expected at least the 8 of the header's length");
        check_refused(safetensors_bytes("{}").substr(0, 9),
                      "header has 2 bytes, expected at most the 1 that follow its length");
        check_refused(std::string(8, '\xFF'), "header has 18446744073709551615 bytes, expected at most 100000000");
        check_refused(safetensors_bytes(R"({"x":{"dtype":"F32","shape":[2],"data_offsets":[0,8]}})", "1234567"),
                      "tensor x has data_offsets [0, 8], expected an end within the 7 bytes of data");
    }

    TEST_CASE("a header that is not the JSON it should be is refused") {
        temporary_file const file("json.safetensors");
        write_bytes(file.path(), safetensors_bytes(R"({"x":)"));
        CHECK_THROWS_AS(safetensors_file{file.path()}, file_error);
        check_refused(safetensors_bytes("[1]"), "header is a JSON array, expected an object of tensors");
        check_refused(safetensors_bytes(R"({"x":{},"x":{}})"), "header has the key x twice, expected each key once");
        check_refused(safetensors_bytes(R"({"x":{"shape":[],"shape":[]}})"),
                      "header has the key shape twice, expected each key once");
        check_refused(safetensors_bytes(R"({"x":3})"), "tensor x has no dtype, expected the name of a type");
        check_refused(safetensors_bytes(R"({"x":{"dtype":"F32","data_offsets":[0,4]}})", "1234"),
                      "tensor x has no shape, expected whole numbers of at least 0");
        check_refused(safetensors_bytes(R"({"x":{"dtype":"F32","shape":[-1],"data_offsets":[0,4]}})", "1234"),
                      "tensor x has shape [-1], expected whole numbers of at least 0");
        check_refused(safetensors_bytes(R"({"x":{"dtype":"F32","shape":[1],"data_offsets":[0,4,8]}})", "1234"),
                      "tensor x has 3 data_offsets, expected two");
        check_refused(safetensors_bytes(R"({"__metadata__":{"format":1}})"),
                      "__metadata__ has a number for format, expected a string");
    }

    TEST_CASE("tensors whose bytes do not add up are refused") {
        check_refused(safetensors_bytes(R"({"x":{"dtype":"F32","shape":[1],"data_offsets":[4,0]}})", "1234"),
                      "tensor x has data_offsets [4, 0], expected begin <= end");
        check_refused(safetensors_bytes(R"({"x":{"dtype":"F32","shape":[3],"data_offsets":[0,8]}})", "12345678"),
                      "tensor x has data_offsets [0, 8], expected 12 bytes for F32 [3]");
        check_refused(
            safetensors_bytes(R"({"x":{"dtype":"F32","shape":[1099511627776,1099511627776],"data_offsets":[0,0]}})"),
            "tensor x is F32 [1099511627776, 1099511627776], expected a size that fits 64 bits");
        check_refused(safetensors_bytes(R"({"x":{"dtype":"U8","shape":[4],"data_offsets":[0,4]},)"
                                        R"("y":{"dtype":"U8","shape":[4],"data_offsets":[2,6]}})",
                                        "123456"),
                      "tensor y begins at byte 2, expected 4 where tensor x ends (they overlap)");
        check_refused(safetensors_bytes(R"({"x":{"dtype":"U8","shape":[2],"data_offsets":[0,2]},)"
                                        R"("y":{"dtype":"U8","shape":[2],"data_offsets":[3,5]}})",
                                        "12345"),
                      "tensor y begins at byte 3, expected 2 where tensor x ends (there is a hole)");
        check_refused(safetensors_bytes(R"({"x":{"dtype":"U8","shape":[1],"data_offsets":[1,2]}})", "12"),
                      "tensor x begins at byte 1, expected 0 where the header ends (there is a hole)");
        check_refused(safetensors_bytes(R"({"x":{"dtype":"U8","shape":[1],"data_offsets":[0,1]}})", "12"),
                      "data has 2 bytes, expected 1 where tensor x ends");
    }

    TEST_CASE("what is written is read again") {
        temporary_file const file("written.safetensors");
        std::vector<float> const values{1, -2.5f, 1e-3f, 4, 5, 6};
        std::vector<float> const one{0.1f};
        write_safetensors(file.path(), {{"b.weight", {{2, 3}, values}}, {"a", {{}, one}}});
        safetensors_file const full(file.path());
        CHECK(full.read<float>("b.weight") == values);
        CHECK(full.read<float>("a") == one);
        write_safetensors(file.path(), {{"b.weight", {{2, 3}, values}}, {"a", {{}, one}}}, safetensors_storage::f16);
        safetensors_file const half(file.path());
        CHECK(half.entries().at("b.weight").dtype == "F16");
        for (std::size_t i = 0; i < values.size(); ++i) {
            CHECK(half.read<float>("b.weight")[i] == float_of_half(half_of_float(values[i])));
        }
        CHECK_THROWS_WITH_AS(write_safetensors(file.path(), {{"x", {{4}, values}}}),
                             "write_safetensors: x is [6], expected [4]", shape_error);
        CHECK_THROWS_WITH_AS(write_safetensors("/nowhere/w.safetensors", {}),
                             "/nowhere/w.safetensors: file cannot be written, expected a writable place", file_error);
    }

    TEST_CASE("damaged files are read or refused but nothing else happens") {
        temporary_file const file("damaged.safetensors");
        std::vector<float> const values{1, 2, 3, 4, 5, 6};
        write_safetensors(file.path(), {{"x.weight", {{2, 3}, values}}, {"y", {{6}, values}}});
        std::ifstream source(file.path(), std::ios::binary);
        std::string const whole{std::istreambuf_iterator<char>(source), {}};
        std::size_t refused = 0;
        for (std::uint32_t round = 0; round < 2000; ++round) {
            auto bytes = whole;
            auto const draw = [&](std::uint32_t bound, std::uint32_t what) {
                return uniform_below(bound, 5, random_stream::test, {round, what, 0});
            };
            for (std::uint32_t flip = 0; flip <= round % 3; ++flip) {
                // Most of the flips in the length and the header, where they hurt.
                auto const span = static_cast<std::uint32_t>(round % 4 == 0 ? bytes.size() : 160);
                bytes[draw(span, 3 * flip)] = static_cast<char>(draw(256, 3 * flip + 1));
            }
            if (round % 5 == 0) {
                bytes.resize(draw(static_cast<std::uint32_t>(bytes.size()), 100));
            }
            write_bytes(file.path(), bytes);
            try {
                safetensors_file const damaged(file.path());
                for (auto const& [name, entry] : damaged.entries()) {
                    damaged.read<double>(name);
                }
            } catch (file_error const& error) {
                ++refused;
                REQUIRE(std::string(error.what()).starts_with(file.path() + ": "));
            }
        }
        CHECK(refused > 1000);
        CHECK(refused < 2000);
    }
}
