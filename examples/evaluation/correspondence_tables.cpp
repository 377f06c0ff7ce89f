// SPDX-License-Identifier: MIT
// [GR supplement: effect of texture resolution] How many pixels find their partners and how well noise moves along,
// without a texture and with textures of every resolution: two tables, no network.
#include "results.hpp"

#include <examples/scenes/scenes.hpp>
#include <examples/support/exr_maps.hpp>
#include <examples/support/output_file.hpp>

#include <genrender/core/parallel.hpp>
#include <genrender/correspondence/representative_pixel.hpp>
#include <genrender/correspondence/chosen_correspondence.hpp>
#include <genrender/evaluation/pixel_correspondence.hpp>
#include <genrender/scene/rasterizer.hpp>
#include <genrender/noise/initial_noise.hpp>

#include <CLI/CLI.hpp>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <optional>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

using namespace genrender;
using namespace genrender::examples;

namespace {

/// An animation's maps by a name.
struct named_maps {
    std::string name;
    uv_maps uv;
};

/// A correspondence under a name.
struct named_correspondence {
    std::string name;
    correspondence_settings settings;
};

/// How the tokens of some frames find partners in four keyframes.
struct matching {
    std::size_t with_partner = 0; ///< tokens whose surface point some keyframe shows, by the maps' own pixels
    std::size_t found = 0;        ///< of those, tokens that find a partner in such a keyframe
    double distance = 0; ///< sum over partners, from the middle of the token found to the true place, in tokens
    std::size_t partners = 0;

