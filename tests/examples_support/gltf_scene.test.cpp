// SPDX-License-Identifier: MIT
// glTF as the standard says: files that a field test got wrong, with Blender's bounds as their truth, and small ones
// with known vertices.
#include <examples/support/assimp_scene.hpp>
#include <examples/support/gltf_scene.hpp>
#include <examples/support/model_times.hpp>

#include "../support/scratch_folder.hpp"
#include "gltf_file.hpp"

#include <genrender/scene/bounds.hpp>
#include <genrender/scene/uv_overlap.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <random>
#include <string>
#include <vector>

TEST_SUITE("examples_support/gltf_scene") {
    using namespace genrender;
    using namespace genrender::examples;
    using genrender::tests::gltf_file;
    using genrender::tests::scratch_folder;

    namespace {

    std::filesystem::path field(std::string const& name) {
        return std::filesystem::path(GENRENDER_TEST_DATA) / "field" / name;
    }

    /// Plays what is played where nothing is asked for.
    void play_by_default(model_scene& scene) { scene.play(choose_takes(scene.takes(), "")); }

    bounds bounds_at(model_scene const& scene, double seconds) {
        std::vector<glm::vec3> points;
        for (auto const& object : scene.objects_at(seconds)) {
            points.insert(points.end(), object.positions.begin(), object.positions.end());
        }
        return bounds_of(points);
    }

    /// Bounds of all meshes at a frame of 24 a second.
    struct bounds_at_frame {
        double frame;
        glm::vec3 lower, upper;
    };

    /// Largest distance of a side from where it should be.
    float distance_of(bounds const& found, glm::vec3 lower, glm::vec3 upper) {
        auto const off = glm::max(glm::abs(found.lower - lower), glm::abs(found.upper - upper));
        return std::max({off.x, off.y, off.z});
    }

    void check_field(std::string const& name, std::vector<bounds_at_frame> const& expected) {
        CAPTURE(name);
        gltf_scene scene(field(name));
        play_by_default(scene);
        auto largest = 0.0f;
        for (auto const& e : expected) {
            CAPTURE(e.frame);
            auto const off = distance_of(bounds_at(scene, e.frame / 24), e.lower, e.upper);
            CHECK(off < 2e-4f); // the truth has four digits
            largest = std::max(largest, off);
        }
        MESSAGE(name, ": sides are off by at most ", largest);
    }

    std::string gltf_refusal(std::filesystem::path const& path) {
        try {
            gltf_scene const scene(path);
        } catch (file_error const& error) {
            return error.what();
        }
        return "no error";
    }

    /// What is said after the path about a file of this text.
    std::string refusal_of(scratch_folder const& folder, std::string const& text,
                           std::string const& name = "model.gltf") {
        auto const path = folder.write(name, text);
        auto const said = gltf_refusal(path);
        return said.rfind(path.string() + ": ", 0) == 0 ? said.substr(path.string().size() + 2) : said;
    }

    /// With the triangle (0, 0, 0), (1, 0, 0), (0, 1, 0) as mesh 0, whose primitive may have more.
    gltf_file one_triangle(std::string const& more_attributes = "", std::string const& more_members = "",
                           gltf_file file = {}) {
        auto const positions = file.add("VEC3", {0, 0, 0, 1, 0, 0, 0, 1, 0});
        file.meshes = R"({"primitives": [{"attributes": {"POSITION": )" + positions + more_attributes + "}" +
                      more_members + "}]}";
        file.nodes = file.nodes.empty() ? R"({"mesh": 0})" : file.nodes;
        return file;
    }

    /// One animation of one channel.
    std::string one_channel(std::string const& path, std::string const& times, std::string const& values,
                            std::string const& interpolation) {
        return R"({"samplers": [{"input": )" + times + R"(, "output": )" + values + R"(, "interpolation": ")" +
               interpolation + R"("}], "channels": [{"sampler": 0, "target": {"node": 0, "path": ")" + path +
               R"("}}]})";
    }

    gltf_scene scene_of(scratch_folder const& folder, gltf_file const& file, model_assembly const& assembly = {}) {
        gltf_scene scene(folder.write("scene.gltf", file.text()), assembly);
        play_by_default(scene);
        return scene;
    }

    glm::vec3 place(gltf_scene const& scene, double seconds, std::size_t vertex = 0, std::size_t object = 0) {
        return scene.objects_at(seconds).at(object).positions.at(vertex);
    }

    bool is_near(glm::vec3 a, glm::vec3 b) { return glm::distance(a, b) < 1e-5f; }

    std::string replaced(std::string text, std::string const& from, std::string const& to) {
        auto const at = text.find(from);
        REQUIRE(at != std::string::npos);
        return text.replace(at, from.size(), to);
    }

    std::string bytes_of(std::filesystem::path const& path) {
        std::ifstream stream(path, std::ios::binary);
        return {std::istreambuf_iterator<char>(stream), {}};
    }

    /// A binary file of a text and what follows it.
    std::string binary_file(std::string json, std::string binary) {
        auto const word = [](std::size_t value) {
            std::string bytes;
            for (int i = 0; i < 4; ++i) {
                bytes += static_cast<char>(value >> (8 * i) & 255);
            }
            return bytes;
        };
        json.resize((json.size() + 3) / 4 * 4, ' ');
        binary.resize((binary.size() + 3) / 4 * 4, '\0');
        auto const body = word(json.size()) + "JSON" + json + word(binary.size()) + std::string("BIN\0", 4) + binary;
        return "glTF" + word(2) + word(12 + body.size()) + body;
    }

    /// Corners and UVs of all triangles, in an order that does not depend on how vertices are shared.
    std::vector<std::array<float, 15>> sorted_triangles(posed_object const& object) {
        std::vector<std::array<float, 15>> triangles;
        for (auto const& t : object.surface->triangles) {
            std::array<std::array<float, 5>, 3> corners;
            for (int i = 0; i < 3; ++i) {
                auto const& p = object.positions[t[i]];
                auto const& uv = object.surface->uvs[t[i]];
                corners[static_cast<std::size_t>(i)] = {p.x, p.y, p.z, uv.x, uv.y};
            }
            std::sort(corners.begin(), corners.end());
            auto& triangle = triangles.emplace_back();
            for (std::size_t i = 0; i < 15; ++i) {
                triangle[i] = corners[i / 5][i % 5];
            }
        }
        std::sort(triangles.begin(), triangles.end());
        return triangles;
    }

    } // namespace

    // -- the field's files -------------------------------------------------------------------------------------------

    TEST_CASE("three cubes of one animation each jump together") {
        check_field("threecubes.glb", {{1, {-0.5f, -0.5f, -0.5f}, {4.5f, 0.5f, 0.5f}},
                                       {10.75, {-0.5f, 1.0592f, -0.5f}, {4.5f, 2.0592f, 0.5f}},
                                       {20.5, {-0.5f, 2.4891f, -0.5f}, {4.5f, 3.4891f, 0.5f}},
                                       {40, {-0.5f, -0.5f, -0.5f}, {4.5f, 0.5f, 0.5f}}});
    }

    TEST_CASE("a bone and a mesh may have one name") {
        for (auto const* const name : {"bone_and_mesh_share_name.gltf", "bone_and_mesh_unique_name.gltf"}) {
            check_field(name, {{0, {-1.6263f, -0.2121f, -0.3f}, {0.2121f, 1.6264f, 0.3f}},
                               {12, {-1.7453f, -0.2121f, -0.3f}, {0.2121f, 1.1863f, 0.3f}},
                               {24, {-1.7432f, -0.2121f, -0.3f}, {0.2121f, 0.9505f, 0.3f}},
                               {36, {-1.7453f, -0.2121f, -0.3f}, {0.2121f, 1.1863f, 0.3f}},
                               {48, {-1.6263f, -0.2121f, -0.3f}, {0.2121f, 1.6264f, 0.3f}}});
        }
    }

    TEST_CASE("weights of normalised bytes hold as weights of floats do") {
        for (auto const* const name : {"skin_byteweights.gltf", "skin_ok.gltf"}) {
            check_field(name, {{0, {-0.3f, 0, -0.3f}, {0.3f, 2, 0.3f}},
                               {12, {-0.8122f, 0, -0.3f}, {0.3222f, 1.9947f, 0.3f}},
                               {24, {-1.0407f, 0, -0.3f}, {0.3104f, 1.642f, 0.3f}},
                               {36, {-0.8122f, 0, -0.3f}, {0.3222f, 1.9947f, 0.3f}},
                               {48, {-0.3f, 0, -0.3f}, {0.3f, 2, 0.3f}}});
        }
    }

    TEST_CASE("UVs of normalised bytes are shares of the texture") {
        gltf_scene const scene(field("uv_ubyte.gltf"));
        CHECK(!scene.objects().at(0).has_made_uvs);
        auto const object = scene.objects_at(0).at(0);
        CHECK(count_uv_overlap(*object.surface, 512).overlapping == 0);
        REQUIRE(object.surface->uvs.size() == 24);
        // Each face of the cube has a rectangle of 77 x 115 bytes: three in a row, in two rows
        for (std::size_t i = 0; i < 24; ++i) {
            auto const face = i / 4;
            auto const is_right = i % 4 == 1 || i % 4 == 2;
            auto const u = 4 + 85 * (face % 3) + (is_right ? 77 : 0);
            auto const v = 6 + 128 * (face / 3) + (i % 4 >= 2 ? 115 : 0);
            CHECK(object.surface->uvs[i].x == doctest::Approx(static_cast<double>(u) / 255));
            CHECK(object.surface->uvs[i].y == doctest::Approx(static_cast<double>(v) / 255));
        }
    }

    TEST_CASE("rotations of normalised shorts go round") {
        check_field("rot_short.gltf", {{0, {-1, -1, -1}, {1, 1, 1}},
                                       {12, {-1.366f, -1.366f, -1}, {1.366f, 1.366f, 1}},
                                       {36, {-1, -1, -1}, {1, 1, 1}},
                                       {48, {-1.366f, -1.366f, -1}, {1.366f, 1.366f, 1}}});
    }

    TEST_CASE("positions of normalised bytes are where the quantisation says") {
        check_field("q_ubyte.gltf", {{1, {0, 0, 0}, {2, 2, 2}}});
    }

    TEST_CASE("every instance of EXT_mesh_gpu_instancing is an object") {
        // The file's accessor of translations has three elements: x = 0, 3 and 6
        check_field("instancing.gltf", {{1, {-1, -1, -1}, {7, 1, 1}}});
        gltf_scene const scene(field("instancing.gltf"));
        CHECK(scene.objects().size() == 3);
        auto const objects = scene.objects_at(0);
        for (std::size_t i = 0; i < 3; ++i) {
            CHECK(bounds_of(objects.at(i).positions).centre().x == doctest::Approx(3.0 * static_cast<double>(i)));
            CHECK(objects[i].object == object_index{static_cast<std::uint32_t>(i)});
            CHECK(objects[i].surface == objects[0].surface);
        }
        CHECK(scene.objects()[2].name == "unnamed 3");
    }

    TEST_CASE("an extension that must be known and is not is refused by name") {
        auto const path = field("unknown_required.gltf");
        CHECK(gltf_refusal(path) ==
              path.string() + ": needs the extension XX_future, which is not known here, expected a file without");
    }

    TEST_CASE("an animation that begins late stands still before and plays then") {
        check_field("late.gltf", {{0, {-1, -1, -1}, {1, 1, 1}},
                                  {120, {-1, -1, -1}, {1, 1, 1}},
                                  {126, {0, -1, -1}, {2, 1, 1}},
                                  {132, {1, -1, -1}, {3, 1, 1}},
                                  {138, {2, -1, -1}, {4, 1, 1}},
                                  {144, {3, -1, -1}, {5, 1, 1}}});
        gltf_scene scene(field("late.gltf"));
        CHECK(scene.takes().at(0).begin == 5);
        CHECK(scene.takes().at(0).end == 6);
        auto const times = choose_times(scene, std::array{std::size_t{0}}, {.frames = 2});
        CHECK(times.seconds == std::vector{5.0, 5.5});
    }

    TEST_CASE("one mesh follows the skin of each node that draws it") {
        check_field("skin_sharedmesh.gltf", {{0, {-0.3f, 0, -0.3f}, {3.3f, 2, 0.3f}},
                                             {12, {-0.8122f, 0, -0.3f}, {3.3f, 2, 0.3f}},
                                             {24, {-1.0407f, 0, -0.3f}, {3.3f, 2, 0.3f}},
                                             {36, {-0.8122f, 0, -0.3f}, {3.3f, 2, 0.3f}},
                                             {48, {-0.3f, 0, -0.3f}, {3.3f, 2, 0.3f}}});
        gltf_scene scene(field("skin_sharedmesh.gltf"));
        play_by_default(scene);
        auto const objects = scene.objects_at(1);
        REQUIRE(objects.size() == 2);
        CHECK(distance_of(bounds_of(objects[1].positions), {2.7f, 0, -0.3f}, {3.3f, 2, 0.3f}) < 1e-5f);
    }

    TEST_CASE("STEP jumps where LINEAR glides") {
        check_field("interp_STEP.gltf",
                    {{0, {-1, -4, -1}, {1, 1, 1}}, {48, {-1, -4, -1}, {7, 1, 1}}, {96, {-1, -4, -1}, {1, 1, 1}}});
        gltf_scene step(field("interp_STEP.gltf"));
        gltf_scene linear(field("interp_LINEAR.gltf"));
        play_by_default(step);
        play_by_default(linear);
        for (auto const& [begin, end] : {std::pair{0.1, 0.9}, std::pair{2.1, 2.9}}) { // keys a second apart or more
            CHECK(distance_of(bounds_at(step, begin), bounds_at(step, end).lower, bounds_at(step, end).upper) == 0);
        }
        CHECK(distance_of(bounds_at(linear, 0.1), bounds_at(linear, 0.9).lower, bounds_at(linear, 0.9).upper) > 0.1f);
    }

    TEST_CASE("the weights of a node come before those of its mesh") {
        check_field("morph_nodeweights.gltf", {{1, {-1, -1, -1}, {1, 3, 1}}});
    }

    TEST_CASE("shape keys at rest leave a sphere alone") {
        check_field("shapekeys_rest.glb", {{1, {-1, -1, -1}, {1, 1, 1}}});
    }

    // -- what the standard says, on small files ------------------------------------------------------------------------

    TEST_CASE("a spline follows its tangents and passes its keys") {
        scratch_folder const folder;
        gltf_file file = one_triangle();
        auto const times = file.add("SCALAR", {1, 3});
        // x: 0 to 4 with tangents 1 out and 2 in, a second; the outermost tangents mean nothing
        auto const values = file.add("VEC3", {9, 9, 9, 0, 0, 0, 1, 0, 0, /**/ 2, 0, 0, 4, 0, 0, 9, 9, 9});
        file.animations = one_channel("translation", times, values, "CUBICSPLINE");
        auto const scene = scene_of(folder, file);
        CHECK(is_near(place(scene, 0), {0, 0, 0}));
        CHECK(is_near(place(scene, 1), {0, 0, 0}));
        // Hermite at s = 1/2: (a + b) / 2 + (out - in) * 2 s / 8
        CHECK(is_near(place(scene, 2), {2 - 2.0f / 8, 0, 0}));
        CHECK(is_near(place(scene, 3), {4, 0, 0}));
        CHECK(is_near(place(scene, 9), {4, 0, 0}));
        auto const speed = (place(scene, 1.001).x - place(scene, 1).x) / 0.001f;
        CHECK(speed == doctest::Approx(1).epsilon(0.01));
    }

    TEST_CASE("a spline of rotations keeps lengths and one of weights and of scales is a spline too") {
        scratch_folder const folder;
        auto const half = std::sqrt(0.5f);
        gltf_file turning = one_triangle();
        auto times = turning.add("SCALAR", {0, 1});
        auto const turns =
            turning.add("VEC4", {0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, half, half, 0, 0, 0, 0});
        turning.animations = one_channel("rotation", times, turns, "CUBICSPLINE");
        auto const turned = scene_of(folder, turning);
        CHECK(glm::length(place(turned, 0.3, 1)) == doctest::Approx(1));
        // Half way the mean of both, made a unit: 45 degrees
        CHECK(is_near(place(turned, 0.5, 1), {half, half, 0}));

        gltf_file growing = one_triangle();
        times = growing.add("SCALAR", {0, 1});
        auto const sizes = growing.add("VEC3", {0, 0, 0, 1, 1, 1, 0, 0, 0, 0, 0, 0, 3, 1, 1, 0, 0, 0});
        growing.animations = one_channel("scale", times, sizes, "CUBICSPLINE");
        CHECK(place(scene_of(folder, growing), 0.25, 1).x == doctest::Approx(1 + 2 * (3 * 0.0625 - 2 * 0.015625)));

        gltf_file morphing;
        auto const up = morphing.add("VEC3", {0, 0, 0, 0, 2, 0, 0, 0, 0});
        auto const forth = morphing.add("VEC3", {0, 0, 0, 0, 0, 2, 0, 0, 0});
        times = morphing.add("SCALAR", {0, 1});
        auto const weights = morphing.add("SCALAR", {0, 0, 0, 0, 0, 0, /**/ 0, 0, 1, 0.5f, 0, 0});
        morphing =
            one_triangle("", R"(, "targets": [{"POSITION": )" + up + R"(}, {"POSITION": )" + forth + "}]", morphing);
        morphing.animations = one_channel("weights", times, weights, "CUBICSPLINE");
        auto const morphed = scene_of(folder, morphing);
        CHECK(is_near(place(morphed, 0.5, 1), {1, 1, 0.5f}));
        CHECK(is_near(place(morphed, 1, 1), {1, 2, 1}));
    }

    TEST_CASE("sparse accessors replace single elements of others and of zeros") {
        scratch_folder const folder;
        gltf_file file;
        auto const base = file.add("VEC3", {0, 0, 0, 1, 0, 0, 0, 1, 0});
        auto const indices = file.add_integers("SCALAR", {1});
        auto const values = file.add("VEC3", {7, 0, 0});
        auto const sparse = R"("count": 3, "componentType": 5126, "type": "VEC3", "sparse": {"count": 1, "indices":
            {"bufferView": )" +
                            indices + R"(, "componentType": 5123}, "values": {"bufferView": )" + values + "}}}";
        auto const positions = file.add_accessor(R"({"bufferView": )" + base + ", " + sparse);
        auto const target = file.add_accessor("{" + sparse);
        file.nodes = R"({"mesh": 0, "weights": [0.5]})";
        file.meshes = R"({"primitives": [{"attributes": {"POSITION": )" + positions +
                      R"(}, "targets": [{"POSITION": )" + target + "}]}]}";
        auto const scene = scene_of(folder, file);
        CHECK(is_near(place(scene, 0, 0), {0, 0, 0}));
        CHECK(is_near(place(scene, 0, 1), {7 + 3.5f, 0, 0}));
        CHECK(is_near(place(scene, 0, 2), {0, 1, 0}));
    }

    TEST_CASE("strips and fans and lists without indices have their triangles and points have none") {
        scratch_folder const folder;
        auto const triangles = [&](int mode, std::string const& indices) {
            gltf_file file;
            auto const positions = file.add("VEC3", {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 2, 2, 0, 3, 3, 0});
            auto const order = file.add_integers("SCALAR", {0, 1, 2, 2, 3, 4});
            file.nodes = R"({"mesh": 0})";
            file.meshes = R"({"primitives": [{"attributes": {"POSITION": )" + positions + R"(}, "mode": )" +
                          std::to_string(mode) + (indices.empty() ? "" : R"(, "indices": )" + order) + "}]}";
            // Corners of the atlas that is made are the file's, in its order
            auto const object = scene_of(folder, file).objects_at(0).at(0);
            std::vector<std::array<float, 3>> corners; // by x + y, which tells the vertices but 1 and 2 apart
            for (auto const& t : object.surface->triangles) {
                std::array<float, 3> sums{};
                for (int i = 0; i < 3; ++i) {
                    auto const& p = object.positions[t[i]];
                    sums[static_cast<std::size_t>(i)] = p.x + 3 * p.y;
                }
                std::sort(sums.begin(), sums.end());
                corners.push_back(sums);
            }
            return corners;
        };
        using corners = std::vector<std::array<float, 3>>;
        CHECK(triangles(4, "") == corners{{0, 1, 3}, {4, 8, 12}});
        CHECK(triangles(4, "order") == corners{{0, 1, 3}, {3, 4, 8}});
        CHECK(triangles(5, "") == corners{{0, 1, 3}, {1, 3, 4}, {3, 4, 8}, {4, 8, 12}});
        CHECK(triangles(5, "order") == corners{{0, 1, 3}, {3, 4, 8}}); // two that are joined by a vertex named twice
        CHECK(triangles(6, "") == corners{{0, 1, 3}, {0, 3, 4}, {0, 4, 8}, {0, 8, 12}});

        auto points = one_triangle("", R"(, "mode": 0)");
        CHECK(refusal_of(folder, points.text()) == "holds no triangles, expected a mesh at a node");
    }

    TEST_CASE("each primitive of a mesh is an object of its own") {
        scratch_folder const folder;
        gltf_file file;
        auto const left = file.add("VEC3", {0, 0, 0, 1, 0, 0, 0, 1, 0});
        auto const right = file.add("VEC3", {5, 0, 0, 6, 0, 0, 5, 1, 0});
        file.nodes = R"({"mesh": 0, "name": "both"})";
        file.meshes = R"({"primitives": [{"attributes": {"POSITION": )" + left + R"(}}, {"attributes": {"POSITION": )" +
                      right + "}}]}";
        auto const scene = scene_of(folder, file);
        REQUIRE(scene.objects().size() == 2);
        CHECK(scene.objects()[1].name == "both");
        CHECK(is_near(place(scene, 0, 0, 1), {5, 0, 0}));
    }

    TEST_CASE("of more than four joints the four heaviest hold a vertex") {
        scratch_folder const folder;
        gltf_file file;
        auto const first = file.add_integers("VEC4", {0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3});
        auto const second = file.add_integers("VEC4", {4, 9, 9, 9, 4, 9, 9, 9, 4, 9, 9, 9}); // 9 is none, and weighs 0
        auto const light =
            file.add("VEC4", {0.1f, 0.1f, 0.05f, 0.05f, 0.1f, 0.1f, 0.05f, 0.05f, 0.1f, 0.1f, 0.05f, 0.05f});
        auto const heavy = file.add("VEC4", {0.7f, 0, 0, 0, 0.7f, 0, 0, 0, 0.7f, 0, 0, 0});
        file = one_triangle(R"(, "JOINTS_0": )" + first + R"(, "WEIGHTS_0": )" + light + R"(, "JOINTS_1": )" + second +
                                R"(, "WEIGHTS_1": )" + heavy,
                            "", file);
        file.nodes = R"({"children": [1, 2, 3, 4, 5, 6]}, {"mesh": 0, "skin": 0, "translation": [50, 0, 0]}, {}, {}, {},
                        {}, {"translation": [0, 0, 1]})";
        file.skins = R"({"joints": [2, 3, 4, 5, 6]})"; // without inverse binds: the identity
        auto const scene = scene_of(folder, file);
        CHECK(scene.objects()[0].joints == 5);
        CHECK(place(scene, 0).z == doctest::Approx(0.7 / 0.95)); // one of the two lightest is left out
        CHECK(place(scene, 0).x == 0);                           // the node of a skinned mesh does not move it
    }

    TEST_CASE("weights of bytes and shorts and UVs of shorts are shares") {
        scratch_folder const folder;
        for (auto const is_short : {false, true}) {
            gltf_file file;
            auto const joints = file.add_integers("VEC4", {0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0});
            auto const weights =
                is_short ? file.add_normalized<std::uint16_t>(
                               "VEC4", {13107, 52428, 0, 0, 13107, 52428, 0, 0, 13107, 52428, 0, 0})
                         : file.add_normalized<std::uint8_t>("VEC4", {51, 204, 0, 0, 51, 204, 0, 0, 51, 204, 0, 0});
            auto const uvs = file.add_normalized<std::uint16_t>("VEC2", {0, 0, 65535, 0, 0, 13107});
            file = one_triangle(
                R"(, "TEXCOORD_0": )" + uvs + R"(, "JOINTS_0": )" + joints + R"(, "WEIGHTS_0": )" + weights, "", file);
            file.nodes = R"({"children": [1, 2, 3]}, {"mesh": 0, "skin": 0}, {}, {"translation": [0, 0, 10]})";
            file.skins = R"({"joints": [2, 3]})";
            auto const scene = scene_of(folder, file);
            CHECK(place(scene, 0).z == doctest::Approx(8));
            auto const object = scene.objects_at(0).at(0);
            CHECK(object.surface->uvs[1].x == 1);
            CHECK(object.surface->uvs[2].y == doctest::Approx(0.2)); // v runs downwards in both
        }
    }

    TEST_CASE("another set of UVs can be asked for and a missing one makes an atlas") {
        scratch_folder const folder;
        gltf_file file;
        auto const uvs = file.add("VEC2", {0, 0, 1, 0, 0, 1});
        auto const others = file.add("VEC2", {0.5f, 0.5f, 1, 0.5f, 0.5f, 1});
        file = one_triangle(R"(, "TEXCOORD_0": )" + uvs + R"(, "TEXCOORD_1": )" + others, "", file);
        CHECK(scene_of(folder, file, {.uv_set = 1}).objects_at(0)[0].surface->uvs[0].x == 0.5f);
        CHECK(scene_of(folder, file, {.uv_set = 2}).objects()[0].has_made_uvs);
        CHECK(scene_of(folder, file, {.uvs = model_uvs::atlas}).objects()[0].has_made_uvs);
        CHECK(!scene_of(folder, file).objects()[0].has_made_uvs);
    }

    TEST_CASE("matrices and transforms of nodes follow their parents and an animated matrix keeps its other parts") {
        scratch_folder const folder;
        auto file = one_triangle();
        file.nodes = R"({"children": [1], "matrix": [0, 2, 0, 0, -2, 0, 0, 0, 0, 0, 2, 0, 1, 0, 0, 1]},
                        {"mesh": 0, "translation": [3, 0, 0]})";
        CHECK(is_near(place(scene_of(folder, file), 0, 0), {1, 6, 0}));
        CHECK(is_near(place(scene_of(folder, file), 0, 1), {1, 8, 0}));
        auto const times = file.add("SCALAR", {0, 1});
        auto const values = file.add("VEC3", {1, 0, 0, 1, 0, 4});
        file.animations = one_channel("translation", times, values, "LINEAR");
        CHECK(is_near(place(scene_of(folder, file), 0.5, 1), {1, 8, 2}));
    }

    TEST_CASE("takes of one name move nodes by number and play together where they are apart") {
        scratch_folder const folder;
        auto file = one_triangle();
        file.nodes = R"({"children": [1, 2]}, {"mesh": 0, "name": "twin"}, {"mesh": 0, "name": "twin"})";
        auto const times = file.add("SCALAR", {0, 1});
        auto const values = file.add("VEC3", {0, 0, 0, 0, 0, 4});
        auto const first =
            replaced(one_channel("translation", times, values, "LINEAR"), R"("node": 0)", R"("node": 1)");
        auto const second = replaced(one_channel("translation", times, values, "STEP"), R"("node": 0)", R"("node": 2)");
        file.animations = first + ", " + second;
        auto const scene = scene_of(folder, file);
        CHECK(is_near(place(scene, 0.5, 0, 0), {0, 0, 2}));
        CHECK(is_near(place(scene, 0.5, 0, 1), {0, 0, 0}));
        CHECK(is_near(place(scene, 1, 0, 1), {0, 0, 4}));
        CHECK(scene.takes()[0].targets == std::vector<std::string>{"node 1"});
        CHECK(scene.takes()[1].name == "animation 1");
    }

    TEST_CASE("instances have a turn and a size and are placed by their node") {
        scratch_folder const folder;
        auto file = one_triangle();
        auto const half = std::sqrt(0.5f);
        auto const turns = file.add("VEC4", {0, 0, 0, 1, 0, 0, half, half});
        auto const sizes = file.add("VEC3", {1, 1, 1, 3, 3, 3});
        file.nodes = R"({"mesh": 0, "translation": [0, 0, 5], "extensions": {"EXT_mesh_gpu_instancing": {"attributes":
            {"ROTATION": )" +
                     turns + R"(, "SCALE": )" + sizes + "}}}}";
        auto const scene = scene_of(folder, file);
        CHECK(is_near(place(scene, 0, 1, 0), {1, 0, 5}));
        CHECK(is_near(place(scene, 0, 1, 1), {0, 3, 5}));
    }

    TEST_CASE("only the scene that the file shows is drawn and joints may lie outside of it") {
        scratch_folder const folder;
        auto file = one_triangle();
        file.nodes = R"({"mesh": 0, "name": "shown"}, {"mesh": 0, "name": "hidden"})";
        CHECK(scene_of(folder, file).objects().size() == 1);
        auto const text =
            replaced(file.text(), R"("scenes": [{"nodes": [0]}])", R"("scenes": [{"nodes": [1]}, {"nodes": [0]}])");
        gltf_scene const scene(folder.write("two.gltf", replaced(text, R"("scene": 0)", R"("scene": 1)")));
        CHECK(scene.objects().at(0).name == "shown");
        CHECK(scene.notes() == std::vector<std::string>{"The file has 2 scenes; its default one is shown."});
        gltf_scene const first(folder.write("two.gltf", replaced(text, R"("scene": 0, )", "")));
        CHECK(first.objects().at(0).name == "hidden");
    }

    TEST_CASE("cameras have the file's angle and show its width in narrow images, and parallel ones are told apart") {
        scratch_folder const folder;
        auto file = one_triangle();
        file.cameras = R"({"name": "eye", "type": "perspective", "perspective": {"yfov": 0.8, "aspectRatio": 1.5,
            "znear": 0.1}}, {"name": "top", "type": "orthographic", "orthographic": {"xmag": 1, "ymag": 1, "zfar": 9,
            "znear": 0.1}})";
        file.nodes = R"({"mesh": 0, "children": [1, 2]}, {"camera": 0, "translation": [1, 2, 3], "scale": [2, 2, 2],
            "rotation": [0, 0.7071067811865476, 0, 0.7071067811865476]}, {"camera": 1})";
        auto const scene = scene_of(folder, file);
        REQUIRE(scene.lenses().size() == 2);
        CHECK(scene.lenses()[0].name == "eye");
        CHECK(!scene.lenses()[0].is_orthographic);
        CHECK(scene.lenses()[1].is_orthographic);
        auto const eye = scene.eye_at(0, 0, 1.5f, 0.01f);
        CHECK(eye.vertical_fov == doctest::Approx(0.8).epsilon(1e-6));
        CHECK(scene.eye_at(0, 0, 3, 0.01f).vertical_fov == doctest::Approx(0.8).epsilon(1e-6));
        CHECK(std::tan(scene.eye_at(0, 0, 0.75f, 0.01f).vertical_fov / 2) == doctest::Approx(2 * std::tan(0.4)));
        CHECK(is_near(position_of(eye), {1, 2, 3}));
        // A quarter turn around y: it looks along -x
        CHECK(is_near(glm::vec3(eye.view * glm::vec4(-4, 2, 3, 1)), {0, 0, -5}));
    }

    TEST_CASE("buffers come from files of a name with blanks and may be longer than they say") {
        scratch_folder const folder;
        auto const file = one_triangle().text();
        auto const begin = file.find("data:");
        auto const text = file.substr(0, begin) + "a%20+b.bin" + file.substr(file.find('"', begin));
        std::array<float, 10> const floats{0, 0, 0, 2, 0, 0, 0, 1, 0, 99};
        folder.write("a +b.bin", std::string(reinterpret_cast<char const*>(floats.data()), sizeof floats));
        gltf_scene const scene(folder.write("Model.GLTF", text));
        CHECK(is_near(place(scene, 0, 1), {2, 0, 0}));
        CHECK(refusal_of(folder, replaced(text, "a%20+b.bin", "gone.bin")) ==
              "cannot be read as a model (unable to open " + (folder / "gone.bin").string() +
                  "), expected a whole file of glTF 2.0");
        folder.write("a +b.bin", "short");
        CHECK(refusal_of(folder, text) ==
              "cannot be read as a model (a buffer has 5 of its 36 bytes), expected a whole "
              "file of glTF 2.0");

        // The same in a binary file
        auto const json = replaced(text, R"(, "uri": "a%20+b.bin")", "");
        std::string const binary(reinterpret_cast<char const*>(floats.data()), sizeof floats);
        gltf_scene const from_binary(folder.write("model.glb", binary_file(json, binary)));
        CHECK(is_near(place(from_binary, 0, 1), {2, 0, 0}));
    }

    TEST_CASE("extensions of looks are let through and compression is refused by name") {
        scratch_folder const folder;
        auto file = one_triangle();
        file.more = R"(, "extensionsRequired": ["KHR_materials_unlit", "KHR_texture_basisu"])";
        CHECK(scene_of(folder, file).objects().size() == 1);
        for (std::string const name :
             {"KHR_draco_mesh_compression", "EXT_meshopt_compression", "KHR_meshopt_compression"}) {
            file.more = R"(, "extensionsRequired": [")" + name + R"("])";
            CHECK(refusal_of(folder, file.text()) ==
                  "its meshes are compressed by " + name + ", expected a file exported without it");
        }
    }

    TEST_CASE("compressed meshes are refused by name where the file does not call the extension required") {
        scratch_folder const folder;
        auto const whole = one_triangle().text();
        auto const draco = replaced(whole, R"("primitives": [{)",
                                    R"("primitives": [{"extensions": {"KHR_draco_mesh_compression": {}}, )");
        CHECK(refusal_of(folder, draco) == "no error"); // the file has the vertices as well
        CHECK(refusal_of(folder, replaced(draco, R"("bufferView": 0, )", "")) ==
              "its meshes are compressed by KHR_draco_mesh_compression, expected a file exported without it");
        CHECK(refusal_of(folder, replaced(whole, R"("buffers": [)",
                                          R"("buffers": [{"byteLength": 9, "extensions": {"EXT_meshopt_compression":
                                          {"fallback": true}}}, )")) ==
              "its meshes are compressed by EXT_meshopt_compression, expected a file exported without it");
    }

    TEST_CASE("KHR_texture_transform says the range of UVs of integers and leaves those of floats alone") {
        scratch_folder const folder;
        for (auto const is_float : {false, true}) {
            gltf_file file;
            auto const uvs = is_float ? file.add("VEC2", {0, 0, 0.25f, 0, 0, 0.25f})
                                      : file.add_integers("VEC2", {0, 0, 4095, 0, 0, 2048}); // not normalised
            file = one_triangle(R"(, "TEXCOORD_0": )" + uvs, R"(, "material": 0)", file);
            file.more = R"(, "extensionsRequired": ["KHR_texture_transform"], "materials": [{"pbrMetallicRoughness":
                {"baseColorTexture": {"index": 0, "extensions": {"KHR_texture_transform": {"offset": [0.5, 0],
                "scale": [0.0001220703125, 0.000244140625]}}}}}])";
            auto const scene = scene_of(folder, file);
            CHECK(scene.notes() ==
                  std::vector<std::string>{
                      "The file places textures by KHR_texture_transform; UVs of floats stay as they are."});
            auto const object = scene.objects_at(0).at(0);
            CHECK(object.surface->uvs[0].x == (is_float ? 0.0f : 0.5f));
            CHECK(object.surface->uvs[1].x == doctest::Approx(is_float ? 0.25 : 0.5 + 4095.0 / 8192));
            CHECK(object.surface->uvs[2].y == doctest::Approx(is_float ? 0.25 : 0.5));
        }
    }

    TEST_CASE("channels that move something else are said and do not play") {
        scratch_folder const folder;
        auto file = one_triangle();
        auto const times = file.add("SCALAR", {0, 1});
        auto const values = file.add("VEC3", {0, 0, 0, 0, 0, 4});
        file.animations = one_channel("pointer", times, values, "LINEAR");
        auto const scene = scene_of(folder, file);
        CHECK(scene.notes() == std::vector<std::string>{
                                   "1 animation channels move something else than a node or its weights, and do not "
                                   "play."});
        CHECK(is_near(place(scene, 1), {0, 0, 0}));
    }

    // -- files that are not what the format allows -----------------------------------------------------------------------

    TEST_CASE("numbers that are not in the file are refused by where they are named") {
        scratch_folder const folder;
        gltf_file file;
        auto const uvs = file.add("VEC2", {0, 0, 1, 0, 0, 1});
        auto const indices = file.add_integers("SCALAR", {0, 1, 2});
        auto const joints = file.add_integers("VEC4", {0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0});
        auto const weights = file.add("VEC4", {0.5f, 0.5f, 0, 0, 0.5f, 0.5f, 0, 0, 0.5f, 0.5f, 0, 0});
        auto const times = file.add("SCALAR", {0, 1});
        auto const values = file.add("VEC3", {0, 0, 0, 4, 0, 0});
        file = one_triangle(R"(, "TEXCOORD_0": )" + uvs + R"(, "JOINTS_0": )" + joints + R"(, "WEIGHTS_0": )" + weights,
                            R"(, "indices": )" + indices, file);
        file.nodes = R"({"children": [1, 2, 3]}, {"mesh": 0, "skin": 0}, {"camera": 0}, {})";
        file.skins = R"({"joints": [2, 3]})";
        file.cameras = R"({"type": "perspective", "perspective": {"yfov": 0.8, "znear": 0.1}})";
        file.animations = one_channel("translation", times, values, "LINEAR");
        auto const whole = file.text();
        CHECK(refusal_of(folder, whole) == "no error");
        auto const said = [&](std::string const& from, std::string const& to) {
            return refusal_of(folder, replaced(whole, from, to));
        };
        auto const of_mesh = " of primitive 0 of mesh 0";

        CHECK(said(R"("mesh": 0)", R"("mesh": 4)") == "node 1 draws mesh 4, expected one of 1");
        CHECK(said(R"("skin": 0)", R"("skin": 1)") == "node 1 wears skin 1, expected one of 1");
        CHECK(said(R"("camera": 0)", R"("camera": 1)") == "node 2 is camera 1, expected one of 1");
        CHECK(said(R"("joints": [2, 3])", R"("joints": [2, 44])") ==
              "skin 0 has node 44 as a joint, expected one of 4");
        CHECK(said(R"("joints": [2, 3])", R"("joints": [2])") ==
              "JOINTS_0 of primitive 0 of mesh 0 names joint 1 at vertex 0, expected joints below 1");
        CHECK(said(R"("children": [1, 2, 3])", R"("children": [1, 2, 7])") ==
              "a child of node 0 is node 7, expected one of 4");
        CHECK(said(R"("children": [1, 2, 3])", R"("children": [1, 2, 2])") ==
              "node 2 has two parents, expected a tree of nodes");
        CHECK(said(R"({"camera": 0}, {})", R"({"camera": 0, "children": [0]}, {})") ==
              "has nodes among their own ancestors, expected a tree of nodes");
        CHECK(said(R"("nodes": [0])", R"("nodes": [9])") == "a root of the scene is node 9, expected one of 4");
        CHECK(said(R"("scene": 0)", R"("scene": 3)") == "shows scene 3, expected one of 1");
        CHECK(said(R"("sampler": 0)", R"("sampler": 5)") ==
              "the translation of node 0 in animation 0 follows sampler 5, expected one of 1");
        CHECK(said(R"("target": {"node": 0)", R"("target": {"node": 8)") ==
              "the translation of node 8 in animation 0 is of no node of the file, expected one of 4");
        CHECK(
            said(R"("LINEAR")", R"("BEZIER")") ==
            "the translation of node 0 in animation 0 is interpolated by BEZIER, expected LINEAR, STEP or CUBICSPLINE");
        CHECK(said(R"("LINEAR")", R"("CUBICSPLINE")") ==
              "the translation of node 0 in animation 0 has 2 values for 2 keys, expected as many for each");
        CHECK(said(R"("TEXCOORD_0": 0)", R"("TEXCOORD_0": 55)") ==
              "accessor 55, TEXCOORD_0" + std::string(of_mesh) +
                  ", is none of the file's 7, expected numbers that are all in the file");
        CHECK(said(R"("TEXCOORD_0": 0)", R"("TEXCOORD_0": 2)") ==
              "accessor 2, TEXCOORD_0" + std::string(of_mesh) +
                  ", is of another type, expected numbers that are all in the file");
        CHECK(said(R"("indices": 1)", R"("indices": 4)") ==
              "accessor 4, indices" + std::string(of_mesh) +
                  ", is not of unsigned integers, expected numbers that are all in the file");
        CHECK(said(R"("count": 3, "type": "VEC2")", R"("count": 2, "type": "VEC2")") ==
              "TEXCOORD_0 of primitive 0 of mesh 0 is for 2 vertices, expected 3");
        for (std::string const count : {"4", "4000000000", "18446744073709551615"}) {
            CHECK(said(R"("count": 3, "type": "VEC2")", R"("count": )" + count + R"(, "type": "VEC2")") ==
                  "accessor 0, TEXCOORD_0" + std::string(of_mesh) +
                      ", ends beyond its buffer view, expected numbers that are all in the file");
        }
        CHECK(said(R"({"bufferView": 0, "componentType": 5126, "count": 3)",
                   R"({"componentType": 5126, "count": 4000000000)") ==
              "accessor 0, TEXCOORD_0" + std::string(of_mesh) +
                  ", has more elements than the file has bytes, expected numbers that are all in the file");
        CHECK(said(R"("byteOffset": 0, "byteLength": 24)", R"("byteOffset": 0, "byteLength": 24000)") ==
              "accessor 0, TEXCOORD_0" + std::string(of_mesh) +
                  ", lies in a buffer view that ends beyond its buffer, expected numbers that are all in the file");
        CHECK(said(R"({"buffer": 0, "byteOffset": 0,)", R"({"buffer": 6, "byteOffset": 0,)") ==
              "accessor 0, TEXCOORD_0" + std::string(of_mesh) +
                  ", lies in buffer 6, which is none, expected numbers that are all in the file");
        auto broken = one_triangle("", R"(, "indices": 0)", [] {
            gltf_file with_indices;
            with_indices.add_integers("SCALAR", {0, 1, 3});
            return with_indices;
        }());
        CHECK(refusal_of(folder, broken.text()) == "triangle 0 of unnamed is [0, 1, 3], expected vertices below 3");
    }

    TEST_CASE("texts that are not glTF 2.0 are refused with the reason") {
        scratch_folder const folder;
        auto const whole = one_triangle().text();
        auto const reason = [&](std::string const& text, std::string const& name = "model.gltf") {
            auto const said = refusal_of(folder, text, name);
            CHECK(said.rfind("cannot be read as a model (", 0) == 0);
            CHECK(said.find("), expected a whole file of glTF 2.0") != std::string::npos);
            return said.substr(27, said.rfind("), expected") - 27);
        };
        CHECK(reason("").find("parse error") != std::string::npos);
        CHECK(reason("[]").find("type must be object") == std::string::npos); // any reason will do
        CHECK(reason(replaced(whole, R"("2.0")", R"("1.0")")) == "it is of version 1.0");
        CHECK(reason(replaced(whole, R"("version": "2.0")", R"("version": "2.1", "minVersion": "2.1")")) ==
              "it is of version 2.1");
        CHECK(reason(replaced(whole, R"("mesh": 0)", R"("mesh": "0")")) == "mesh is not a whole number of at least 0");
        CHECK(reason(replaced(whole, R"("mesh": 0)", R"("mesh": -1)")) == "mesh is not a whole number of at least 0");
        CHECK(reason(replaced(whole, R"("mesh": 0)", R"("mesh": 0.5)")) == "mesh is not a whole number of at least 0");
        CHECK(reason(replaced(whole, R"("mesh": 0)", R"("mesh": 4294967296)")) ==
              "mesh is not a whole number of at least 0");
        CHECK(reason(replaced(whole, R"("mesh": 0)", R"("mesh": 0, "scale": [1, "1", 1])")) ==
              "scale is not a list of numbers");
        CHECK(reason(replaced(whole, R"("mesh": 0)", R"("mesh": 0, "children": [0.5])")) ==
              "children is not a list of whole numbers of at least 0");
        CHECK(reason(replaced(whole, R"("POSITION": 0)", R"("POSITION": true)")) ==
              "attributes is not a table of whole numbers");
        CHECK(reason(replaced(whole, R"("attributes")", R"("attribute")")) ==
              "primitives is not a list of things with attributes");
        CHECK(reason(replaced(whole, R"("nodes": [{"mesh": 0}])", R"("nodes": {"mesh": 0})")) ==
              "nodes is not a list of things");
        CHECK(reason(replaced(whole, R"("type": "VEC3")", R"("type": 3)")) == "type is not a text");
        std::string deep;
        for (int i = 0; i < 100'000; ++i) {
            deep += "[";
        }
        CHECK(reason(replaced(whole, R"("nodes": [{)", R"("nodes": [{"extensions": {"a": )" + deep)) ==
              "it nests more than 64 levels");

        auto const glb = binary_file(replaced(whole, "data:application/octet-stream;base64,", "data:;base64,"), "1234");
        CHECK(refusal_of(folder, glb, "model.glb") == "no error");
        CHECK(reason(glb.substr(0, 19), "model.glb") == "it is cut off");
        CHECK(reason(glb.substr(0, glb.size() - 1), "model.glb") == "it is cut off");
        auto other = glb;
        other[4] = 1;
        CHECK(reason(other, "model.glb") == "its container is of version 1");
        other = glb;
        other[16] = 'X';
        CHECK(reason(other, "model.glb") == "its first chunk is not JSON");
        other = glb;
        other[15] = 0x7f;
        CHECK(reason(other, "model.glb") == "chunk 0 is cut off");
        CHECK(gltf_refusal(folder.path()).rfind(folder.path().string() + ": cannot be read as a model (", 0) == 0);
    }

    TEST_CASE("a file that claims more than it could hold is refused before it takes the memory") {
        scratch_folder const folder;
        // Each of 3000 primitives reads the same 100,000 vertices
        gltf_file file;
        std::string const zeros(1'200'000, '\0');
        folder.write("zeros.bin", zeros);
        std::string primitives;
        for (int i = 0; i < 3000; ++i) {
            primitives += (i > 0 ? ", " : "") + std::string(R"({"attributes": {"POSITION": 0}, "indices": 1})");
        }
        auto const text = R"({"asset": {"version": "2.0"}, "nodes": [{"mesh": 0}], "meshes": [{"primitives": [)" +
                          primitives + R"(]}], "accessors": [{"bufferView": 0, "componentType": 5126, "count": 100000,
            "type": "VEC3"}, {"bufferView": 0, "componentType": 5125, "count": 3, "type": "SCALAR"}], "bufferViews":
            [{"buffer": 0, "byteLength": 1200000}], "buffers": [{"byteLength": 1200000, "uri": "zeros.bin"}]})";
        CHECK(refusal_of(folder, text) == "holds more than 250000000 numbers, expected a smaller model");
    }

    TEST_CASE("files with any part cut off or any byte changed are refused or give a model but never anything else") {
        scratch_folder const folder;
        std::mt19937_64 random(7);
        auto refused = 0;
        auto read = 0;
        auto const try_file = [&](std::string const& bytes, std::string const& extension) {
            auto const path = folder.write("changed" + extension, bytes);
            try {
                gltf_scene scene(path);
                play_by_default(scene);
                for (auto const& object : scene.objects_at(0.7)) {
                    REQUIRE(object.positions.size() == object.surface->positions.size());
                }
                ++read;
            } catch (file_error const& error) {
                ++refused;
                CHECK(std::string(error.what()).rfind(path.string() + ": ", 0) == 0);
            }
        };
        for (std::string const name : {"skin_sharedmesh.gltf", "morph_nodeweights.gltf", "instancing.gltf",
                                       "rot_short.gltf", "threecubes.glb"}) {
            CAPTURE(name);
            auto const whole = bytes_of(field(name));
            auto const extension = field(name).extension().string();
            for (std::size_t part = 0; part < 16; ++part) {
                try_file(whole.substr(0, whole.size() * part / 16), extension);
            }
            for (int i = 0; i < 150; ++i) {
                auto changed = whole;
                for (std::size_t k = 0; k <= random() % 3; ++k) {
                    auto const at = random() % changed.size();
                    // Half of the changes keep the text a text: a digit for a digit
                    auto const is_digit = changed[at] >= '0' && changed[at] <= '9';
                    changed[at] = is_digit ? static_cast<char>('0' + random() % 10) : static_cast<char>(random() % 256);
                }
                try_file(changed, extension);
            }
            // Every number of the text, by one that cannot be
            for (std::size_t at = 0; at < whole.size(); ++at) {
                auto const is_number = whole[at] >= '0' && whole[at] <= '9' && at > 1 &&
                                       (whole[at - 1] == ' ' || whole[at - 1] == '[' || whole[at - 1] == ':');
                if (is_number && extension == ".gltf") {
                    auto changed = whole;
                    changed.replace(at, 1, at % 2 == 0 ? "-7" : "99999");
                    try_file(changed, extension);
                }
            }
        }
        CHECK(refused > 100);
        CHECK(read > 100);
    }

    // -- against another reader ------------------------------------------------------------------------------------------

    TEST_CASE("models of the test package at rest are where assimp has them") {
        std::filesystem::path const models("/usr/share/assimp/models/glTF2");
        if (!std::filesystem::exists(models)) {
            MESSAGE("assimp-testmodels is not installed: its models are left out");
            return;
        }
        auto compared = 0;
        std::string left_out;
        for (auto const& entry : std::filesystem::recursive_directory_iterator(models)) {
            auto const extension = entry.path().extension();
            if (extension != ".gltf" && extension != ".glb") {
                continue;
            }
            auto const name = entry.path().lexically_relative(models).string();
            CAPTURE(name);
            std::optional<gltf_scene> ours;
            try {
                ours.emplace(entry.path());
            } catch (file_error const& error) {
                std::string const said = error.what();
                CHECK(said.rfind(entry.path().string() + ": ", 0) == 0);
                left_out += "\n  " + said.substr(models.string().size() + 1);
                continue;
            }
            std::optional<assimp_scene> theirs;
            try {
                theirs.emplace(entry.path());
            } catch (file_error const&) {
                left_out += "\n  " + name + ": assimp refuses it, we do not";
                continue;
            }
            auto const a = ours->objects_at(0);
            auto const b = theirs->objects_at(0);
            REQUIRE(a.size() == b.size());
            for (std::size_t i = 0; i < a.size(); ++i) {
                auto const mine = sorted_triangles(a[i]);
                auto const other = sorted_triangles(b[i]);
                REQUIRE(mine.size() == other.size());
                auto largest = 0.0f;
                for (std::size_t k = 0; k < mine.size(); ++k) {
                    for (std::size_t n = 0; n < 15; ++n) {
                        largest = std::max(largest, std::abs(mine[k][n] - other[k][n]));
                    }
                }
                CHECK(largest < 1e-4f * std::max(1.0f, bounds_of(a[i].positions).radius()));
            }
            ++compared;
        }
        MESSAGE(compared, " models compared; refused:", left_out);
        CHECK(compared > 20);
    }
}
