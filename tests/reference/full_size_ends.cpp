// SPDX-License-Identifier: MIT
// Runs the text encoder or the VAE of a folder of full_size_ends.py; prints how far it is from what that wrote, the
// time and the peak of memory.
#include <genrender/core/parallel.hpp>
#include <genrender/reference/autoencoder_config_file.hpp>
#include <genrender/reference/autoencoder_kl.hpp>
#include <genrender/reference/clip_text_config_file.hpp>
#include <genrender/reference/clip_text_encoder.hpp>
#include <genrender/reference/diffusers_folder.hpp>
#include <genrender/reference/safetensors.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <string>
#include <vector>

using namespace genrender;

using namespace genrender::reference;

namespace {

/// Megabytes of memory that were in use at once so far, from /proc.
std::string peak_megabytes() {
    std::ifstream status("/proc/self/status");
    for (std::string word; status >> word;) {
        if (word == "VmHWM:") {
            std::size_t kilobytes = 0;
            status >> kilobytes;
            return std::to_string(kilobytes / 1024);
        }
    }
    return "unknown";
}

/// Runs `body` three times and says how long the fastest took.
template <class Body>
auto timed(Body&& body) {
    auto least = 1e9;
    for (int i = 0;; ++i) {
        auto const begin = std::chrono::steady_clock::now();
        auto result = body();
        least = std::min(least, std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
        if (i == 2) {
            std::cout << least << " s, ";
            return result;
        }
    }
}

/// Prints the largest difference over the range of what is expected; whether it is within `bound`.
bool compare(float const* found, std::vector<float> const& expected, float bound) {
    auto difference = 0.0f;
    for (std::size_t i = 0; i < expected.size(); ++i) {
        difference = std::max(difference, std::abs(found[i] - expected[i]));
    }
    auto const [lowest, highest] = std::minmax_element(expected.begin(), expected.end());
    auto const share = difference / (*highest - *lowest);
    std::cout << "largest difference " << difference << " = " << share << " of the range; ";
    return share <= bound;
}

/// A tensor [1, channels, height, width] of the file.
stack<float, 3> maps_of(safetensors_file const& file, std::string const& name) {
    auto const& shape = file.entries().at(name).shape;
    auto const values = file.read<float>(name);
    stack<float, 3> maps({shape.at(1), shape.at(2), shape.at(3)});
    std::copy(values.begin(), values.end(), maps.data());
    return maps;
}

bool run(std::string const& what, std::filesystem::path const& folder, any_loop const& loop, std::size_t stripe_bytes) {
    safetensors_file const data((folder / "ends.safetensors").string());
    if (what == "text") {
        auto const config = read_clip_text_config(config_file(folder / "text_encoder" / "config.json"));
        auto source = weights<float>::from_places(find_weights(folder / "text_encoder", "model"), folder.string());
        clip_text_encoder<float> const encoder(config, source);
        std::vector<std::uint32_t> ids;
        for (auto const id : data.read<float>("ids")) {
            ids.push_back(static_cast<std::uint32_t>(id));
        }
        auto const rows = timed([&] { return encoder(ids, loop); });
        return compare(rows.data(), data.read<float>("text"), 1e-5f);
    }
    auto const config = read_autoencoder_config(config_file(folder / "vae" / "config.json"));
    auto source = weights<float>::from_places(find_weights(folder / "vae", "diffusion_pytorch_model"), folder.string());
    auto const is_encode = what == "encode";
    autoencoder_kl<float> const vae(config, source, is_encode ? autoencoder_parts::both : autoencoder_parts::decoder);
    stripe_pass const pass{loop, stripe_bytes};
    if (is_encode) {
        auto const picture = maps_of(data, "picture");
        auto const latent = timed([&] { return vae.encode(picture, pass); });
        auto const first = compare(latent.mean.data(), data.read<float>("mean"), 1e-4f);
        return compare(latent.log_variance.data(), data.read<float>("log_variance"), 1e-4f) && first;
    }
    auto const z = maps_of(data, "z_" + what);
    auto const picture = timed([&] { return vae.decode(z, pass); });
    return compare(picture.data(), data.read<float>(what), 1e-4f);
}

} // namespace

int main(int argc, char** argv) {
    if (argc < 4 || argc > 5) {
        std::cerr << "usage: full_size_ends text|encode|decode64|decode96 FOLDER THREADS [STRIPE_BYTES] (see "
                     "full_size_ends.py)\n";
        return 2;
    }
    try {
        auto const bytes = argc == 5 ? std::stoul(argv[4]) : stripe_pass{}.stripe_bytes;
        auto const is_equal = run(argv[1], argv[2], threaded_loop(std::stoul(argv[3])), bytes);
        std::cout << "at most " << peak_megabytes() << " MB\n";
        return is_equal ? 0 : 1;
    } catch (std::exception const& error) {
        std::cerr << "full_size_ends: " << error.what() << "\n";
        return 1;
    }
}
