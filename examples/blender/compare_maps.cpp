// SPDX-License-Identifier: MIT
// Maps that Blender rendered beside those that the library's rasteriser draws of the same triangles.
#include <examples/support/exr_maps.hpp>
#include <examples/support/exr_scene.hpp>

#include <genrender/scene/rasterizer.hpp>

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/matrix.hpp>
#include <glm/vec3.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <fstream>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

using namespace genrender;

namespace {

/// The frames that tests/blender/export_meshes.py wrote.
struct exported_scene {
    std::vector<posed_scene> frames;
    grid_extents grid;

    std::size_t frame_count() const { return frames.size(); }
    posed_scene frame(frame_index i) const { return frames[i.value]; }
};

template <class Value>
Value next(std::istream& stream) {
    Value value{};
    if (!(stream >> value)) {
        throw std::runtime_error("the file of meshes ends early or holds no number, expected export_meshes.py's");
    }
    return value;
}

exported_scene load(std::string const& path) {
    std::ifstream stream(path);
    exported_scene scene;
    scene.frames.resize(next<std::size_t>(stream));
    scene.grid.height = next<std::size_t>(stream);
    scene.grid.width = next<std::size_t>(stream);
    for (auto& frame : scene.frames) {
        frame.camera.vertical_fov = next<float>(stream);
        for (int row = 0; row < 4; ++row) {
            for (int column = 0; column < 4; ++column) {
                frame.camera.view[column][row] = next<float>(stream);
            }
        }
        frame.objects.resize(next<std::size_t>(stream));
        for (auto& object : frame.objects) {
            mesh surface;
            object.object = {next<std::uint32_t>(stream)};
            auto const triangles = next<std::uint32_t>(stream);
            for (std::uint32_t t = 0; t < triangles; ++t) {
                surface.triangles.emplace_back(3 * t, 3 * t + 1, 3 * t + 2);
            }
            for (std::uint32_t corner = 0; corner < 3 * triangles; ++corner) {
                auto const vector = [&] {
                    auto const x = next<float>(stream);
                    auto const y = next<float>(stream);
                    return glm::vec3(x, y, next<float>(stream));
                };
                object.positions.push_back(vector());
                auto const u = next<float>(stream);
                surface.uvs.emplace_back(u, 1 - next<float>(stream)); // Blender's v is 0 at the bottom
                surface.positions.push_back(vector());
            }
            object.surface = std::make_shared<mesh const>(std::move(surface));
        }
    }
    return scene;
}

/// Whether the 3 x 3 pixels around a pixel show one object whose UVs go on smoothly, by both maps.
bool is_inside(uv_maps const& maps, std::size_t frame, std::size_t row, std::size_t column) {
    auto const grid = maps.grid();
    if (row == 0 || column == 0 || row + 1 >= grid.height || column + 1 >= grid.width) {
        return false;
    }
    // A sample lies up to 0.005 pixels beside the centre: where UVs are steeper than this, 1e-4 cannot be asked for.
    constexpr float steepest = 0.015f;
    for (auto y = row - 1; y <= row + 1; ++y) {
        for (auto x = column - 1; x <= column + 1; ++x) {
            if (maps.coverage(frame, y, x) == 0 || maps.object(frame, y, x) != maps.object(frame, row, column)) {
                return false;
            }
            for (std::size_t axis = 0; axis < 2; ++axis) {
                if (std::abs(maps.uv(frame, y, x, axis) - maps.uv(frame, row, column, axis)) > steepest) {
                    return false;
                }
            }
        }
    }
    return true;
}

/// The largest and the mean of differences.
struct difference {
    double largest = 0;
    double sum = 0;
    std::size_t count = 0;

    void add(double value) {
        largest = std::max(largest, std::isfinite(value) ? value : 1e30);
        sum += value;
        ++count;
    }
    double mean() const { return count == 0 ? 0 : sum / static_cast<double>(count); }
};

} // namespace

