// SPDX-License-Identifier: MIT
// Writes what the miniature Stable Diffusion is trained on: pictures of invented scenes, their inverse depth and captions.
#include "lit_picture.hpp"
#include "world_caption.hpp"
#include "world_scene.hpp"

#include <examples/support/contact_sheet.hpp>
#include <examples/support/output_file.hpp>
#include <examples/support/pictures.hpp>

#include <genrender/core/error.hpp>
#include <genrender/core/parallel.hpp>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

using namespace genrender;
using namespace genrender::examples;
using namespace genrender::examples::miniature;

namespace {

constexpr grid_extents grid{128, 128};
constexpr std::size_t samples = 3;
constexpr std::array label_names{"pattern",        "first",         "second",       "material",   "light",
                                 "ground_pattern", "ground_colour", "wall_pattern", "wall_colour"};
constexpr std::uint8_t no_label = 255;

struct picture_request {
    std::uint64_t seed = 1;
    picture_set set = picture_set::training;
    caption_length length = caption_length::varied;
};

/// The examples of one block, in the layout of the files.
struct block {
    std::vector<std::uint8_t> images;         ///< [examples, height, width, 3]
    std::vector<std::uint16_t> inverse_depth; ///< [examples, height, width], 65535 = nearest
    std::vector<std::uint8_t> subjects;       ///< [examples, height, width], 255 = subjects alone
    std::vector<std::uint8_t> labels;         ///< [examples, labels], 255 = there is none
    std::vector<std::string> captions;        ///< one an example

    explicit block(std::size_t count)
        : images(count * grid.size() * 3), inverse_depth(count * grid.size()), subjects(count * grid.size()),
          labels(count * label_names.size()), captions(count) {}
};

std::uint8_t byte_of(float share) {
    return static_cast<std::uint8_t>(std::lround(std::clamp(share, 0.0f, 1.0f) * 255));
}

std::array<std::uint8_t, label_names.size()> labels_of(world_description const& of) {
    auto const number = [](auto value) { return static_cast<std::uint8_t>(value); };
    auto const if_any = [&](bool any, auto value) { return any ? number(value) : no_label; };
    return {number(of.pattern),
            number(of.first),
            if_any(of.pattern != surface_pattern::plain, of.second),
            number(of.material),
            number(of.light),
            if_any(of.has_ground, of.ground.pattern),
            if_any(of.has_ground, of.ground.colour),
            if_any(of.is_room(), of.wall.pattern),
            if_any(of.is_room(), of.wall.colour)};
}

void draw_example(block& into, std::size_t place, picture_request const& request, std::uint32_t number) {
    auto const drawn = draw_world(request.seed, number, request.set);
    auto const picture = draw_lit(drawn.scene, drawn.paint, grid, samples, drawn.target, drawn.shadow_radius);
    for (std::size_t p = 0; p < grid.size(); ++p) {
        auto const row = p / grid.width;
        auto const column = p % grid.width;
        for (std::size_t c = 0; c < 3; ++c) {
            into.images[(place * grid.size() + p) * 3 + c] = byte_of(picture.image(c, row, column));
        }
        into.inverse_depth[place * grid.size() + p] =
            static_cast<std::uint16_t>(std::lround(picture.inverse_depth(0, row, column) * 65535));
        into.subjects[place * grid.size() + p] = byte_of(picture.subject_share(row, column));
    }
    auto const labels = labels_of(drawn.description);
    std::copy(labels.begin(), labels.end(),
              into.labels.begin() + static_cast<std::ptrdiff_t>(place * label_names.size()));
    // Words have random numbers of their own, so that other words leave the pictures as they are.
    random_draw words(request.seed ^ 0x776f726473U, number);
    into.captions[place] = draw_caption(words, drawn.description, request.length);
}

template <class T>
void write_values(std::ofstream& file, std::vector<T> const& values) {
    file.write(reinterpret_cast<char const*>(values.data()), static_cast<std::streamsize>(values.size() * sizeof(T)));
}

void write_sheet(std::filesystem::path const& path, block const& examples) {
    constexpr std::size_t rows = 6;
    constexpr std::size_t columns = 10;
    rgb8_image sheet({rows * grid.height, columns * grid.width}, {0, 0, 0});
    for (std::size_t i = 0; i < std::min(examples.captions.size(), rows * columns); ++i) {
        for (std::size_t p = 0; p < grid.size(); ++p) {
            auto const* const colour = &examples.images[(i * grid.size() + p) * 3];
            sheet.set(i / columns * grid.height + p / grid.width, i % columns * grid.width + p % grid.width,
                      {colour[0], colour[1], colour[2]});
        }
    }
    write_png(path, sheet);
}

int run(int argc, char** argv) {
    CLI::App app("Writes pictures of a small invented world with their inverse depth and captions, to train on.");
    std::filesystem::path folder;
    std::size_t count = 32768;
    picture_request request;
    auto is_held_out = false;
    auto says_all = false;
    std::size_t threads = 0;
    app.add_option("--out", folder, "Folder of the files")->required();
    app.add_option("--count", count, "Number of pictures")->capture_default_str()->check(CLI::PositiveNumber);
    app.add_option("--seed", request.seed, "Another seed, other scenes")->capture_default_str();
    app.add_flag("--held-out", is_held_out, "Patterns in pairs of colours that training never shows");
    app.add_flag("--full-captions", says_all, "Captions that leave nothing out");
    app.add_option("--threads", threads, "Threads; 0 = all of the machine")->capture_default_str();
    CLI11_PARSE(app, argc, argv);
    request.set = is_held_out ? picture_set::held_out : picture_set::training;
    request.length = says_all ? caption_length::full : caption_length::varied;

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
    auto subjects = open("subjects.u8");
    auto labels = open("labels.u8");
    auto captions = open("captions.txt");
    constexpr std::size_t block_size = 256;
    threaded_loop const loop(threads);
    for (std::size_t first = 0; first < count; first += block_size) {
        auto const size = std::min(block_size, count - first);
        block examples(size);
        loop(size, [&](std::size_t i) { draw_example(examples, i, request, static_cast<std::uint32_t>(first + i)); });
        write_values(images, examples.images);
        write_values(inverse_depth, examples.inverse_depth);
        write_values(subjects, examples.subjects);
        write_values(labels, examples.labels);
        for (auto const& caption : examples.captions) {
            captions << caption << '\n';
        }
        if (first == 0) {
            write_sheet(folder / "sheet.png", examples);
        }
        std::printf("\r%zu of %zu", first + size, count);
        std::fflush(stdout);
    }
    std::printf("\n");
    for (auto* const file : {&images, &inverse_depth, &subjects, &labels, &captions}) {
        if (!file->flush()) {
            throw file_error(folder.string() + ": writing failed, expected room for " + std::to_string(count) +
                             " pictures");
        }
    }
    nlohmann::json const description{{"count", count},
                                     {"height", grid.height},
                                     {"width", grid.width},
                                     {"labels", label_names},
                                     {"patterns", pattern_names},
                                     {"colours", colour_words},
                                     {"materials", material_names},
                                     {"lights", light_names},
                                     {"seed", request.seed},
                                     {"held_out", is_held_out},
                                     {"full_captions", says_all}};
    open("pictures.json") << description.dump(2) << '\n';
    return 0;
}

} // namespace

int main(int argc, char** argv) {
    try {
        return run(argc, argv);
    } catch (std::exception const& failure) {
        std::fprintf(stderr, "make_pictures: %s\n", failure.what());
        return 1;
    }
}
