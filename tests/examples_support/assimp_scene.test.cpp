// SPDX-License-Identifier: MIT
// What assimp's scenes look like in our world, beside what the programs that wrote the files say.
#include <examples/support/assimp_scene.hpp>
#include <examples/support/model_times.hpp>

#include "../support/scratch_folder.hpp"
#include "fbx_tree.hpp"

#include <genrender/scene/bounds.hpp>

#include <doctest/doctest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <optional>
#include <string>
#include <vector>

using namespace genrender;
using namespace genrender::examples;

namespace {

std::filesystem::path field_model(std::string const& name) {
    return std::filesystem::path(GENRENDER_TEST_DATA) / "field" / name;
}

/// An input of another project, which stays beside the repository, in shared/field or where GENRENDER_FIELD says.
std::optional<std::filesystem::path> foreign(std::string const& name) {
    auto const* const told = std::getenv("GENRENDER_FIELD");
    auto const folder = told != nullptr ? std::filesystem::path(told)
                                        : std::filesystem::path(GENRENDER_TEST_DATA) / "../../../shared/field";
    if (!std::filesystem::exists(folder / name)) {
        MESSAGE("there is no ", name, " in ../shared/field or GENRENDER_FIELD: left out");
        return std::nullopt;
    }
    return folder / name;
}

/// All vertices at a frame of the file's, playing what plays by default.
std::vector<glm::vec3> points_at(assimp_scene& scene, double frame) {
    scene.play(choose_takes(scene.takes(), ""));
    std::vector<glm::vec3> points;
    for (auto const& object : scene.objects_at(frame / scene.frames_per_second())) {
        points.insert(points.end(), object.positions.begin(), object.positions.end());
    }
    return points;
}

void check_bounds(std::vector<glm::vec3> const& points, glm::vec3 lower, glm::vec3 upper, float tolerance) {
    auto const box = bounds_of(points);
    CAPTURE(box.lower.x);
    CAPTURE(box.lower.y);
    CAPTURE(box.lower.z);
    CAPTURE(box.upper.x);
    CAPTURE(box.upper.y);
    CAPTURE(box.upper.z);
    for (int axis = 0; axis < 3; ++axis) {
        CHECK(std::abs(box.lower[axis] - lower[axis]) < tolerance);
        CHECK(std::abs(box.upper[axis] - upper[axis]) < tolerance);
    }
}

/// The vertices of an OBJ file, but for those of the group that is called so.
std::vector<glm::vec3> vertices_of(std::filesystem::path const& obj, std::string const& without = "") {
    std::ifstream stream(obj);
    std::vector<glm::vec3> points, group;
    for (std::string word; stream >> word;) {
        if (glm::vec3 p; word == "v" && stream >> p.x >> p.y >> p.z) {
            group.push_back(p);
        } else if (word == "g" && stream >> word) { // stands behind its vertices
            if (word != without) {
                points.insert(points.end(), group.begin(), group.end());
            }
            group.clear();
        }
    }
    return points;
}

/// The largest distance from a point to the nearest of `others`.
float farthest(std::vector<glm::vec3> const& points, std::vector<glm::vec3> const& others) {
    auto largest = 0.0f;
    for (auto const& p : points) {
        auto nearest = std::numeric_limits<float>::max();
        for (auto const& q : others) {
            nearest = std::min(nearest, glm::distance(p, q));
        }
        largest = std::max(largest, nearest);
    }
    return largest;
}

} // namespace