    double hit_rate() const { return static_cast<double>(found) / static_cast<double>(with_partner); }
    double error() const { return distance / static_cast<double>(partners); }
};

/// The truth is where a pixel of the maps shows the very point, to half a pixel.
matching match(uv_maps_view const& maps, pixel_correspondence const& truth, grid_extents grid,
               correspondence_settings const& settings) {
    chosen_correspondence<2> const map(maps, grid, settings);
    auto const pixels = maps.grid();
    auto const cell = static_cast<double>(pixels.width / grid.width);
    auto const frames = static_cast<std::uint32_t>(maps.frame_count());
    std::array<std::uint32_t, 4> const keyframes{frames / 8, 3 * frames / 8, 5 * frames / 8, 7 * frames / 8};
    matching result;
    for (std::uint32_t i = 0; i < frames; i += 3) {
        for (std::uint32_t t = 0; t < grid.size(); ++t) {
            auto const p = representative_pixel(maps, {i}, grid, {t});
            auto const shown =
                p ? truth.point_at({i}, {static_cast<std::uint32_t>(p->row * pixels.width + p->column)}) : std::nullopt;
            if (!shown) {
                continue;
            }
            auto const point = map.point_at({i}, {t});
            auto has_partner = false;
            auto is_found = false;
            for (auto const keyframe : keyframes) {
                auto const place = truth.token_at({keyframe}, *shown);
                if (!place) {
                    continue;
                }
                has_partner = true;
                auto const token = point ? map.token_at({keyframe}, *point) : std::nullopt;
                if (token) {
                    is_found = true;
                    auto const down = (static_cast<double>(place->value / pixels.width) + 0.5) / cell -
                                      (static_cast<double>(token->value / grid.width) + 0.5);
                    auto const right = (static_cast<double>(place->value % pixels.width) + 0.5) / cell -
                                       (static_cast<double>(token->value % grid.width) + 0.5);
                    result.distance += std::hypot(down, right);
                    ++result.partners;
                }
            }
            result.with_partner += has_partner ? 1U : 0U;
            result.found += is_found ? 1U : 0U;
        }
    }
    return result;
}

std::string matching_table(std::vector<named_maps> const& animations, threaded_loop const& loop) {
    std::vector<named_correspondence> rows{{"Footprints", {}}};
    for (std::size_t const T : {0U, 64U, 256U, 1024U, 2048U, 4096U}) {
        correspondence_settings settings;
        settings.kind = correspondence_kind::texel_grid;
        settings.texels.T = T > 0 ? std::optional(T) : std::nullopt;
        rows.push_back({T == 0 ? "Texels, T matched" : "Texels, T = " + std::to_string(T), settings});
    }
    constexpr std::array<std::size_t, 4> sides{64, 32, 16, 8};
    std::ostringstream text;
    text << "| Animation | Correspondence | 64² hit | error | 32² hit | error | 16² hit | error | 8² hit | error |\n"
            "|---|---|---|---|---|---|---|---|---|---|\n";
    for (auto const& animation : animations) {
        auto const maps = to_uv_view(animation.uv);
        pixel_correspondence const truth(maps, maps.grid(), 0.5, loop);
        std::vector<matching> cells(rows.size() * sides.size());
        loop(cells.size(), [&](std::size_t c) {
            auto const side = sides[c % sides.size()];
            cells[c] = match(maps, truth, {side, side}, rows[c / sides.size()].settings);
        });
        for (std::size_t r = 0; r < rows.size(); ++r) {
            text << "| " << animation.name << " | " << rows[r].name << " |";
            for (std::size_t s = 0; s < sides.size(); ++s) {
                auto const& cell = cells[r * sides.size() + s];
                text << ' ' << examples::detail::decimal(100 * cell.hit_rate(), 1) << " % | "
                     << examples::detail::decimal(cell.error(), 2) << " |";
            }
            text << '\n';
        }
    }
    return text.str();
}

/// Statistics of one kind of noise over all frames of an animation.
std::string noise_row(uv_maps_view const& maps, pixel_correspondence const& pixels, noise_settings const& settings,
                      threaded_loop const& loop) {
    auto const grid = pixels.grid();
    constexpr std::size_t channels = 16;
    std::vector<frame_index> frames;
    for (std::uint32_t i = 0; i < maps.frame_count(); ++i) {
        frames.push_back({i});
    }
    auto z = tensor<float, 4>::from_shape({frames.size(), channels, grid.height, grid.width});
    initial_noise(to_view(z), maps, frames, settings, loop);
    double squares = 0;
    double beside = 0;
    std::size_t neighbours = 0;
    std::size_t covered = 0;
    std::array<double, 3> along{};
    std::array<std::size_t, 3> pairs{};
    constexpr std::array<std::uint32_t, 3> apart{1, 3, 6};
    for (std::uint32_t i = 0; i < frames.size(); ++i) {
        for (std::uint32_t t = 0; t < grid.size(); ++t) {
            auto const point = pixels.point_at({i}, {t});
            if (!point) {
                continue;
            }
            auto const value = [&](std::uint32_t frame, std::uint32_t token, std::size_t c) {
                return static_cast<double>(z(frame, c, token / grid.width, token % grid.width));
            };
            auto const has_neighbour = (t + 1) % grid.width != 0 && pixels.point_at({i}, {t + 1});
            for (std::size_t c = 0; c < channels; ++c) {
                squares += value(i, t, c) * value(i, t, c);
                ++covered;
                if (has_neighbour) {
                    beside += value(i, t, c) * value(i, t + 1, c);
                    ++neighbours;
                }
            }
            for (std::size_t k = 0; k < apart.size(); ++k) {
                auto const other = i >= apart[k] ? pixels.token_at({i - apart[k]}, *point) : std::nullopt;
                for (std::size_t c = 0; other && c < channels; ++c) {
                    along[k] += value(i, t, c) * value(i - apart[k], other->value, c);
                    ++pairs[k];
                }
            }
        }
    }
    auto const variance = squares / static_cast<double>(covered);
    std::string text = " " + examples::detail::decimal(variance, 3) + " | " +
                       examples::detail::decimal(beside / static_cast<double>(neighbours) / variance, 3) + " |";
    for (std::size_t k = 0; k < apart.size(); ++k) {
        text += " " + examples::detail::decimal(along[k] / static_cast<double>(pairs[k]) / variance, 3) + " |";
    }
    return text;
}

std::string noise_table(std::vector<named_maps> const& animations, threaded_loop const& loop) {
    std::vector<std::pair<std::string, noise_settings>> rows(1, {"Surface", {}});
    auto const add = [&](std::string const& name, noise_reading reading, std::size_t T) {
        noise_settings settings;
        settings.reading = reading;
        settings.T = T > 0 ? std::optional(T) : std::nullopt;
        rows.emplace_back(name + (T == 0 ? ", T matched" : ", T = " + std::to_string(T)), settings);
    };
    for (std::size_t const T : {0U, 64U, 256U, 1024U, 2048U}) {
        add("Nearest texel", noise_reading::nearest_texel, T);
    }
    add("Bilinear texels", noise_reading::bilinear_texel, 0);
    std::ostringstream text;
    text << "| Animation | Noise | Variance | Neighbours | 1 frame apart | 3 | 6 |\n|---|---|---|---|---|---|---|\n";
    for (auto const& animation : animations) {
        auto const maps = to_uv_view(animation.uv);
        pixel_correspondence const pixels(maps, {64, 64}, 0.25, loop);
        for (auto const& [name, settings] : rows) {
            text << "| " << animation.name << " | " << name << " |" << noise_row(maps, pixels, settings, loop) << '\n';
        }
    }
    return text.str();
}

void run(std::filesystem::path const& out, std::filesystem::path const& sequence, std::size_t frames,
         std::size_t size) {
    threaded_loop const loop;
    std::vector<named_maps> animations;
    for (auto const name : scenes::names) {
        auto const scene = scenes::make_scene(name, frames);
        animations.push_back({std::string(name), rasterize(scene, {size, size}, loop).uv});
    }
    if (!sequence.empty()) {
        animations.push_back({"a Blender sequence", load_exr_sequence(sequence).uv});
    }
    std::ostringstream text;
    text << "# Partners of feature pixels in four keyframes, " << frames << " frames of " << size << "² maps\n\n"
         << "Hit: tokens with a true partner that find one. Error: from the token found to the true place, in "
            "tokens.\n\n"
         << matching_table(animations, loop) << "\n# Noise of 64² latents where objects are\n\n"
         << "Correlation of neighbours in a row, and of pixels of one surface point.\n\n"
         << noise_table(animations, loop);
    if (!out.empty()) {
        write_text(out, text.str());
    }
    std::printf("%s", text.str().c_str());
}

} // namespace

int main(int argc, char** argv) {
    std::filesystem::path out;
    std::filesystem::path sequence;
    std::size_t frames = 24;
    std::size_t size = 512;
    CLI::App app("Prints how many feature pixels find their partners and how white and consistent noise is.");
    app.add_option("--out", out, "A Markdown file to write as well");
    app.add_option("--maps", sequence,
                   "A folder of EXR files, square and a multiple of 64 pixels, beside the built-in scenes");
    app.add_option("--frames", frames, "Frames of the built-in scenes")
        ->capture_default_str()
        ->check(CLI::Range(8, 1000));
    app.add_option("--size", size, "Height and width of the maps, a multiple of 64")->capture_default_str();
    CLI11_PARSE(app, argc, argv);
    try {
        require_value(size > 0 && size % 64 == 0, "correspondence_tables", "--size", size, "a multiple of 64");
        run(out, sequence, frames, size);
    } catch (std::exception const& error) {
        std::fprintf(stderr, "correspondence_tables: %s\n", error.what());
        return 1;
    }
    return 0;
}
