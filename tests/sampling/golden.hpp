// SPDX-License-Identifier: MIT
// What k-diffusion computes in double precision, from data/k_diffusion.json, which make_golden.py writes.
#pragma once

#include "../support/golden_file.hpp"

#include <genrender/sampling/sampler.hpp>

#include <array>
#include <cstddef>
#include <stdexcept>
#include <string>
#include <vector>

namespace genrender::golden {

/// Whose posterior mean the denoiser of a run is: N(0.7, 1.3^2); two equally likely points -1 and 1; two
/// equally likely clusters N(-1, 0.5^2) and N(1, 0.5^2).
enum class prior { gaussian, two_points, two_clusters };

/// One run over the Karras levels of `steps` steps.
struct run {
    prior of;
    sampler_kind method;
    std::size_t steps;
    std::size_t evaluations;
    std::array<double, 4> last; ///< what becomes of the starts
};

/// The value whose name is at the same place in the list of names. Throws std::runtime_error for another name.
template <class Value, std::size_t Count>
Value named(std::string const& name, std::array<char const*, Count> const& names, std::array<Value, Count> const& all) {
    for (std::size_t i = 0; i < Count; ++i) {
        if (name == names[i]) {
            return all[i];
        }
    }
    throw std::runtime_error("k_diffusion.json: " + name + " is not known");
}

/// [EDM eq. 5] Levels in Stable Diffusion's range, for a run of 1, 2, 10 or 50 steps.
inline std::vector<double> karras(std::size_t steps) {
    auto levels =
        testing::golden_file("k_diffusion.json")["karras"].at(std::to_string(steps)).get<std::vector<double>>();
    if (levels.size() != steps + 1) {
        throw std::runtime_error("k_diffusion.json: karras has other than one level more than steps");
    }
    return levels;
}

/// Times, the ends of Stable Diffusion's 1000 steps among them, and their noise levels.
struct levels_of_times {
    std::array<double, 8> times;
    std::array<double, 8> sigmas;
};

/// Noise levels, some outside of Stable Diffusion's range, and their times.
struct times_of_levels {
    std::array<double, 11> levels;
    std::array<double, 11> times;
};

inline levels_of_times read_levels_of_times() {
    auto const file = testing::golden_file("k_diffusion.json");
    return {file.at("times").get<std::array<double, 8>>(), file.at("sigmas_of_times").get<std::array<double, 8>>()};
}

inline times_of_levels read_times_of_levels() {
    auto const file = testing::golden_file("k_diffusion.json");
    return {file.at("levels").get<std::array<double, 11>>(), file.at("times_of_levels").get<std::array<double, 11>>()};
}

/// The latents that each run starts from.
inline std::array<double, 4> read_starts() {
    return testing::golden_file("k_diffusion.json").at("starts").get<std::array<double, 4>>();
}

inline std::vector<run> read_runs() {
    auto const file = testing::golden_file("k_diffusion.json");
    std::vector<run> runs;
    for (auto const& one : file.at("runs")) {
        runs.push_back({named(one.at("prior").get<std::string>(), std::array{"gaussian", "two_points", "two_clusters"},
                              std::array{prior::gaussian, prior::two_points, prior::two_clusters}),
                        named(one.at("sampler").get<std::string>(), std::array{"euler", "heun", "dpmpp_2m"},
                              std::array{sampler_kind::euler, sampler_kind::heun, sampler_kind::dpmpp_2m}),
                        one.at("steps").get<std::size_t>(), one.at("evaluations").get<std::size_t>(),
                        one.at("last").get<std::array<double, 4>>()});
    }
    return runs;
}

} // namespace genrender::golden
