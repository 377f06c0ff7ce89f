// SPDX-License-Identifier: MIT
// scene.json beside EXR files, and the manifest of Cryptomatte.
#include <examples/support/exr_scene.hpp>

#include "../support/scratch_folder.hpp"

#include <doctest/doctest.h>

#include <glm/geometric.hpp>

using namespace genrender;
using namespace genrender::tests;
using examples::load_exr_scene;
using examples::names_in_manifest;

TEST_SUITE("examples_support/exr_scene") {
    TEST_CASE("frame rate, camera and names of objects are read") {
        scratch_folder const folder;
        CHECK(!load_exr_scene(folder.path()));
        folder.write("scene.json", R"({"frames_per_second": 24, "step": 2, "camera": {"name": "Close", "frames": []},
                                       "objects": {"1": "Column", "12": "Ground"}, "of the future": 1})");
        auto const scene = load_exr_scene(folder.path());
        REQUIRE(scene);
        CHECK(scene->frames_per_second == 12); // every other frame is there
        CHECK(scene->camera == "Close");
        CHECK(scene->objects == std::map<std::uint32_t, std::string>{{1, "Column"}, {12, "Ground"}});
        folder.write("scene.json", "{}");
        CHECK(!load_exr_scene(folder.path())->frames_per_second);
    }

    TEST_CASE("perspective cameras are read by the files' numbers and look through each place of the image") {
        scratch_folder const folder;
        // Turned to look along x with z up; twice as wide as it is high; moved to the right by half the width
        folder.write("scene.json", R"({"camera": {"name": "Eye", "frames": [
            {"frame": 7, "camera_to_world": [[0, 0, -1, 5], [-1, 0, 0, 6], [0, 1, 0, 7], [0, 0, 0, 1]],
             "projection": [[1, 0, 0.5, 0], [0, 2, 0, 0], [0, 0, -1, -0.2], [0, 0, -1, 0]]},
            {"frame": 8, "camera_to_world": [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]],
             "projection": [[1, 0, 0, 0], [0, 2, 0, 0], [0, 0, -1, 0], [0, 0, 0, 1]]},
            {"frame": 9, "camera_to_world": [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]],
             "projection": null}]}})");
        auto const cameras = load_exr_scene(folder.path())->cameras;
        REQUIRE(cameras.size() == 1); // that of frame 8 is orthographic, of frame 9 a panorama
        auto const& camera = cameras.at(7);
        auto const same = [](glm::dvec3 a, glm::dvec3 b) { return glm::length(a - b) < 1e-12; };
        CHECK(same(camera.direction(0.5, 0.25), {1, 0, 0}));
        CHECK(same(camera.direction(0.5, 1), {1, -1.5, 0}));
        CHECK(same(camera.direction(0, 0.25), {1, 0, 0.5}));
    }

    TEST_CASE("a scene.json of another shape is refused with file and key") {
        scratch_folder const folder;
        auto const path = (folder / "scene.json").string();
        auto const refusal = [&](std::string const& text) {
            folder.write("scene.json", text);
            try {
                load_exr_scene(folder.path());
            } catch (file_error const& error) {
                return std::string(error.what());
            }
            return std::string("no error");
        };
        CHECK(refusal("[]") == path + ": the file is [], expected an object");
        CHECK(refusal("{").find(path + ": the file is not JSON (") == 0);
        CHECK(refusal(R"({"frames_per_second": 0})") == path + ": frames_per_second is 0, expected a number above 0");
        CHECK(refusal(R"({"frames_per_second": 24, "step": -1})") == path + ": step is -1, expected a number above 0");
        CHECK(refusal(R"({"camera": 3})") == path + ": camera is 3, expected an object with a name");
        CHECK(refusal(R"({"camera": {"name": "Eye", "frames": [{"frame": 1}]}})") ==
              path + R"(: camera.frames is {"frame":1}, expected entries with frame, camera_to_world and projection)");
        CHECK(refusal(R"({"camera": {"name": "Eye", "frames":
                       [{"frame": 1, "camera_to_world": [[0]], "projection": 2}]}})")
                  .find("expected matrices of 4 rows of 4 numbers") != std::string::npos);
        CHECK(refusal(R"({"objects": {"one": "Cube"}})") ==
              path + R"(: objects is {"one":"Cube"}, expected names by index)");
        CHECK(refusal(R"({"objects": {"1": 2}})") == path + R"(: objects is {"1":2}, expected names by index)");
    }

    TEST_CASE("a manifest names objects by their ids") {
        CHECK(names_in_manifest("", "f.exr").empty());
        CHECK(names_in_manifest(R"({"Cube": "a8fce865", "Sphere": "0000000f"})", "f.exr") ==
              std::map<std::uint32_t, std::string>{{0xa8fce865, "Cube"}, {15, "Sphere"}});
        CHECK_THROWS_WITH_AS(names_in_manifest(R"({"Cube": "red"})", "f.exr"),
                             "f.exr: the manifest of Cryptomatte has for Cube no hexadecimal id, expected names and "
                             "hexadecimal ids",
                             file_error);
        CHECK_THROWS_AS(names_in_manifest(R"([1])", "f.exr"), file_error);
        CHECK_THROWS_AS(names_in_manifest(R"({"Cube": )", "f.exr"), file_error);
    }
}
