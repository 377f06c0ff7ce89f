// SPDX-License-Identifier: MIT
// EXR folders: what is read, and every sentence about what is not.
#include <examples/support/exr_maps.hpp>

#include "exr_worlds.hpp"
#include "../support/scratch_folder.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <bit>
#include <fstream>
#include <limits>

using namespace genrender;
using namespace genrender::tests;
using examples::exr_sequence_options;
using examples::load_exr_sequence;

namespace {

/// What `load_exr_sequence` says about a folder, with the folder's own path left out.
std::string refusal(scratch_folder const& folder, exr_sequence_options const& options = {}) {
    try {
        load_exr_sequence(folder.path(), options);
    } catch (file_error const& error) {
        std::string text = error.what();
        auto const at = text.find(folder.path().string());
        return at == 0 ? text.substr(folder.path().string().size()) : text;
    }
    return "no error";
}

void write_blender(std::filesystem::path const& path, std::vector<exr_test_channel> const& channels) {
    write_exr(path, window(1, 2), window(1, 2), channels);
}

/// A file or folder beside the tests.
std::filesystem::path exr_data(std::string const& name) { return std::filesystem::path(GENRENDER_TEST_DATA) / name; }

/// How many pixels of a frame are covered, by any object or by one.
std::size_t covered_in(examples::exr_sequence const& sequence, std::size_t frame, std::optional<unsigned> object = {}) {
    auto const size = sequence.uv.grid().size();
    std::size_t count = 0;
    for (auto i = frame * size; i < (frame + 1) * size; ++i) {
        count += sequence.uv.coverage.data()[i] != 0 && (!object || sequence.uv.object.data()[i] == *object) ? 1U : 0U;
    }
    return count;
}

} // namespace

