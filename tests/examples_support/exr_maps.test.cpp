// SPDX-License-Identifier: MIT
// EXR folders: what is read, and every sentence about what is not.
#include <examples/support/exr_maps.hpp>

#include "exr_worlds.hpp"
#include "../support/scratch_folder.hpp"

#include <doctest/doctest.h>

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

        CHECK(load_exr_sequence(folder.path()).depth.depth(0, 0, 0) == 2);
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
        auto const nan = std::numeric_limits<float>::quiet_NaN();
        auto const infinity = std::numeric_limits<float>::infinity();
        write_exr(folder / "0.exr", window(2, 4), window(2, 4),
                  {{"u", {0.1f, 0, 0, 0, 0, 0, 0, 0.2f}},
                   {"v", {0.9f, 0, 0, 0, 0, 0, 0, 0.4f}},
                   {"id", {0, -1, 2, 2, 2, 2, 2, 7}, Imf::HALF},
                   {"depth", {5, 5, 0, -1, 1e10f, infinity, nan, 6}}});
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
