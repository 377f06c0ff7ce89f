// SPDX-License-Identifier: MIT
// Tests of where tensors lie.
#include <genrender/reference/tensor_place.hpp>

#include "small_networks.hpp"

#include <doctest/doctest.h>

#include <vector>

using namespace genrender;

using namespace genrender::reference;
using testing::temporary_file;

TEST_SUITE("reference/tensor_place") {
    TEST_CASE_TEMPLATE("a place is rows of a stored tensor under another name", Real, float, double) {
        temporary_file const path("places.safetensors");
        std::vector<float> const values{1, 2, 3, 4, 5, 6};
        for (auto const storage : {safetensors_storage::f32, safetensors_storage::f16}) {
            write_safetensors(path.path(), {{"fused", {{3, 2}, values}}}, storage);
            auto const file = std::make_shared<safetensors_file const>(path.path());
            CHECK(tensor_place{file, "fused", {1, 2}, 2}.template read<Real>() == std::vector<Real>{3, 4});
            CHECK(tensor_place{file, "fused", {2, 2}, 2}.template read<Real>() == std::vector<Real>{3, 4, 5, 6});
            CHECK(places_of(file).at("fused").template read<Real>().size() == 6);
            tensor_place const beyond{file, "fused", {2, 2}, 4};
            CHECK_THROWS_WITH_AS(beyond.template read<Real>(),
                                 (path.path() + ": tensor fused has 6 elements, expected 4 from element 4 on").c_str(),
                                 file_error);
        }
    }

    TEST_CASE("a tensor of two files is named") {
        temporary_file const path("places.safetensors");
        std::vector<float> const one{1};
        write_safetensors(path.path(), {{"a", {{1}, one}}});
        auto const file = std::make_shared<safetensors_file const>(path.path());
        auto places = places_of(file);
        CHECK_THROWS_WITH_AS(
            add_places(places, places_of(file)),
            (path.path() + ": tensor a is in " + path.path() + " too, expected each tensor once").c_str(), file_error);
    }

    TEST_CASE("of many names the first five are told and all are counted") {
        counted_names names;
        CHECK(names.text().empty());
        for (auto const* name : {"a", "b", "c", "d", "e"}) {
            names.add(name);
        }
        CHECK(names.text() == "a, b, c, d, e");
        names.add("f");
        CHECK(names.text() == "a, b, c, d, e, ...");
        CHECK(names.count() == 6);
    }
}
