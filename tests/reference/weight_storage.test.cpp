// SPDX-License-Identifier: MIT
// Tests of the types that weights are kept in.
#include <genrender/reference/weight_storage.hpp>

#include <doctest/doctest.h>

TEST_SUITE("reference/weight_storage") {
    TEST_CASE("what a file has in 16 bits can stay in 16 bits and nothing else") {
        using genrender::reference::storage_of_dtype;
        using genrender::reference::weight_storage;
        CHECK(storage_of_dtype("F16") == weight_storage::float16);
        CHECK(storage_of_dtype("BF16") == weight_storage::bfloat16);
        CHECK(storage_of_dtype("F32") == weight_storage::real);
        CHECK(storage_of_dtype("F64") == weight_storage::real);
    }
}
