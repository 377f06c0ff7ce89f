// SPDX-License-Identifier: MIT
// The plan of a run as text and as JSON: what it will hold, compute and take.
#pragma once

#include "output_file.hpp"
#include "resident_memory.hpp"
#include "text_table.hpp"

#include <genrender/attention/plain_attention.hpp>
#include <genrender/core/tensor.hpp>
#include <genrender/pipeline/memory_plan.hpp>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace genrender::examples {

/// What the decoding of one frame's latents into a picture takes, after the run.
struct decoding_cost {
    double seconds = 0;                  ///< of one picture
    std::optional<std::int64_t> bytes{}; ///< that the program grows by, its weights included
};

/// A plan, and what a call of the denoiser tells of the time.
struct timed_plan {
    memory_plan plan;
    double seconds_per_frame = 0; ///< of the denoiser alone, one frame a call and one call at a time, on its threads
    std::optional<std::int64_t> weights_bytes{}; ///< of the networks, held as long as the program runs
    decoding_cost decoding{};                    ///< of what turns latents into pictures
};

/// Decodes one frame of nothing by `pictures(z)` to see what it takes.
template <denoiser Phi, class Pictures>
decoding_cost time_decoding(Phi const& phi, Pictures const& pictures) {
    auto const grid = grid_extents(phi.latent_grid());
    auto z = latents<typename Phi::real_type>::from_shape({1, phi.latent_channels(), grid.height, grid.width});
    z.fill(0);
    decoding_cost cost;
    auto const start = std::chrono::steady_clock::now();
    cost.bytes = resident_growth([&] { pictures(z); });
    cost.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return cost;
}

/// Calls the denoiser with frames of nothing to see what a call takes, and plans the run on these maps.
template <denoiser Phi, canonical_maps Maps, class Real>
timed_plan plan_run(Phi const& phi, Maps const& maps, render_settings<Real> const& settings, std::size_t threads) {
    auto run = describe_run(phi, maps, threads);
    auto const grid = grid_extents(phi.latent_grid());
    double seconds = 0;
    auto const call = [&](std::uint32_t count) {
        auto z = latents<Real>::from_shape({count, phi.latent_channels(), grid.height, grid.width});
        z.fill(0);
        auto x0 = z;
        std::vector<frame_index> frames;
        for (std::uint32_t i = 0; i < count; ++i) {
            frames.push_back({i});
        }
        plain_attention const plain;
        auto const start = std::chrono::steady_clock::now();
        phi(to_view(x0), to_view(std::as_const(z)), Real(1), frames, plain);
        seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    };
    call(1); // What is there once a program, such as its code, is no call's.
    auto const several = std::min<std::uint32_t>(3, static_cast<std::uint32_t>(run.frames));
    auto const stack = resident_growth([&] { call(several); });
    auto const one = resident_growth([&] { call(1); });
    if (one && stack) {
        auto const further = several > 1 ? std::max<std::int64_t>(0, (*stack - *one) / (several - 1)) : *one;
        run.network_bytes = static_cast<std::size_t>(further);
        run.call_bytes = static_cast<std::size_t>(std::max<std::int64_t>(0, *one - further));
    }
    return {plan_memory(run, settings), seconds};
}

namespace detail {

/// What the plan says of bytes, with the words of the table.
inline std::vector<std::pair<std::string, std::size_t>> named_bytes(planned_bytes const& bytes) {
    return {{"maps", bytes.maps},
            {"latents", bytes.latents},
            {"background", bytes.background},
            {"correspondence", bytes.correspondence},
            {"matching", bytes.matching},
            {"keyframe_features", bytes.bank},
            {"keyframe_residuals", bytes.residuals},
            {"keyframe_latents", bytes.keyframe_latents},
            {"blend_plans", bytes.blend_plans},
            {"consensus", bytes.consensus},
            {"network", bytes.network},
            {"peak", bytes.peak}};
}

} // namespace detail

/// The plan as JSON: bytes, FLOPs, seconds.
inline nlohmann::ordered_json plan_json(timed_plan const& timed) {
    nlohmann::ordered_json json;
    for (auto const& [name, bytes] : detail::named_bytes(timed.plan.bytes)) {
        json["bytes"][name] = bytes;
    }
    auto const& work = timed.plan.work;
    json["denoised_frames"] = work.denoised_frames;
    json["attention_flops"] = work.attention_flops;
    json["attention_flops_frame_by_frame"] = work.plain_attention_flops;
    json["projection_flops"] = work.projection_flops;
    json["mixed_bytes"] = work.mixed_bytes;
    json["noise_values"] = work.noise_values;
    json["consensus_bytes"] = work.consensus_bytes;
    json["consensus_matches"] = work.consensus_matches;
    json["normalized_bytes"] = work.normalized_bytes;
    json["weights_bytes"] = timed.weights_bytes ? nlohmann::ordered_json(*timed.weights_bytes) : nullptr;
    json["decoding_bytes"] = timed.decoding.bytes ? nlohmann::ordered_json(*timed.decoding.bytes) : nullptr;
    json["decoding_seconds_per_picture"] = timed.decoding.seconds;
    json["denoiser_seconds"] = timed.seconds_per_frame * static_cast<double>(work.denoised_frames);
    return json;
}

/// The plan as tables.
inline std::string plan_text(timed_plan const& timed) {
    std::vector<std::vector<std::string>> memory{{"memory", "MB"}};
    for (auto [name, bytes] : detail::named_bytes(timed.plan.bytes)) {
        std::replace(name.begin(), name.end(), '_', ' ');
        name += name == "maps" ? " (held already)" : name == "peak" ? " (beyond the maps)" : "";
        memory.push_back({name, fixed_text(static_cast<double>(bytes) / 1e6, 2)});
    }
    if (timed.weights_bytes) {
        memory.insert(memory.begin() + 1,
                      {"networks (held already)", fixed_text(static_cast<double>(*timed.weights_bytes) / 1e6, 2)});
    }
    if (timed.decoding.bytes) {
        memory.push_back({"decoding (after the run)", fixed_text(static_cast<double>(*timed.decoding.bytes) / 1e6, 2)});
    }
    auto const& work = timed.plan.work;
    auto const seconds = timed.seconds_per_frame * static_cast<double>(work.denoised_frames);
    return table_text(memory) +
           table_text({{"work", ""},
                       {"frames to denoise", std::to_string(work.denoised_frames)},
                       {"attention, GFLOP", fixed_text(work.attention_flops / 1e9, 2)},
                       {"of denoising frame by frame, times", fixed_text(work.attention_ratio(), 2)},
                       {"projections of the network, GFLOP", fixed_text(work.projection_flops / 1e9, 2)},
                       {"features mixed, GB", fixed_text(work.mixed_bytes / 1e9, 3)},
                       {"noise, million values", fixed_text(work.noise_values / 1e6, 2)},
                       {"latents in consensus, GB", fixed_text(work.consensus_bytes / 1e9, 3)},
                       {"latents normalised, GB", fixed_text(work.normalized_bytes / 1e9, 3)},
                       {"denoiser, minutes, about", fixed_text(seconds / 60, 2)},
                       {"decoding, seconds a picture, about", fixed_text(timed.decoding.seconds, 2)}});
}

/// Writes plan.txt and plan.json into `folder`. Throws file_error if a file cannot be written.
inline void write_plan(std::filesystem::path const& folder, timed_plan const& timed) {
    write_text(folder / "plan.txt", plan_text(timed));
    write_text(folder / "plan.json", plan_json(timed).dump(2) + "\n");
}

} // namespace genrender::examples
