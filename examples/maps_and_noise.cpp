// SPDX-License-Identifier: MIT
// [GR sec. 3.3] Maps of a built-in scene, and what the three kinds of initial noise do on it: `maps_and_noise [folder]`.
#include "scenes/scenes.hpp"
#include "support/contact_sheet.hpp"
#include "support/pictures.hpp"

#include <genrender/correspondence/reproject.hpp>
#include <genrender/correspondence/texel_grid.hpp>
#include <genrender/guidance/rasterizer.hpp>
#include <genrender/noise/initial_noise.hpp>

#include <cmath>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <string>
#include <utility>
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

// What a table of noise says about one kind of it: correlation between each frame and the first, along the surfaces (pixels
// that the texel grid says correspond) and across the screen (pixels at the same place, where the surface is another one).
struct noise_behaviour {
    double on_surface;
    double on_screen;
    double deviation;
};

noise_behaviour measure(latents<float> const& z, texel_grid const& map) {
    correlation on_surface;
    correlation on_screen;
    double squares = 0;
    auto const width = map.grid().width;
    for (std::uint32_t i = 1; i < z.shape()[0]; ++i) {
        for (std::uint32_t t = 0; t < map.grid().size(); ++t) {
            auto const first = corresponding_token(map, {0}, {i}, {t});
            for (std::size_t c = 0; c < z.shape()[1]; ++c) {
                auto const value = z(i, c, t / width, t % width);
                squares += static_cast<double>(value * value);
                if (first) {
                    on_surface.add(z(0, c, first->value / width, first->value % width), value);
                }
                if (map.point_at({i}, {t}) && first != token_index{t}) {
                    on_screen.add(z(0, c, t / width, t % width), value);
                }
            }
        }
    }
    auto const count = static_cast<double>(z.size()) * (1 - 1 / static_cast<double>(z.shape()[0]));
    return {on_surface.value(), on_screen.value(), std::sqrt(squares / count)};
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
    auto const guidance = rasterize(scenes::make_scene("walking_figure", 6), {256, 256});
    auto const UV = to_uv_view(guidance.uv);
    grid_extents const grid{32, 32};
    texel_grid const map(UV, grid);
    std::vector<frame_index> const frames{{0}, {1}, {2}, {3}, {4}, {5}};

    std::vector<std::pair<std::string, noise_kind>> const kinds{
        {"uv", noise_kind::uv}, {"fixed", noise_kind::fixed}, {"independent", noise_kind::independent}};
    std::vector<latents<float>> noises;
    std::vector<noise_behaviour> found;
    std::printf("Correlation of the noise on objects between the first of %zu frames and the others\n", frames.size());
    std::printf("  noise         at the same surface point   at the same place on the screen   deviation\n");
    for (auto const& [name, kind] : kinds) {
        auto& z = noises.emplace_back(latents<float>::from_shape({frames.size(), 4, grid.height, grid.width}));
        noise_settings settings;
        settings.kind = kind;
        initial_noise(to_view(z), UV, frames, settings);
        auto const& is = found.emplace_back(measure(z, map));
        std::printf("  %-12s  %25.2f   %31.2f   %9.2f\n", name.c_str(), is.on_surface, is.on_screen, is.deviation);
    }
    auto const follows_surfaces = found[0].on_surface > 0.5 && std::abs(found[2].on_surface) < 0.1;
    require_value(follows_surfaces, "maps_and_noise", "correlation", found[0].on_surface, "UV noise that follows the surfaces");

    // Pictures of all frames, if there is a folder for them.
    if (argc > 1) {
        std::filesystem::path const folder = argv[1];
        contact_sheet_options sheet;
        sheet.columns = 3;
        write_png(folder / "uv.png", contact_sheet(uv_pictures(guidance.uv), sheet));
        write_png(folder / "depth.png", contact_sheet(depth_pictures(guidance.depth), sheet));
        sheet.enlargement = 8;
        for (std::size_t k = 0; k < kinds.size(); ++k) {
            write_png(folder / ("noise_" + kinds[k].first + ".png"), contact_sheet(noise_pictures(noises[k]), sheet));
        }
        std::printf("Pictures are in %s\n", folder.c_str());
    }
} catch (std::exception const& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
}