int main(int argc, char** argv) try {
    if (argc != 3) {
        std::fprintf(stderr, "compare_maps MAPS MESHES: a folder of genrender_maps.py, a file of export_meshes.py\n");
        return 2;
    }
    auto const rendered = examples::load_exr_sequence(argv[1]);
    auto const scene = load(argv[2]);
    auto const drawn = rasterize(scene, scene.grid, {}, position_pass::on);
    require_extents("compare_maps", "MAPS", rendered.uv.coverage.shape(), drawn.uv.coverage.shape());
    require_extents("compare_maps", "rest positions in MAPS", rendered.position.shape(), drawn.position.shape());

    auto const told = examples::load_exr_scene(argv[1]).value_or(examples::exr_scene{});
    difference ray;
    for (std::uint32_t f = 0; f < scene.frames.size(); ++f) {
        auto const number = examples::frame_number({{rendered.files[f], "", ""}});
        auto const& camera = told.cameras.at(number.value_or(-1));
        auto const& eye = scene.frames[f].camera;
        image_plane const plane(eye, scene.grid);
        for (double const row : {0.0, 0.3, 1.0}) {
            for (double const column : {0.0, 0.6, 1.0}) {
                glm::dvec3 const seen(plane.x_of(column * static_cast<double>(scene.grid.width)),
                                      plane.y_of(row * static_cast<double>(scene.grid.height)), -1);
                auto const direction = glm::dmat3(glm::inverse(eye.view)) * seen;
                ray.add(glm::length(direction - camera.direction(row, column)));
            }
        }
    }

    difference uv;
    difference depth;
    difference position;
    std::size_t covered = 0;
    std::size_t other_coverage = 0;
    std::size_t other_object = 0;
    std::size_t other_object_inside = 0;
    auto const [frames, height, width] = drawn.uv.coverage.shape();
    for (std::size_t f = 0; f < frames; ++f) {
        for (std::size_t row = 0; row < height; ++row) {
            for (std::size_t column = 0; column < width; ++column) {
                auto const is_covered = drawn.uv.coverage(f, row, column) != 0;
                covered += is_covered;
                other_coverage += is_covered != (rendered.uv.coverage(f, row, column) != 0);
                auto const is_other = drawn.uv.object(f, row, column) != rendered.uv.object(f, row, column);
                other_object += is_covered && is_other;
                if (!is_inside(drawn.uv, f, row, column)) {
                    continue;
                }
                other_object_inside += is_other;
                for (std::size_t axis = 0; axis < 2; ++axis) {
                    uv.add(std::abs(drawn.uv.uv(f, row, column, axis) - rendered.uv.uv(f, row, column, axis)));
                }
                auto const z = drawn.depth.depth(f, row, column);
                depth.add(std::abs(z - rendered.depth.depth(f, row, column)) / z);
                for (std::size_t axis = 0; axis < 3; ++axis) {
                    position.add(
                        std::abs(drawn.position(f, row, column, axis) - rendered.position(f, row, column, axis)));
                }
            }
        }
    }
    auto const share = [&](std::size_t count) {
        return 100 * static_cast<double>(count) / static_cast<double>(std::max<std::size_t>(1, covered));
    };
    std::printf("%zu frames of %zu x %zu pixels, %zu of them covered, %.1f %% away from edges\n", frames, width, height,
                covered, share(depth.count));
    std::printf("away from edges       largest      mean\n");
    std::printf("UV                    %.2e     %.2e\n", uv.largest, uv.mean());
    std::printf("depth, relative       %.2e     %.2e\n", depth.largest, depth.mean());
    std::printf("rest position         %.2e     %.2e\n", position.largest, position.mean());
    std::printf("rays of scene.json    %.2e     %.2e\n", ray.largest, ray.mean());
    std::printf("another object        %zu pixels\n", other_object_inside);
    std::printf("at edges, too: another object at %.3f %% of the covered pixels, other coverage at %.3f %%\n",
                share(other_object), share(other_coverage));
    auto const is_same = uv.largest <= 1e-4 && depth.largest <= 1e-4 && position.largest <= 1e-4 &&
                         ray.largest <= 1e-4 && other_object_inside == 0 && share(other_object) < 1 &&
                         share(other_coverage) < 1 && share(depth.count) > 50;
    std::printf("%s\n", is_same ? "the same: UV within 1e-4" : "NOT the same: expected UV within 1e-4");
    return is_same ? 0 : 1;
} catch (std::exception const& error) {
    std::fprintf(stderr, "compare_maps: %s\n", error.what());
    return 1;
}
