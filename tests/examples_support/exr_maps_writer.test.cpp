// SPDX-License-Identifier: MIT
// EXR files written and read back in both layouts.
#include <examples/support/exr_maps_writer.hpp>

#include "exr_worlds.hpp"
#include "../support/scratch_folder.hpp"

#include <doctest/doctest.h>

using namespace genrender;
using namespace genrender::tests;
using examples::exr_layout;
using examples::exr_write_options;
using examples::load_exr_sequence;
using examples::write_exr_maps;

TEST_SUITE("examples_support/exr_maps_writer") {
    TEST_CASE("what is written in any layout is read back bit by bit") {
        auto const maps = two_frames();
        auto const& uv = maps.first;
        auto const& depth = maps.second;
        for (auto const& options :
             {exr_write_options{.v_upwards = false}, exr_write_options{.layer = "Scene.Hero", .v_upwards = false},
              exr_write_options{.multipart = true, .v_upwards = false},
              exr_write_options{.layer = "", .v_upwards = false},
              exr_write_options{.layout = exr_layout::plain, .v_upwards = false, .first_number = 9999}}) {
            scratch_folder const folder;

            auto const files = write_exr_maps(folder.path() / "made" / "here", uv, depth, options);
            auto const sequence = load_exr_sequence(folder.path() / "made" / "here", {.v_upwards = false});

            CHECK(sequence.files == files);
            CHECK(files[0].filename() == (options.first_number == 1 ? "0001.exr" : "9999.exr"));
            CHECK(sequence.uv.uv == uv.uv);
            CHECK(sequence.uv.object == uv.object);
            CHECK(sequence.uv.coverage == uv.coverage);
            CHECK(sequence.depth.depth == depth.depth);
            CHECK(sequence.depth.coverage == depth.coverage);
            CHECK(sequence.notes.empty());
        }
    }

    TEST_CASE("rest positions are read back bit by bit in every layout") {
        auto const maps = two_frames();
        auto const& e = maps.first.coverage.shape();
        auto position = tensor<float, 4>::from_shape({e[0], e[1], e[2], 3});
        for (std::size_t i = 0; i < position.size(); ++i) {
            auto const is_covered = maps.first.coverage.data()[i / 3] != 0;
            position.data()[i] = is_covered ? static_cast<float>(i) / 7 - 3 : 0;
        }
        for (auto const& options : {exr_write_options{}, exr_write_options{.multipart = true},
                                    exr_write_options{.layout = exr_layout::plain}}) {
            scratch_folder const folder;
            write_exr_maps(folder.path(), maps.first, maps.second, options, position);
            auto const sequence = load_exr_sequence(folder.path());
            CHECK(sequence.position == position);
            CHECK(sequence.notes.empty());
        }
        scratch_folder const folder;
        write_exr_maps(folder.path(), maps.first, maps.second);
        CHECK(load_exr_sequence(folder.path()).position.shape()[0] == 0);
        CHECK_THROWS_AS(write_exr_maps(folder.path(), maps.first, maps.second, {},
                                       tensor<float, 4>::from_shape({1, e[1], e[2], 3})),
                        shape_error);
    }

    TEST_CASE("Blender's own Position pass is taken with a note and not by some files alone") {
        scratch_folder const folder;
        std::vector<examples::detail::exr_output_plane> planes{
            {"", "ViewLayer.UV.U", {0.3f}},    {"", "ViewLayer.UV.V", {0.7f}},   {"", "ViewLayer.UV.A", {1}},
            {"", "ViewLayer.Depth.Z", {3}},    {"", "ViewLayer.IndexOB.X", {2}}, {"", "ViewLayer.Position.X", {5}},
            {"", "ViewLayer.Position.Y", {6}}, {"", "ViewLayer.Position.Z", {7}}};
        examples::detail::write_exr_planes(folder / "1.exr", planes, {1, 1}, false);
        auto const sequence = load_exr_sequence(folder.path());
        CHECK(sequence.position(0, 0, 0, 2) == 7);
        REQUIRE(sequence.notes.size() == 1);
        CHECK(sequence.notes[0].find("Position pass") != std::string::npos);
        planes.resize(5);
        examples::detail::write_exr_planes(folder / "2.exr", planes, {1, 1}, false);
        CHECK_THROWS_WITH_AS(
            load_exr_sequence(folder.path()),
            ((folder / "2.exr").string() + ": has no positions, expected ViewLayer.Position.X as in 1.exr").c_str(),
            file_error);
    }

    TEST_CASE("a multi-part file has a part a pass") {
        auto const maps = two_frames();
        scratch_folder const folder;
        auto const files = write_exr_maps(folder.path(), maps.first, maps.second, {.multipart = true});
        Imf::MultiPartInputFile const file(files[0].c_str());
        CHECK(file.parts() == 3);
        CHECK(file.header(0).name() == "ViewLayer.UV");
        CHECK(file.header(2).channels().findChannel("ViewLayer.Depth.Z") != nullptr);
    }

    TEST_CASE("parts that carry the layer in their name are read as well") {
        scratch_folder const folder;
        examples::detail::write_exr_planes(folder / "1.exr",
                                           {{"ViewLayer.UV", "U", {0.3f}},
                                            {"ViewLayer.UV", "V", {0.7f}},
                                            {"ViewLayer.UV", "A", {1}},
                                            {"ViewLayer.Depth", "Z", {3}},
                                            {"ViewLayer.IndexOB", "X", {2}}},
                                           {1, 1}, true);
        auto const sequence = load_exr_sequence(folder.path());
        CHECK(sequence.uv.uv(0, 0, 0, 0) == 0.3f);
        CHECK(sequence.uv.object(0, 0, 0) == 2);
        CHECK(sequence.depth.depth(0, 0, 0) == 3);
    }

    TEST_CASE("v is written upwards for Blender and downwards in the plain layout") {
        auto maps = two_frames();
        maps.first.uv.fill(0.25f);
        for (auto const layout : {exr_layout::blender, exr_layout::plain}) {
            scratch_folder const folder;
            write_exr_maps(folder.path(), maps.first, maps.second, {.layout = layout});
            auto const file_v = layout == exr_layout::blender ? 0.75f : 0.25f;
            CHECK(load_exr_sequence(folder.path(), {.v_upwards = false}).uv.uv(0, 0, 0, 1) == file_v);
            CHECK(load_exr_sequence(folder.path()).uv.uv(0, 0, 0, 1) == 0.25f);
        }
    }

    TEST_CASE("maps that do not fit each other or a float are refused") {
        auto const maps = two_frames();
        scratch_folder const folder;
        CHECK_THROWS_WITH_AS(write_exr_maps(folder.path(), maps.first, depth_maps(2, {3, 4})),
                             "write_exr_maps: depth.depth is [2, 3, 4], expected [2, 3, 5]", shape_error);
        auto depth = maps.second;
        depth.coverage(0, 0, 0) = 0;
        CHECK_THROWS_WITH_AS(write_exr_maps(folder.path(), maps.first, depth),
                             "write_exr_maps: depth.coverage is 0, expected the coverage of uv", value_error);
        depth = maps.second;
        depth.depth(0, 0, 0) = -1;
        CHECK_THROWS_WITH_AS(write_exr_maps(folder.path(), maps.first, depth),
                             "write_exr_maps: depth.depth is -1.000000, expected above 0 and below 1e10", value_error);
        auto uv = maps.first;
        uv.object(0, 0, 0) = 16777216;
        CHECK_THROWS_WITH_AS(write_exr_maps(folder.path(), uv, maps.second),
                             "write_exr_maps: uv.object is 16777216, expected below 2^24", value_error);
        CHECK(folder.entries() == 0);
    }

    TEST_CASE("a folder that cannot be made is named") {
        auto const maps = two_frames();
        scratch_folder const folder;
        auto const file = folder.write("file", "");
        CHECK_THROWS_WITH_AS(write_exr_maps(file, maps.first, maps.second),
                             (file.string() + ": is no folder and cannot be made one (Not a directory), expected a "
                                              "place that can be written")
                                 .c_str(),
                             file_error);
    }
}
