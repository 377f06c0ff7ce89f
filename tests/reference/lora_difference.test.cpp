// SPDX-License-Identifier: MIT
// Tests of what a LoRA adds to a weight.
#include <genrender/reference/lora_difference.hpp>

#include "small_networks.hpp"

#include <genrender/reference/safetensors.hpp>

#include <doctest/doctest.h>

#include <memory>
#include <vector>

using namespace genrender;

using namespace genrender::reference;

TEST_SUITE("reference/lora_difference") {
    TEST_CASE_TEMPLATE("a weight is changed by the factor times the product of both", Real, float, double) {
        testing::temporary_file const path("factors.safetensors");
        std::vector<float> const down{1, 2, 3, 4, 5, 6}; // [2, 3]
        std::vector<float> const up{1, -1, 2, 0};        // [2, 2]
        write_safetensors(path.path(), {{"down", {{2, 3}, down}}, {"up", {{2, 2}, up}}});
        auto const places = places_of(std::make_shared<safetensors_file const>(path.path()));
        std::vector<Real> weight(6, 1);
        add_difference<Real>(weight, {places.at("down"), places.at("up"), 0.5});
        CHECK(weight == std::vector<Real>{Real(-0.5), Real(-0.5), Real(-0.5), 2, 3, 4});
    }
}
