// SPDX-License-Identifier: MIT
// Tables line up.
#include <examples/support/text_table.hpp>

#include <doctest/doctest.h>

TEST_SUITE("examples_support/text_table") {
    using namespace genrender::examples;

    TEST_CASE("columns are as wide as their widest cell and numbers end below each other") {
        CHECK(table_text({{"grid", "hits"}, {"64x64", "7"}, {"8x8", ""}}) == "  grid   hits\n"
                                                                             "  64x64     7\n"
                                                                             "  8x8\n");
        CHECK(table_text({}).empty());
    }
}