TEST_SUITE("examples_support/exr_maps") {
    TEST_CASE("a Blender frame gives UV and object and depth where a surface is and background elsewhere") {
        for (std::string const layer : {"ViewLayer", "RenderLayer", "a layer.with dots"}) {
            scratch_folder const folder;
            write_blender(folder / "0001.exr", blender_frame(layer));

            auto const sequence = load_exr_sequence(folder.path());

            CHECK(sequence.uv.frame_count() == 1);
            CHECK(sequence.uv.grid() == grid_extents{1, 2});
            CHECK(sequence.uv.uv(0, 0, 0, 0) == 0.3f);
            CHECK(sequence.uv.uv(0, 0, 0, 1) == 1 - 0.7f); // Blender's v is 0 at the bottom
            CHECK(sequence.uv.object(0, 0, 0) == 4);
            CHECK(sequence.uv.coverage(0, 0, 0) == 1);
            CHECK(sequence.uv.coverage(0, 0, 1) == 0);
            CHECK(sequence.depth.depth(0, 0, 0) == 2);
            CHECK(sequence.depth.coverage(0, 0, 0) == 1);
            CHECK(sequence.depth.coverage(0, 0, 1) == 0);
            CHECK(sequence.notes.empty());
        }
    }

    TEST_CASE("the layer with all passes is read unless another is named") {
        scratch_folder const folder;
        auto channels = blender_frame("Second");
        channels.push_back({"First.Depth.Z", {9, 9}});
        write_blender(folder / "0001.exr", channels);

        auto const sequence = load_exr_sequence(folder.path());
        CHECK(sequence.depth.depth(0, 0, 0) == 2);
        CHECK(sequence.notes ==
              std::vector<std::string>{"View layers without UV, Z or Object Index passes are left out: First."});
        CHECK(refusal(folder, {.layer = "First"}) ==
              "/0001.exr: has the channels First.Depth.Z, Second.Combined.R, Second.Depth.Z, Second.IndexOB.X, "
              "Second.UV.A, Second.UV.U, Second.UV.V, expected First.UV.U as well (the view layer's UV pass)");
    }

    TEST_CASE("newer spellings of the passes are understood") {
        scratch_folder const folder;
        write_blender(folder / "0001.exr", {{"ViewLayer.UV.U", {0.3f, 0}},
                                            {"ViewLayer.UV.V", {0.7f, 0}},
                                            {"ViewLayer.UV.A", {1, 0}},
                                            {"ViewLayer.Object Index.X", {4, 0}},
                                            {"ViewLayer.Depth.V", {2, 1e10f}}});
        auto const sequence = load_exr_sequence(folder.path());
        CHECK(sequence.uv.object(0, 0, 0) == 4);
        CHECK(sequence.depth.depth(0, 0, 0) == 2);
    }

    TEST_CASE("depth of 1e10 is background whatever alpha says") {
        scratch_folder const folder;
        auto channels = blender_frame();
        channels[2].values = {1, 1};
        write_blender(folder / "0001.exr", channels);
        CHECK(load_exr_sequence(folder.path()).uv.coverage(0, 0, 1) == 0);
    }

    TEST_CASE("in the plain layout a negative id or a depth that is none is background") {
        scratch_folder const folder;
        auto const infinity = std::numeric_limits<float>::infinity();
        write_exr(folder / "0.exr", window(2, 4), window(2, 4),
                  {{"u", {0.1f, 0, 0, 0, 0, 0, 0, 0.2f}},
                   {"v", {0.9f, 0, 0, 0, 0, 0, 0, 0.4f}},
                   {"id", {0, -1, 2, 2, 2, 2, 2, 7}, Imf::HALF},
                   {"depth", {5, 5, 0, -1, 1e10f, infinity, -infinity, 6}}});
        auto const sequence = load_exr_sequence(folder.path());
        std::vector<int> const coverage(sequence.uv.coverage.begin(), sequence.uv.coverage.end());
        CHECK(coverage == std::vector<int>{1, 0, 0, 0, 0, 0, 0, 1});
        CHECK(sequence.uv.object(0, 1, 3) == 7);
        CHECK(sequence.depth.depth(0, 1, 3) == 6);
        CHECK(sequence.notes.empty());
    }

    TEST_CASE("object indices may be integers") {
        scratch_folder const folder;
        auto channels = blender_frame();
        channels[3].type = Imf::UINT;
        write_blender(folder / "0001.exr", channels);
        CHECK(load_exr_sequence(folder.path()).uv.object(0, 0, 0) == 4);
    }

    TEST_CASE("a file's v may be said to run downwards already") {
        scratch_folder const folder;
        write_blender(folder / "0001.exr", blender_frame());
        CHECK(load_exr_sequence(folder.path(), {.v_upwards = false}).uv.uv(0, 0, 0, 1) == 0.7f);
    }

    TEST_CASE("coordinates beyond the texture are kept or wrapped as asked and noted") {
        scratch_folder const folder;
        auto channels = blender_frame();
        channels[0].values[0] = 2.25f;
        write_blender(folder / "0001.exr", channels);
        CHECK(load_exr_sequence(folder.path()).uv.uv(0, 0, 0, 0) == 2.25f);
        auto const wrapped = load_exr_sequence(folder.path(), {.outside = uv_outside::wrap});
        CHECK(wrapped.uv.uv(0, 0, 0, 0) == 0.25f);
        CHECK(wrapped.notes == std::vector<std::string>{"1 of 1 covered pixels have u or v outside [0, 1]."});
    }

    TEST_CASE("frames come in the order of their numbers") {
        scratch_folder const folder;
        for (std::string const name : {"frame_10.exr", "frame_9.EXR", "frame_0008.exr", "take2.exr"}) {
            write_blender(folder / name, blender_frame());
        }
        folder.write("notes.txt", "not a frame");
        std::vector<std::string> names;
        for (auto const& file : load_exr_sequence(folder.path()).files) {
            names.push_back(file.filename().string());
        }
        CHECK(names == std::vector<std::string>{"frame_0008.exr", "frame_9.EXR", "frame_10.exr", "take2.exr"});
    }

    TEST_CASE("tiled files are read like scanline files") {
        scratch_folder const folder;
        write_exr(folder / "0.exr", window(3, 3), window(3, 3),
                  {{"u", {0, .1f, .2f, .3f, .4f, .5f, .6f, .7f, .8f}},
                   {"v", {0, 0, 0, 0, 0, 0, 0, 0, 0}},
                   {"id", {1, 1, 1, 1, 1, 1, 1, 1, 1}},
                   {"depth", {1, 2, 3, 4, 5, 6, 7, 8, 9}}},
                  true);
        auto const sequence = load_exr_sequence(folder.path());
        CHECK(sequence.uv.uv(0, 2, 1, 0) == .7f);
        CHECK(sequence.depth.depth(0, 1, 2) == 6);
    }

    TEST_CASE("pixels outside the data window are background and pixels outside the display window are left out") {
        scratch_folder const folder;
        // Display rows 10..11, columns 20..22; data rows 11..12, columns 21..23
        write_exr(folder / "0.exr", window(2, 3, 10, 20), window(2, 3, 11, 21),
                  {{"u", {.1f, .2f, .3f, .4f, .5f, .6f}},
                   {"v", {0, 0, 0, 0, 0, 0}},
                   {"id", {0, 0, 0, 0, 0, 0}},
                   {"depth", {1, 2, 3, 4, 5, 6}}});
        auto const sequence = load_exr_sequence(folder.path());
        CHECK(sequence.uv.grid() == grid_extents{2, 3});
        std::vector<int> const coverage(sequence.uv.coverage.begin(), sequence.uv.coverage.end());
        CHECK(coverage == std::vector<int>{0, 0, 0, 0, 1, 1});
        CHECK(sequence.uv.uv(0, 1, 1, 0) == .1f);
        CHECK(sequence.depth.depth(0, 1, 2) == 2);
    }

    TEST_CASE("a data window beside the display window shows nothing") {
        scratch_folder const folder;
        write_exr(folder / "0.exr", window(2, 2), window(1, 1, 5, 5),
                  {{"u", {0}}, {"v", {0}}, {"id", {0}}, {"depth", {1}}});
        auto const sequence = load_exr_sequence(folder.path());
        CHECK(sequence.notes == std::vector<std::string>{"No frame shows a surface."});
    }

    TEST_CASE("16-bit coordinates and mixed pixels and coordinates beyond the texture are noted") {
        scratch_folder const folder;
        auto channels = blender_frame();
        channels[0].type = Imf::HALF;
        channels[1].values[0] = 0.6f;
        channels[2].values[0] = 0.5f;
        channels[3].values[0] = 0;
        write_blender(folder / "0001.exr", channels);
        auto const sequence = load_exr_sequence(folder.path());
        CHECK(sequence.uv.uv(0, 0, 0, 0) == doctest::Approx(0.6).epsilon(1e-3)); // the sum of half the samples
        CHECK(sequence.notes ==
              std::vector<std::string>{
                  "UV or depth are 16-bit floats (11 bits of precision): render with Float (Full).",
                  "1 of 1 covered pixels mix several surfaces: render one sample, pixel filter width 0.01.",
                  "1 of 1 covered pixels have u or v outside [0, 1].",
                  "Every object has index 0 and so shares one texture: give each its own Pass Index."});
    }

    TEST_CASE("a folder without EXR files is refused with what it holds") {
        scratch_folder const folder;
        CHECK(refusal(folder) == ": holds no EXR file, expected one a frame");
        folder.write("uv_0001.PNG", "");
        CHECK(refusal(folder) == ": holds 8-bit pictures (uv_0001.PNG) and no EXR file, expected 32-bit float EXR (256 "
                                 "levels of u and v cannot address a texture)");
        CHECK_THROWS_WITH_AS(load_exr_sequence(folder / "missing"),
                             ((folder / "missing").string() +
                              ": cannot be read (No such file or directory), expected a folder of EXR files")
                                 .c_str(),
                             file_error);
        CHECK_THROWS_WITH_AS(
            load_exr_sequence(folder / "uv_0001.PNG"),
            ((folder / "uv_0001.PNG").string() + ": cannot be read (Not a directory), expected a folder of EXR files")
                .c_str(),
            file_error);
    }

    TEST_CASE("8-bit coordinates are refused in every dress") {
        scratch_folder const integers;
        auto channels = blender_frame();
        channels[0].type = Imf::UINT;
        write_blender(integers / "0001.exr", channels);
        CHECK(refusal(integers) ==
              "/0001.exr: channel ViewLayer.UV.U holds integers, expected 32-bit floats (quantised "
              "coordinates cannot address a texture)");

        scratch_folder const converted;
        std::vector<float> levels(32);
        for (std::size_t i = 0; i < levels.size(); ++i) {
            levels[i] = static_cast<float>(7 * i) / 255;
        }
        std::vector<float> const ones(32, 1);
        write_exr(converted / "0.exr", window(4, 8), window(4, 8),
                  {{"u", levels}, {"v", levels}, {"id", ones}, {"depth", ones}});
        CHECK(refusal(converted) ==
              ": every u and v is a multiple of 1/255, expected UV that never passed through an 8-bit "
              "picture (256 levels cannot address a texture)");
    }

    TEST_CASE("a missing pass is named with the channels that are there") {
        scratch_folder const folder;
        write_blender(folder / "0001.exr", {{"R", {0, 0}}, {"Z", {0, 0}}});
        CHECK(refusal(folder) == "/0001.exr: has the channels R, Z, expected Blender's UV, Z and Object Index passes "
                                 "(LAYER.UV.U, LAYER.UV.V, LAYER.Depth.Z, LAYER.IndexOB.X) or u, v, id, depth");

        auto channels = blender_frame();
        channels.erase(channels.begin() + 3);
        write_blender(folder / "0001.exr", channels);
        CHECK(refusal(folder) ==
              "/0001.exr: has the channels ViewLayer.Combined.R, ViewLayer.Depth.Z, ViewLayer.UV.A, "
              "ViewLayer.UV.U, ViewLayer.UV.V, expected ViewLayer.IndexOB.X as well (the view layer's "
              "Object Index pass)");

        write_blender(folder / "0001.exr", {{"u", {0, 0}}, {"v", {0, 0}}, {"id", {0, 0}}});
        CHECK(refusal(folder) == "/0001.exr: has the channels id, u, v, expected depth as well");
    }

    TEST_CASE("frames of another size or another layout than the first are refused") {
        scratch_folder const folder;
        write_blender(folder / "0001.exr", blender_frame());
        write_exr(folder / "0002.exr", window(2, 2), window(1, 2), blender_frame());
        CHECK(refusal(folder) == "/0002.exr: is [2, 2], expected [1, 2] as in 0001.exr");
        write_blender(folder / "0002.exr", {{"u", {0, 0}}, {"v", {0, 0}}, {"id", {0, 0}}, {"depth", {0, 0}}});
        CHECK(refusal(folder) == "/0002.exr: has other channel names (u), expected ViewLayer.UV.U as in 0001.exr");
    }

    TEST_CASE("broken and foreign files are refused by name") {
        scratch_folder const folder;
        folder.write("0001.exr", "this is no EXR file at all");
        auto const foreign = refusal(folder);
        CHECK(foreign.rfind("/0001.exr: cannot be read as EXR (", 0) == 0);
        CHECK(foreign.find("), expected a whole OpenEXR file") != std::string::npos);

        // Every truncation is an error or gives the whole picture, never a crash or a half-read frame
        std::vector<float> const values(15, 0.25f);
        write_exr(folder / "0001.exr", window(3, 5), window(3, 5),
                  {{"u", values}, {"v", values}, {"id", values}, {"depth", values}});
        std::ifstream stream(folder / "0001.exr", std::ios::binary);
        std::string const whole{std::istreambuf_iterator<char>(stream), {}};
        for (std::size_t size = 0; size < whole.size(); size += 7) {
            folder.write("0001.exr", whole.substr(0, size));
            CHECK(refusal(folder).find("/0001.exr: ") == 0);
        }
    }

    TEST_CASE("impossible values of covered pixels are refused with their place") {
        scratch_folder const folder;
        auto channels = blender_frame();
        channels[1].values[0] = std::numeric_limits<float>::quiet_NaN();
        write_blender(folder / "0001.exr", channels);
        CHECK(refusal(folder) ==
              "/0001.exr: at row 0, column 0 the UV is not a finite number, expected texture coordinates "
              "where a surface is covered");
        channels = blender_frame();
        channels[3].values[0] = -2;
        write_blender(folder / "0001.exr", channels);
        CHECK(refusal(folder) == "/0001.exr: at row 0, column 0 the object index is -2.000000, expected 0 to 2^24 - 1");
    }

    TEST_CASE("a covered pixel whose depth is not a number is refused with its place, background may have any") {
        auto const nan = std::numeric_limits<float>::quiet_NaN();
        scratch_folder const folder;
        auto channels = blender_frame();
        channels[4].values = {nan, nan};
        write_blender(folder / "0001.exr", channels);
        CHECK(refusal(folder) ==
              "/0001.exr: at row 0, column 0 the depth is not a number, expected how far the surface "
              "is, or 1e10 for background");
        channels[4].values = {2, nan}; // where alpha is 0
        write_blender(folder / "0001.exr", channels);
        CHECK(load_exr_sequence(folder.path()).uv.coverage(0, 0, 1) == 0);

        write_blender(folder / "0001.exr", {{"u", {0, 0}}, {"v", {0, 0}}, {"id", {-1, 0}}, {"depth", {nan, nan}}});
        CHECK(refusal(folder).rfind("/0001.exr: at row 0, column 1 the depth is not a number, ", 0) == 0);
    }

    TEST_CASE("a surface without depth in a foreign sequence is refused with its place") {
        CHECK_THROWS_WITH_AS(load_exr_sequence(exr_data("field/nandepth")),
                             (exr_data("field/nandepth/f0000.exr").string() +
                              ": at row 27, column 43 the depth is not a number, expected how far the surface is, or "
                              "1e10 for background")
                                 .c_str(),
                             file_error);
    }

    TEST_CASE("a sequence that begins with empty frames is read") {
        auto const sequence = load_exr_sequence(exr_data("field/bgfirst"));
        CHECK(sequence.uv.frame_count() == 4);
        CHECK(covered_in(sequence, 0) == 0);
        CHECK(covered_in(sequence, 1) == 0);
        CHECK(covered_in(sequence, 2) > 4000);
        CHECK(covered_in(sequence, 3) > 4000);
        CHECK(sequence.notes.empty());
    }

    TEST_CASE("the compositor's File Output node is read, with UV.Z as coverage") {
        auto const sequence = load_exr_sequence(exr_data("field/bl_fileout"));
        CHECK(sequence.uv.grid() == grid_extents{96, 128});
        CHECK(covered_in(sequence, 0, 1) == 1485); // the same shot as the layer Character of bl_viewlayers
        CHECK(covered_in(sequence, 0) == 1485);
        CHECK(sequence.notes.empty());
        auto const layer = load_exr_sequence(exr_data("field/bl_viewlayers"), {.layer = "Character"});
        CHECK(std::equal(sequence.uv.uv.begin(), sequence.uv.uv.end(), layer.uv.uv.begin()));
        CHECK(std::equal(sequence.depth.depth.begin(), sequence.depth.depth.end(), layer.depth.depth.begin()));
    }

    TEST_CASE("a third coordinate that nobody filled is no coverage") {
        scratch_folder const folder;
        write_blender(folder / "0001.exr", {{"UV.X", {0.3f, 0.4f}},
                                            {"UV.Y", {0.7f, 0.6f}},
                                            {"UV.Z", {0, 0}},
                                            {"IndexOB.V", {4, 5}},
                                            {"Depth.V", {2, 1e10f}}});
        auto const sequence = load_exr_sequence(folder.path());
        CHECK(sequence.uv.uv(0, 0, 0, 0) == 0.3f);
        CHECK(covered_in(sequence, 0) == 1);
    }

    TEST_CASE("view layers are shown together by depth, or the one that is named") {
        auto const folder = exr_data("field/bl_viewlayers");
        auto const both = load_exr_sequence(folder);
        CHECK(both.notes == std::vector<std::string>{
                                "View layers Background and Character are shown together, the nearest surface of "
                                "each pixel: --view-layer NAME shows one."});
        auto const near = load_exr_sequence(folder, {.layer = "Character"});
        auto const far = load_exr_sequence(folder, {.layer = "Background"});
        CHECK(near.notes.empty());
        CHECK(covered_in(near, 0, 1) == covered_in(near, 0));
        CHECK(covered_in(far, 0, 2) == covered_in(far, 0));
        std::size_t wrong = 0;
        for (std::size_t i = 0; i < both.uv.coverage.size(); ++i) {
            auto const depth_of = [&](auto const& s) { // background is far
                return s.uv.coverage.data()[i] != 0 ? s.depth.depth.data()[i] : 1e10f;
            };
            auto const& nearest = depth_of(near) < depth_of(far) ? near : far;
            wrong += depth_of(both) != depth_of(nearest) || both.uv.uv.data()[2 * i] != nearest.uv.uv.data()[2 * i] ||
                     both.uv.object.data()[i] != nearest.uv.object.data()[i];
        }
        CHECK(wrong == 0);
        CHECK(covered_in(both, 0, 1) > 0);
        CHECK(covered_in(both, 0, 2) > covered_in(both, 0, 1));
        CHECK_THROWS_WITH_AS(load_exr_sequence(folder, {.layer = "Sky"}),
                             ((folder / "f0001.exr").string() +
                              ": has passes of the view layers Background, Character, expected those of Sky")
                                 .c_str(),
                             file_error);
    }

    TEST_CASE("frames of other view layers than the first are refused") {
        scratch_folder const folder;
        auto both = blender_frame("A");
        for (auto const& channel : blender_frame("B")) {
            both.push_back(channel);
        }
        write_blender(folder / "0001.exr", both);
        write_blender(folder / "0002.exr", blender_frame("A"));
        CHECK(refusal(folder) == "/0002.exr: has other channel names (A.UV.U), expected B.UV.U as in 0001.exr");
        CHECK(load_exr_sequence(folder.path(), {.layer = "A"}).uv.frame_count() == 2);
    }

    TEST_CASE("Cryptomatte tells objects apart where no index pass does") {
        auto const sequence = load_exr_sequence(exr_data("blender/cryptomatte"));
        CHECK(covered_in(sequence, 0) == 151);
        CHECK(covered_in(sequence, 0, 0xa8fce865) == 85); // what the manifest calls Cube
        CHECK(covered_in(sequence, 0, 0xe5e9b0db) == 66); // and Sphere
        CHECK(sequence.manifest == R"({"Cube":"a8fce865","Light":"c77d43e5","Sphere":"e5e9b0db","object":"055ec73d"})");
        CHECK(sequence.notes ==
              std::vector<std::string>{"Objects are told apart by Cryptomatte, as there is no Object Index pass."});
    }

    TEST_CASE("of the objects of a Cryptomatte the one with the largest coverage has the pixel") {
        auto const bits = [](std::uint32_t id) { return std::bit_cast<float>(id); };
        auto channels = blender_frame();
        channels[3] = {"ViewLayer.CryptoObject00.r", {bits(0x3f000007), 0}};
        channels.push_back({"ViewLayer.CryptoObject00.g", {0.25f, 0}});
        channels.push_back({"ViewLayer.CryptoObject00.b", {bits(0x40000009), 0}});
        channels.push_back({"ViewLayer.CryptoObject00.a", {0.75f, 0}});
        scratch_folder const folder;
        write_blender(folder / "0001.exr", channels);
        auto const sequence = load_exr_sequence(folder.path());
        CHECK(sequence.uv.object(0, 0, 0) == 0x40000009);
        CHECK(sequence.notes.back() ==
              "1 of 1 covered pixels mix several surfaces: render one sample, pixel filter width 0.01.");
        channels[3].type = Imf::HALF;
        write_blender(folder / "0001.exr", channels);
        CHECK(refusal(folder) == "/0001.exr: channel ViewLayer.CryptoObject00.r does not hold 32-bit floats, expected "
                                 "them (ids of Cryptomatte are their bits)");
    }

    TEST_CASE("files of single passes side by side are one frame") {
        auto const sequence =
            load_exr_sequence(exr_data("blender/side_by_side")); // as Blender's compositor writes them
        CHECK(sequence.uv.frame_count() == 1);
        CHECK(covered_in(sequence, 0) == 108);
        CHECK(covered_in(sequence, 0, 3) == 108);
        CHECK(sequence.files == std::vector<std::filesystem::path>{exr_data("blender/side_by_side/uv_0001.exr")});
        CHECK(sequence.notes.empty());

        scratch_folder const folder;
        auto const write_frame = [&](std::string const& number, float depth) {
            write_blender(folder / ("shot_uv_" + number + ".exr"),
                          {{"R", {0.3f, 0}}, {"G", {0.7f, 0}}, {"B", {1, 0}}, {"A", {1, 1}}});
            write_blender(folder / ("shot_depth." + number + ".exr"), {{"V", {depth, 1e10f}}});
            write_blender(folder / ("shot_object_index_" + number + ".exr"), {{"Y", {4, 0}}});
            write_blender(folder / ("shot_rest_position_" + number + ".exr"),
                          {{"X", {1, 0}}, {"Y", {2, 0}}, {"Z", {3, 0}}});
            write_blender(folder / ("shot_image_" + number + ".exr"), {{"R", {1, 1}}});
        };
        write_frame("0010", 10);
        write_frame("0009", 9);
        auto const named = load_exr_sequence(folder.path());
        CHECK(named.uv.frame_count() == 2);
        CHECK(named.depth.depth(0, 0, 0) == 9);
        CHECK(named.depth.depth(1, 0, 0) == 10);
        CHECK(named.uv.uv(1, 0, 0, 0) == 0.3f);
        CHECK(named.uv.object(1, 0, 0) == 4);
        CHECK(named.position(1, 0, 0, 2) == 3);
        CHECK(named.notes.empty());
        std::filesystem::remove(folder / "shot_depth.0010.exr");
        CHECK(refusal(folder).find("/shot_uv_0010.exr: has the channels ") == 0);
        CHECK(refusal(folder).find(", expected Depth.Z as well (the view layer's Z pass)") != std::string::npos);
        write_exr(folder / "shot_depth_0010.exr", window(2, 2), window(2, 2), {{"V", {1, 1, 1, 1}}});
        CHECK(refusal(folder).find(": is [2, 2], expected [1, 2] as in shot_uv_0010.exr") != std::string::npos);
    }

    TEST_CASE("files of single passes of several layers are composited, their numbers may stand in front") {
        scratch_folder const folder;
        for (std::string const layer : {"near", "far"}) {
            auto const depth = layer == "near" ? 2.0f : 3.0f;
            write_blender(folder / ("0001_" + layer + "_uv.exr"), {{"X", {0.3f, 0.4f}}, {"Y", {0.7f, 0.6f}}});
            write_blender(folder / ("0001_" + layer + "_depth.exr"), {{"V", {depth, layer == "near" ? 1e10f : 5.0f}}});
            write_blender(folder / ("0001_" + layer + "_id.exr"), {{"V", {depth, 3}}});
        }
        auto const both = load_exr_sequence(folder.path());
        CHECK(both.uv.frame_count() == 1);
        CHECK(both.uv.object(0, 0, 0) == 2);
        CHECK(both.uv.object(0, 0, 1) == 3);
        CHECK(load_exr_sequence(folder.path(), {.layer = "far"}).depth.depth(0, 0, 0) == 3);
    }

    TEST_CASE("passes that were written as colours are read, whose alpha is no coverage") {
        scratch_folder const folder;
        write_blender(folder / "0001.exr", {{"uv.R", {0.3f, 0.2f}},
                                            {"uv.G", {0.7f, 0.2f}},
                                            {"uv.B", {1, 0}},
                                            {"uv.A", {1, 1}},
                                            {"depth.R", {2, 3}},
                                            {"index.R", {4, 4}}});
        auto const sequence = load_exr_sequence(folder.path());
        CHECK(covered_in(sequence, 0, 4) == 1);
        CHECK(sequence.uv.uv(0, 0, 0, 0) == 0.3f);
        CHECK(sequence.notes.empty());
    }

    TEST_CASE("files of single passes may lie in folders of the passes' names") {
        scratch_folder const folder;
        for (std::string const pass : {"uv", "depth", "index"}) {
            std::filesystem::create_directory(folder / pass);
        }
        write_blender(folder / "uv" / "0001.exr", {{"X", {0.3f, 0}}, {"Y", {0.7f, 0}}, {"Z", {1, 0}}});
        write_blender(folder / "depth" / "0001.exr", {{"V", {2, 1e10f}}});
        write_blender(folder / "index" / "0001.exr", {{"V", {4, 0}}});
        auto const sequence = load_exr_sequence(folder.path());
        CHECK(covered_in(sequence, 0, 4) == 1);
        CHECK(sequence.depth.depth(0, 0, 0) == 2);
    }

    TEST_CASE("files of frames that are not asked for are not opened") {
        scratch_folder const folder;
        for (int i = 0; i < 60; ++i) {
            folder.write("f" + std::to_string(i) + ".exr", "no EXR file");
        }
        for (int const i : {0, 1, 20, 50}) {
            auto channels = blender_frame();
            channels[4].values[0] = 1.0f + static_cast<float>(i);
            write_blender(folder / ("f" + std::to_string(i) + ".exr"), channels);
        }
        auto const two = load_exr_sequence(folder.path(), {.frames = {.count = 2}});
        CHECK(two.uv.frame_count() == 2);
        CHECK(two.depth.depth(1, 0, 0) == 2);
        auto const apart = load_exr_sequence(folder.path(), {.frames = {.start = 20, .end = 50, .step = 30}});
        CHECK(apart.uv.frame_count() == 2);
        CHECK(apart.depth.depth(0, 0, 0) == 21);
        CHECK(apart.depth.depth(1, 0, 0) == 51);
        CHECK(apart.files.back() == folder / "f50.exr");
        auto const says = [&](examples::exr_frame_range range) {
            try {
                load_exr_sequence(folder.path(), {.frames = range});
            } catch (value_error const& error) {
                return std::string(error.what());
            }
            return std::string("no error");
        };
        CHECK(load_exr_sequence(folder.path(), {.frames = {.end = 1}}).uv.frame_count() == 2);
        CHECK(says({.start = 60}) == "load_exr_sequence: frames.start is 60 to the end, expected numbers of files, of "
                                     "which the last is f59.exr");
        CHECK(says({.count = 0}).find("frames.count") != std::string::npos);
        CHECK(says({.step = 0}).find("frames.step") != std::string::npos);
        write_blender(folder / "zero.exr", blender_frame());
        CHECK(says({.start = 1}) == "load_exr_sequence: frames.start is zero.exr, expected files whose names end with "
                                    "their frame's number");
    }

    TEST_CASE("frames have the numbers at the end of their files' names") {
        auto const number = [](char const* name) { return examples::frame_number({{name, "", ""}}); };
        CHECK(number("maps/shot2_0012.exr") == 12);
        CHECK(number("0012_uv.exr") == 12);
        CHECK(number("0000.exr") == 0);
        CHECK(!number("shot.exr"));
        CHECK(!number("take_12345678901234567890.exr"));
    }

    TEST_CASE("positions that are not asked for are not read") {
        scratch_folder const folder;
        auto channels = blender_frame();
        for (std::string const axis : {"X", "Y", "Z"}) {
            channels.push_back({"ViewLayer.Rest." + axis, {std::numeric_limits<float>::quiet_NaN(), 0}});
        }
        write_blender(folder / "0001.exr", channels);
        CHECK(load_exr_sequence(folder.path(), {.has_position = false}).position.shape()[0] == 0);
        CHECK(refusal(folder).find("the position is not a finite number") != std::string::npos);
    }

    TEST_CASE("subsampled channels and absurd sizes are refused") {
        scratch_folder const folder;
        Imf::Header header(4, 4);
        header.channels().insert("u", Imf::Channel(Imf::FLOAT, 2, 2));
        std::vector<float> const values(16);
        Imf::FrameBuffer buffer;
        buffer.insert("u", Imf::Slice::Make(Imf::FLOAT, values.data(), window(4, 4), 4, 8, 2, 2));
        {
            Imf::OutputFile file((folder / "0001.exr").c_str(), header);
            file.setFrameBuffer(buffer);
            file.writePixels(4);
        }
        CHECK(refusal(folder) == "/0001.exr: channel u is subsampled, expected one value a pixel");
        write_exr(folder / "0001.exr", window(1 << 15, 1 << 15), window(1, 1), {{"u", {0}}});
        CHECK(refusal(folder) == "/0001.exr: is an image of [32768, 32768] pixels, expected 1 to 2^26 of them");
    }
}
