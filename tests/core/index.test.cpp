// SPDX-License-Identifier: MIT
// Indices are types that do not mix.
#include <genrender/core/index.hpp>

#include <doctest/doctest.h>

#include <concepts>
#include <set>
#include <type_traits>

using namespace genrender;

namespace {

template <class A, class B>
concept comparable_with = requires(A a, B b) {
    a == b;
};

template <class A, class B>
concept mixes_with = std::convertible_to<A, B> || std::convertible_to<B, A> || comparable_with<A, B>;

} // namespace

TEST_SUITE("core/index") {
    TEST_CASE("a frame is no token and no object and no number") {
        CHECK(comparable_with<frame_index, frame_index>);
        CHECK_FALSE(mixes_with<frame_index, token_index>);
        CHECK_FALSE(mixes_with<frame_index, object_index>);
        CHECK_FALSE(mixes_with<token_index, object_index>);
        CHECK_FALSE(mixes_with<pixel, texel>);
        CHECK_FALSE(mixes_with<frame_index, std::uint32_t>);
        CHECK_FALSE(mixes_with<token_index, int>);
    }

    TEST_CASE("indices start at 0 and cost what their numbers cost") {
        CHECK(frame_index{}.value == 0);
        CHECK(token_index{}.value == 0);
        CHECK(object_index{}.value == 0);
        CHECK(sizeof(token_index) == sizeof(std::uint32_t));
        CHECK(std::is_trivially_copyable_v<texel>);
    }

    TEST_CASE("pixels are ordered by row and then by column") {
        CHECK(pixel{0, 9} < pixel{1, 0});
        CHECK(pixel{1, 0} < pixel{1, 1});
        CHECK(pixel{2, 3} == pixel{2, 3});
        CHECK(pixel{2, 3} != pixel{3, 2});
    }

    TEST_CASE("texels are ordered by object and then by row and column") {
        CHECK(texel{{0}, 9, 9} < texel{{1}, 0, 0});
        CHECK(texel{{1}, 0, 9} < texel{{1}, 1, 0});
        CHECK(texel{{1}, 2, 3} != texel{{0}, 2, 3});
        std::set<texel> const different{{{0}, 1, 2}, {{0}, 2, 1}, {{1}, 1, 2}, {{0}, 1, 2}};
        CHECK(different.size() == 3);
    }

    TEST_CASE("a grid counts height times width without overflow of 32 bits") {
        CHECK(grid_extents{3, 5}.size() == 15);
        CHECK(grid_extents{0, 5}.size() == 0);
        CHECK(grid_extents{100000, 100000}.size() == 10000000000U);
        CHECK(grid_extents{3, 5} != grid_extents{5, 3});
    }
}
