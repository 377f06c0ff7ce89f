// SPDX-License-Identifier: MIT
// [GR sec. 3.3] Maps of a built-in scene, and how three kinds of initial noise behave on it: `maps_and_noise [folder]`.
#include "scenes/scenes.hpp"
#include "support/contact_sheet.hpp"
#include "support/pictures.hpp"

#include <genrender/correspondence/footprint_map.hpp>
#include <genrender/correspondence/reproject.hpp>
#include <genrender/scene/rasterizer.hpp>
#include <genrender/noise/initial_noise.hpp>

#include <cmath>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <string>
#include <vector>

using namespace genrender;
using namespace genrender::examples;

// Pearson's correlation of pairs of numbers, one pair at a time.
class correlation {
public:
    void add(double x, double y) {
        count_ += 1;
        x_ += x;
        y_ += y;
        xx_ += x * x;
        yy_ += y * y;
        xy_ += x * y;
    }
    double value() const {
        auto const covariance = xy_ / count_ - x_ / count_ * y_ / count_;
        auto const variances = (xx_ / count_ - x_ * x_ / count_ / count_) * (yy_ / count_ - y_ * y_ / count_ / count_);
        return covariance / std::sqrt(variances);
    }

private:
    double count_ = 0, x_ = 0, y_ = 0, xx_ = 0, yy_ = 0, xy_ = 0;
};

// Correlation between the noise of frames that are `apart`, over all pixels that show an object: of pixels that show
// the same surface point, or of pixels at the same place on the screen.
double correlation_of(latents<float> const& z, footprint_map<2> const& map, std::uint32_t apart, bool along_surfaces) {
    correlation pairs;
    auto const width = map.grid().width;
    for (std::uint32_t i = apart; i < z.shape()[0]; ++i) {
        for (std::uint32_t t = 0; t < map.grid().size(); ++t) {
            auto const shown = corresponding_token(map, {along_surfaces ? i - apart : i}, {i}, {t});
            auto const other = along_surfaces ? shown.value_or(token_index{}).value : t;
            for (std::size_t c = 0; c < z.shape()[1] && shown; ++c) {
                pairs.add(z(i - apart, c, other / width, other % width), z(i, c, t / width, t % width));
            }
        }
    }
    return pairs.value();
}

// The first three channels of each frame as colours.
std::vector<rgb8_image> noise_pictures(latents<float> const& z) {
    std::vector<rgb8_image> pictures;
    for (std::size_t i = 0; i < z.shape()[0]; ++i) {
        auto colours = tensor<float, 3>::from_shape({3, z.shape()[2], z.shape()[3]});
        for (std::size_t e = 0; e < colours.size(); ++e) {
            colours.data()[e] = 0.5f + z.data()[i * z.size() / z.shape()[0] + e] / 5;
        }
        pictures.push_back(rgb_picture(to_view(colours)));
    }
    return pictures;
}

int main(int argc, char** argv) try {
    auto const guidance = rasterize(scenes::make_scene("walking_figure", 12), {256, 256});
    auto const UV = to_uv_view(guidance.uv);
    grid_extents const grid{32, 32};
    footprint_map const map(UV, grid);
    std::vector<frame_index> frames;
    for (std::uint32_t i = 0; i < UV.frame_count(); ++i) {
        frames.push_back({i});
    }

    // UV noise moves with the surfaces. Read as a whole it is white in every frame; read by the nearest texel, as the
    // paper has it, it repeats values in neighbouring pixels.
    struct kind_of_noise {
        std::string name;
        noise_kind kind;
        noise_reading reading;
    };
    std::vector<kind_of_noise> const kinds{{"uv", noise_kind::uv, noise_reading::surface},
                                           {"uv_nearest_texel", noise_kind::uv, noise_reading::nearest_texel},
                                           {"fixed", noise_kind::fixed, {}},
                                           {"independent", noise_kind::independent, {}}};
    std::vector<latents<float>> noises;
    std::vector<double> table;
    std::printf("Correlation of noise between frames   same surface point            same place on the screen\n"
                "frames apart                              1       3       6             1       3       6\n");
    for (auto const& [name, kind, reading] : kinds) {
        auto& z = noises.emplace_back(latents<float>::from_shape({frames.size(), 4, grid.height, grid.width}));
        noise_settings settings;
        settings.kind = kind;
        settings.reading = reading;
        initial_noise(to_view(z), UV, frames, settings);
        std::printf("%-34s", name.c_str());
        for (auto const along_surfaces : {true, false}) {
            for (std::uint32_t const apart : {1U, 3U, 6U}) {
                auto const found = correlation_of(z, map, apart, along_surfaces);
                table.push_back(found);
                std::printf("%8.2f", found);
            }
            std::printf("%s", along_surfaces ? "      " : "\n");
        }
    }
    require_value(table[2] > 0.4, "maps_and_noise", "correlation of uv noise on surfaces", table[2], "above 0.4");

    // Pictures of all frames, if there is a folder for them.
    if (argc > 1) {
        std::filesystem::path const folder = argv[1];
        contact_sheet_options sheet;
        sheet.columns = 3;
        write_png(folder / "uv.png", contact_sheet(uv_pictures(guidance.uv), sheet));
        write_png(folder / "depth.png", contact_sheet(depth_pictures(guidance.depth), sheet));
        sheet.enlargement = 8;
        for (std::size_t k = 0; k < kinds.size(); ++k) {
            write_png(folder / ("noise_" + kinds[k].name + ".png"), contact_sheet(noise_pictures(noises[k]), sheet));
        }
        std::printf("Pictures are in %s\n", folder.c_str());
    }
} catch (std::exception const& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
}
