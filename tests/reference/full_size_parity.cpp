// SPDX-License-Identifier: MIT
// Loads a folder of full_size_parity.py and prints how far the networks here are from diffusers.
#include <genrender/attention/plain_attention.hpp>
#include <genrender/reference/controlnet.hpp>
#include <genrender/reference/diffusers_folder.hpp>
#include <genrender/reference/forward_pass.hpp>
#include <genrender/reference/safetensors.hpp>
#include <genrender/reference/unet.hpp>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <exception>
#include <filesystem>
#include <iostream>
#include <string>
#include <vector>

using namespace genrender;

using namespace genrender::reference;

namespace {

/// Runs `body` and says how long that took.
template <class Body>
auto timed(char const* what, Body&& body) {
    auto const begin = std::chrono::steady_clock::now();
    auto result = body();
    std::chrono::duration<double> const seconds = std::chrono::steady_clock::now() - begin;
    std::cout << what << ": " << seconds.count() << " s\n";
    return result;
}

/// A tensor [1, channels, height, width] of the file.
feature_maps<float> maps_of(safetensors_file const& file, std::string const& name) {
    auto const& shape = file.entries().at(name).shape;
    auto const values = file.read<float>(name);
    feature_maps<float> maps(1, {shape.at(2), shape.at(3)}, shape.at(1));
    copy(maps.channels_first(), strided_view<float const, 4>(values.data(), {1, shape[1], shape[2], shape[3]}));
    return maps;
}

/// Prints the largest difference over the range of what is expected; whether it is small.
bool compare(char const* what, feature_maps<float> found, feature_maps<float> expected) {
    auto const a = found.view();
    auto const b = expected.view();
    require_shape("full_size_parity", "found", a, b.extents());
    auto difference = 0.0f;
    auto lowest = b(0, 0, 0);
    auto highest = lowest;
    for (std::size_t token = 0; token < b.extent(1); ++token) {
        for (std::size_t c = 0; c < b.extent(2); ++c) {
            difference = std::max(difference, std::abs(a(0, token, c) - b(0, token, c)));
            lowest = std::min(lowest, b(0, token, c));
            highest = std::max(highest, b(0, token, c));
        }
    }
    auto const share = difference / (highest - lowest);
    std::cout << what << ": largest difference " << difference << " = " << share << " of the range\n";
    return share <= 1e-4f;
}

/// Whether both outputs are those of diffusers.
bool is_equal(std::filesystem::path const& folder) {
    diffusers_folder const files(folder);
    auto const config = files.config();
    safetensors_file const data((folder / "parity.safetensors").string());
    auto const z = maps_of(data, "z");
    auto const hint = maps_of(data, "hint");
    auto const tokens = data.read<float>("prompt");
    strided_view<float const, 2> const prompt(tokens.data(),
                                              {tokens.size() / config.cross_attention_dim, config.cross_attention_dim});
    auto const t = data.read<float>("t").front();
    auto const scale = data.read<float>("scale").front();

    std::array const frames{frame_index{0}};
    plain_attention const plain;
    sequential_loop const loop;
    forward_pass<float> pass{frames, 0, prompt, plain, loop};
    site_list sites(z.grid());
    // One network after the other, so that one at a time is in memory.
    auto const added = [&] {
        auto source = files.controlnet<float>();
        auto const control = timed("loading the ControlNet", [&] { return controlnet<float>(config, source, sites); });
        return timed("ControlNet", [&] {
            auto const embedded = control.embed(hint);
            return control(pass, z, t, {&embedded}, scale);
        });
    }();
    auto source = files.unet<float>();
    auto const network = timed("loading the UNet", [&] { return unet<float>(config, source, sites); });
    auto const controlled = timed("UNet", [&] { return network(pass, z, t, &added); });
    auto const alone = network(pass, z, t);
    auto const first = compare("UNet alone", alone, maps_of(data, "alone"));
    auto const second = compare("UNet with ControlNet", controlled, maps_of(data, "controlled"));
    return first && second;
}

} // namespace

int main(int argc, char** argv) {
    if (argc != 2) {
        std::cerr << "usage: full_size_parity FOLDER (see full_size_parity.py)\n";
        return 2;
    }
    std::cout << std::unitbuf; // minutes lie between its lines
    try {
        return is_equal(argv[1]) ? 0 : 1;
    } catch (std::exception const& error) {
        std::cerr << "full_size_parity: " << error.what() << "\n";
        return 1;
    }
}
