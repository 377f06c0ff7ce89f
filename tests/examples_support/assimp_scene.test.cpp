// SPDX-License-Identifier: MIT
// What assimp's scenes look like in our world, beside what the programs that wrote the files say.
#include <examples/support/assimp_scene.hpp>
#include <examples/support/model_times.hpp>

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

std::filesystem::path field(std::string const& name) {
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

/// The vertices of an OBJ file.
std::vector<glm::vec3> vertices_of(std::filesystem::path const& obj) {
    std::ifstream stream(obj);
    std::vector<glm::vec3> points;
    for (std::string word; stream >> word;) {
        if (glm::vec3 p; word == "v" && stream >> p.x >> p.y >> p.z) {
            points.push_back(p);
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
            auto const truth = vertices_of(*truth_path);
            REQUIRE(truth.size() == 128);
            auto const points = points_at(scene, frame);
            auto const box = bounds_of(truth);
            auto const largest = box.upper - box.lower;
            auto const tolerance = 0.003f * std::max({largest.x, largest.y, largest.z});
            check_bounds(points, box.lower, box.upper, tolerance);
            MESSAGE("frame ", frame, ": off by ", 100 * farthest(truth, points) / glm::length(largest), " %");
            CHECK(farthest(truth, points) < tolerance);
            CHECK(farthest(points, truth) < tolerance);
        }
    }

    TEST_CASE("a sphere with shape keys at rest is a plain sphere") {
        assimp_scene scene(field("shapekeys_rest.fbx"));
        CHECK(scene.objects().at(0).morph_targets == 6);
        check_bounds(points_at(scene, 1), glm::vec3(-100), glm::vec3(100), 0.1f); // FBX counts in centimetres
    }

    TEST_CASE("three cubes of a Collada file jump together as Blender has them") {
        assimp_scene scene(field("threecubes.dae"));
        CHECK(scene.objects().size() == 3);
        for (auto const& [frame, lower] :
             std::vector<std::pair<double, float>>{{1, -0.5f}, {10.75, 1.0592f}, {20.5, 2.4891f}, {40, -0.5f}}) {
            check_bounds(points_at(scene, frame), {-0.5f, lower, -0.5f}, {4.5f, lower + 1, 0.5f}, 1e-3f);
        }
    }
}
