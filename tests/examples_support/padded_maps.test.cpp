// SPDX-License-Identifier: MIT
// Maps in larger and smaller extents.
#include <examples/support/padded_maps.hpp>

#include <doctest/doctest.h>

using namespace genrender;
using namespace genrender::examples;

namespace {

/// Maps [2, 3, 2] whose values are numbered.
rendered_guidance numbered_maps() {
    rendered_guidance maps{uv_maps(2, {3, 2}), depth_maps(2, {3, 2}), tensor<float, 4>::from_shape({2, 3, 2, 3})};
    for (std::size_t i = 0; i < 12; ++i) {
        maps.uv.uv.data()[2 * i] = static_cast<float>(i) / 12;
        maps.uv.uv.data()[2 * i + 1] = 0.5f;
        maps.uv.object.data()[i] = static_cast<std::uint32_t>(i);
        maps.uv.coverage.data()[i] = 1;
        maps.depth.depth.data()[i] = static_cast<float>(i + 1);
        maps.depth.coverage.data()[i] = 1;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            maps.position.data()[3 * i + axis] = static_cast<float>(10 * i + axis);
        }
    }
    return maps;
}

} // namespace

TEST_SUITE("examples_support/padded_maps") {
    TEST_CASE("what is added shows nothing and what was there stays where it was") {
        auto const maps = numbered_maps();
        auto const more = with_extents(maps, {4, 5});
        CHECK(more.uv.grid() == grid_extents{4, 5});
        for (std::size_t frame = 0; frame < 2; ++frame) {
            for (std::size_t row = 0; row < 4; ++row) {
                for (std::size_t column = 0; column < 5; ++column) {
                    auto const was = row < 3 && column < 2;
                    CHECK(more.uv.coverage(frame, row, column) == (was ? 1 : 0));
                    CHECK(more.depth.coverage(frame, row, column) == (was ? 1 : 0));
                    if (was) {
                        CHECK(more.uv.uv(frame, row, column, 0) == maps.uv.uv(frame, row, column, 0));
                        CHECK(more.uv.object(frame, row, column) == maps.uv.object(frame, row, column));
                        CHECK(more.depth.depth(frame, row, column) == maps.depth.depth(frame, row, column));
                        CHECK(more.position(frame, row, column, 2) == maps.position(frame, row, column, 2));
                    }
                }
            }
        }
    }

    TEST_CASE("cutting what was added gives the maps back") {
        auto const maps = numbered_maps();
        auto const back = with_extents(with_extents(maps, {16, 8}), {3, 2});
        CHECK(back.uv.uv == maps.uv.uv);
        CHECK(back.uv.object == maps.uv.object);
        CHECK(back.uv.coverage == maps.uv.coverage);
        CHECK(back.depth.depth == maps.depth.depth);
        CHECK(back.position == maps.position);
        CHECK(with_extents(numbered_maps(), {2, 4}).uv.grid() ==
              grid_extents{2, 4}); // less of one side, more of the other
    }

    TEST_CASE("pictures are cut on the right and below") {
        auto pictures = tensor<float, 4>::from_shape({1, 3, 4, 4});
        for (std::size_t i = 0; i < pictures.size(); ++i) {
            pictures.data()[i] = static_cast<float>(i);
        }
        auto const cut = with_extents(pictures, {3, 2});
        CHECK(cut.shape()[2] == 3);
        CHECK(cut.shape()[3] == 2);
        CHECK(cut(0, 1, 2, 1) == pictures(0, 1, 2, 1));
        CHECK(cut(0, 2, 0, 0) == pictures(0, 2, 0, 0));
    }
}
