// SPDX-License-Identifier: MIT
// The extents of frames over maps of any size.
#include <examples/support/frame_extents.hpp>

#include <doctest/doctest.h>

#include <cmath>

using namespace genrender;
using namespace genrender::examples;

TEST_SUITE("examples_support/frame_extents") {
    TEST_CASE("what the network renders is the next whole multiple of what is shown") {
        auto const extents = extents_of_frames({60, 107}, 16, 2);
        CHECK(extents.shown == grid_extents{60, 107});
        CHECK(extents.rendered == grid_extents{64, 112});
        CHECK(extents.maps() == grid_extents{128, 224});
        CHECK(extents.shown_maps() == grid_extents{120, 214});
        CHECK(extents.is_cut());
        CHECK_FALSE(extents_of_frames({64, 128}, 64, 1).is_cut());
    }

    TEST_CASE("maps of 720 and 1080 lines have frames at the sizes people ask for") {
        auto const shown = [](grid_extents maps, std::size_t height) {
            return extents_over_maps(maps, height, {}, 16).shown;
        };
        CHECK(shown({720, 1280}, 80) == grid_extents{80, 142});
        CHECK(shown({720, 1280}, 60) == grid_extents{60, 106});
        CHECK(shown({720, 1280}, 64) == grid_extents{65, 116});
        CHECK(shown({720, 1280}, 128) == grid_extents{120, 213});
        CHECK(shown({1080, 1920}, 64) == grid_extents{63, 112});
        CHECK(shown({1080, 1920}, 80) == grid_extents{77, 137});
        CHECK(shown({1080, 1920}, 512) == grid_extents{540, 960});
        CHECK(shown({256, 256}, 128) == grid_extents{128, 128});
        CHECK(shown({256, 256}, 256) == grid_extents{256, 256});
    }

    TEST_CASE("frames lie within the maps at every height and no other whole number of pixels comes nearer") {
        for (std::size_t height = 1; height <= 97; ++height) {
            auto const extents = extents_over_maps({97, 143}, height, {}, 8);
            CHECK(extents.shown_maps().height <= 97);
            CHECK(extents.shown_maps().width <= 143);
            CHECK(extents.rendered.height % 8 == 0);
            CHECK(extents.rendered.width % 8 == 0);
            CHECK(97 - extents.shown_maps().height < extents.map_pixels);
            CHECK(143 - extents.shown_maps().width < extents.map_pixels);
            auto const ratio = 97.0 / static_cast<double>(height);
            CHECK(std::abs(static_cast<double>(extents.map_pixels) - ratio) <= 0.5);
        }
    }

    TEST_CASE("what was done is said and nothing where all is as asked") {
        CHECK(note_on(extents_over_maps({256, 256}, 128, {}, 16), 128) == "");
        CHECK(note_on(extents_over_maps({720, 1280}, 80, {}, 16), 80) ==
              "The network renders 144 x 80, of which the frames' 142 x 80 are kept.");
        CHECK(note_on(extents_over_maps({720, 1280}, 64, {}, 16), 64) ==
              "Frames are 116 x 65, the nearest to a height of 64 with whole pixels of the maps (11) under each of "
              "theirs. The network renders 128 x 80, of which the frames' 116 x 65 are kept.");
    }

    TEST_CASE("sizes that the maps do not have are refused by name") {
        CHECK_THROWS_WITH_AS(extents_over_maps({720, 1280}, 721, {}, 16),
                             "--size: height is 721, expected at most the maps', which are 1280 x 720", value_error);
        CHECK_THROWS_WITH_AS(extents_over_maps({720, 1280}, 80, 144, 16),
                             "--width: width is 144, expected 142, as the maps have it at this height", value_error);
        CHECK_THROWS_AS(extents_over_maps({100, 2}, 10, {}, 16), value_error);
        CHECK(extents_over_maps({720, 1280}, 80, 142, 16).shown.width == 142);
    }
}
