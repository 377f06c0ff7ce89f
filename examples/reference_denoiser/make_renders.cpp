// SPDX-License-Identifier: MIT
// Writes what the reference denoiser is trained on: pictures of invented scenes, their inverse depth and their prompts.
#include "lit_render.hpp"
#include "training_scene.hpp"

#include <examples/support/contact_sheet.hpp>
#include <examples/support/output_file.hpp>
#include <examples/support/pictures.hpp>

#include <genrender/core/error.hpp>
#include <genrender/core/parallel.hpp>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <vector>

using namespace genrender;
using namespace genrender::examples;

namespace {

constexpr grid_extents grid{64, 64};
constexpr std::size_t samples = 3;

/// The examples of one block, in the layout of the files.
struct block {
    std::vector<std::uint8_t> images;         ///< [examples, height, width, 3]
    std::vector<std::uint16_t> inverse_depth; ///< [examples, height, width], 65535 = nearest
    std::vector<std::uint8_t> objects;        ///< [examples, height, width], 255 = patterned objects alone
    std::vector<std::uint8_t> prompts;        ///< [examples, 2], style and colour; 255 = no colour

    explicit block(std::size_t count)
        : images(count * grid.size() * 3), inverse_depth(count * grid.size()), objects(count * grid.size()),
          prompts(count * 2) {}
};

std::uint8_t byte_of(float share) {
    return static_cast<std::uint8_t>(std::lround(std::clamp(share, 0.0f, 1.0f) * 255));
}

void draw_example(block& into, std::size_t place, std::uint64_t seed, std::uint32_t number) {
    auto const drawn = draw_training_scene(seed, number);
    auto const picture = render_lit(drawn.scene, drawn.paint, grid, samples, drawn.target, drawn.shadow_radius);
    for (std::size_t p = 0; p < grid.size(); ++p) {
        auto const row = p / grid.width;
        auto const column = p % grid.width;
        for (std::size_t c = 0; c < 3; ++c) {
            into.images[(place * grid.size() + p) * 3 + c] = byte_of(picture.image(c, row, column));
        }
        into.inverse_depth[place * grid.size() + p] =
            static_cast<std::uint16_t>(std::lround(picture.inverse_depth(0, row, column) * 65535));
        into.objects[place * grid.size() + p] = byte_of(picture.pattern_share(row, column));
    }
    into.prompts[2 * place] = static_cast<std::uint8_t>(drawn.style);
    into.prompts[2 * place + 1] = static_cast<std::uint8_t>(drawn.colour.value_or(255));
}

template <class T>
void write_values(std::ofstream& file, std::vector<T> const& values, std::size_t count) {
    file.write(reinterpret_cast<char const*>(values.data()), static_cast<std::streamsize>(count * sizeof(T)));
}

int run(int argc, char** argv) {
    CLI::App app("Writes pictures of invented scenes with their inverse depth and prompts, to train a denoiser on.");
    std::filesystem::path folder;
    std::size_t count = 60000;
    std::uint64_t seed = 1;
    std::size_t threads = 0;
    app.add_option("--out", folder, "Folder of the files")->required();
    app.add_option("--count", count, "Number of pictures")->capture_default_str();
    app.add_option("--seed", seed, "Another seed, other scenes")->capture_default_str();
    app.add_option("--threads", threads, "Threads; 0 = all of the machine")->capture_default_str();
    CLI11_PARSE(app, argc, argv);

    make_folder(folder);
    auto const open = [&](char const* name) {
        std::ofstream file(folder / name, std::ios::binary);
        if (!file) {
            throw file_error((folder / name).string() +
                             ": cannot be written, expected a folder where files may be made");
        }
        return file;
    };
    auto images = open("images.u8");
    auto inverse_depth = open("inverse_depth.u16");
    auto objects = open("objects.u8");
    auto prompts = open("prompts.u8");
    constexpr std::size_t block_size = 512;
    threaded_loop const loop(threads);
    for (std::size_t first = 0; first < count; first += block_size) {
        auto const size = std::min(block_size, count - first);
        block examples(size);
        loop(size, [&](std::size_t i) { draw_example(examples, i, seed, static_cast<std::uint32_t>(first + i)); });
        write_values(images, examples.images, size * grid.size() * 3);
        write_values(inverse_depth, examples.inverse_depth, size * grid.size());
        write_values(objects, examples.objects, size * grid.size());
        write_values(prompts, examples.prompts, size * 2);
        std::printf("\r%zu of %zu", first + size, count);
        std::fflush(stdout);
        if (first == 0) {
            rgb8_image sheet({8 * 64, 12 * 64}, {0, 0, 0});
            for (std::size_t i = 0; i < std::min<std::size_t>(size, 96); ++i) {
                for (std::size_t p = 0; p < grid.size(); ++p) {
                    auto const* const colour = &examples.images[(i * grid.size() + p) * 3];
                    sheet.set(i / 12 * 64 + p / 64, i % 12 * 64 + p % 64, {colour[0], colour[1], colour[2]});
                }
            }
            write_png(folder / "sheet.png", sheet);
        }
    }
    std::printf("\n");
    nlohmann::json const description{{"count", count},        {"height", grid.height},   {"width", grid.width},
                                     {"styles", style_words}, {"colours", colour_words}, {"seed", seed}};
    open("renders.json") << description.dump(2) << '\n';
    return 0;
}

} // namespace

int main(int argc, char** argv) {
    try {
        return run(argc, argv);
    } catch (std::exception const& failure) {
        std::fprintf(stderr, "make_renders: %s\n", failure.what());
        return 1;
    }
}