TEST_SUITE("examples_support/assimp_scene") {
    TEST_CASE("joints of an FBX file that are split over helper nodes are where Maya has them") {
        auto const path = foreign("maya_axes_anim_7700_ascii.fbx");
        for (int const frame : {0, 5, 8}) {
            auto const truth_path = foreign("maya_axes_anim_" + std::to_string(frame) + ".obj");
            if (!path || !truth_path) {
                continue;
            }
            assimp_scene scene(*path);
            CHECK(scene.frames_per_second() == doctest::Approx(24));
            auto const box = bounds_of(vertices_of(*truth_path));
            auto const largest = box.upper - box.lower;
            auto const tolerance = 0.003f * std::max({largest.x, largest.y, largest.z});
            check_bounds(points_at(scene, frame), box.lower, box.upper, tolerance);

            // Y is moved by a vertex cache, a file of its own that is not there
            CHECK(scene.notes() == std::vector<std::string>{"The file names a vertex cache, which is not read: what "
                                                            "that moves stands still."});
            auto const truth = vertices_of(*truth_path, "Y");
            REQUIRE(truth.size() == 102);
            std::vector<glm::vec3> points;
            auto const objects = scene.objects_at(frame / 24.0);
            for (std::size_t i = 0; i < objects.size(); ++i) {
                if (scene.objects()[i].name != "Y") {
                    points.insert(points.end(), objects[i].positions.begin(), objects[i].positions.end());
                }
            }
            auto const off = std::max(farthest(truth, points), farthest(points, truth)) / glm::length(largest);
            MESSAGE("frame ", frame, ": vertices are off by ", 100 * off, " % of the model's size");
            CHECK(off < 0.001f);
        }
    }

    TEST_CASE("a sphere with shape keys at rest is a plain sphere") {
        assimp_scene scene(field_model("shapekeys_rest.fbx"));
        CHECK(scene.objects().at(0).morph_targets == 6);
        check_bounds(points_at(scene, 1), glm::vec3(-100), glm::vec3(100), 0.1f); // FBX counts in centimetres
    }

    TEST_CASE("three cubes of a Collada file jump together as Blender has them") {
        assimp_scene scene(field_model("threecubes.dae"));
        CHECK(scene.objects().size() == 3);
        for (auto const& [frame, lower] :
             std::vector<std::pair<double, float>>{{1, -0.5f}, {10.75, 1.0592f}, {20.5, 2.4891f}, {40, -0.5f}}) {
            check_bounds(points_at(scene, frame), {-0.5f, lower, -0.5f}, {4.5f, lower + 1, 0.5f}, 1e-3f);
        }
    }

    TEST_CASE("an FBX file that eases in and out does so here and a step jumps") {
        genrender::tests::scratch_folder const folder;
        constexpr std::int64_t second = 46186158000;
        genrender::tests::fbx_motion motion{{0, second}, {0, 8}, {0x108, 0x108}, {0, 0, 0, 0, 0, 0, 0, 0}};
        auto const x_at = [&](std::string const& file, double seconds) {
            assimp_scene scene(folder.write("motion.FBX", file));
            REQUIRE(scene.takes().size() == 1);
            CHECK(scene.takes()[0].end == doctest::Approx(1));
            return points_at(scene, 24 * seconds).at(0).x;
        };
        for (double const t : {0.0, 0.2, 0.5, 0.7, 1.0}) {
            CHECK(x_at(motion.text(), t) == doctest::Approx(8 * t * t * (3 - 2 * t)).epsilon(1e-3));
            CHECK(x_at(motion.bytes(7500, true), t) == doctest::Approx(8 * t * t * (3 - 2 * t)).epsilon(1e-3));
        }
        motion.flags = {2, 2};
        CHECK(x_at(motion.text(), 0.99) == doctest::Approx(0));
        CHECK(x_at(motion.text(), 1) == doctest::Approx(8));
        motion.values = {3, 3};
        assimp_scene const still(folder.write("motion.fbx", motion.text()));
        CHECK(still.takes().at(0).end == still.takes()[0].begin); // its keys move nothing
    }

    TEST_CASE("an FBX node that is turned before its rotation moves without being moved twice") {
        genrender::tests::scratch_folder const folder;
        constexpr std::int64_t second = 46186158000;
        genrender::tests::fbx_motion motion{{0, second}, {0, 8}, {4, 4}, {0, 0, 0, 0, 0, 0, 0, 0}};
        motion.is_turned = true;
        assimp_scene scene(folder.write("turned.fbx", motion.bytes(7400, true)));
        auto const rest = scene.objects_at(0).at(0).positions;
        CHECK(glm::distance(rest.at(0), {5, 6, 7}) < 1e-4f);
        CHECK(glm::distance(rest.at(1), {5, 7, 7}) < 1e-4f); // a quarter turn takes x to y
        auto const moved = points_at(scene, 12);
        CHECK(glm::distance(moved.at(0), {4, 6, 7}) < 1e-4f);
        CHECK(glm::distance(moved.at(1), {4, 7, 7}) < 1e-4f);
        CHECK(glm::distance(moved.at(2), {3, 6, 7}) < 1e-4f);
    }

    TEST_CASE("each of several takes of an FBX file can play") {
        genrender::tests::scratch_folder const folder;
        constexpr std::int64_t second = 46186158000;
        std::vector<float> const none(8);
        genrender::tests::fbx_motion motion{{0, second}, {0, 8}, {4, 4}, none, "Walk"};
        motion.more = {{{second, 3 * second}, {4, 2}, {4, 4}, none, "Run"},
                       {{0, second}, {0, 0}, {4, 4}, none, "Empty"}};
        assimp_scene scene(folder.write("takes.fbx", motion.text()));
        REQUIRE(scene.takes().size() == 3);
        CHECK(scene.takes()[0].name == "Walk");
        CHECK(scene.takes()[2].end == scene.takes()[2].begin);
        CHECK(choose_takes(scene.takes(), "") ==
              std::vector<std::size_t>{1}); // the longest of those that move something
        auto const x_at = [&](std::string const& take, double seconds) {
            scene.play(choose_takes(scene.takes(), take));
            return scene.objects_at(seconds).at(0).positions.at(0).x;
        };
        CHECK(x_at("Walk", 0.5) == doctest::Approx(4));
        CHECK(x_at("Run", scene.takes()[1].begin) == doctest::Approx(4));
        CHECK(x_at("Run", scene.takes()[1].end) == doctest::Approx(2));
        CHECK(x_at("Empty", 0.5) == doctest::Approx(0));
        CHECK(scene.takes()[1].end - scene.takes()[1].begin == doctest::Approx(2));
    }

    TEST_CASE("FBX files without animation or with straight curves look as assimp has them") {
        std::filesystem::path const models("/usr/share/assimp/models/FBX");
        if (!std::filesystem::exists(models)) {
            MESSAGE("assimp-testmodels is not installed: its FBX files are left out");
            return;
        }
        assimp_scene cubes(models / "cubes_with_mirroring_and_pivot.fbx"); // pivots, as helper nodes at rest
        check_bounds(points_at(cubes, 0), {-0.0607f, -0.1451f, -0.0604f}, {0.1487f, 0.1598f, 0.2673f}, 1e-3f);
        assimp_scene bones(models / "huesitos.fbx");
        CHECK(bones.frames_per_second() == doctest::Approx(25));
        CHECK(bones.takes().at(0).end == doctest::Approx(39 / 25.0));
        check_bounds(points_at(bones, 5), {-239.194f, 0.349f, -440.387f}, {428.910f, 532.268f, -207.330f}, 0.1f);
    }
}
