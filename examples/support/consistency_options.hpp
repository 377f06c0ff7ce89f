// SPDX-License-Identifier: MIT
// The options of the command line that say how clean estimates agree along the surfaces and how latents are normalised.
#pragma once

#include "names.hpp"

#include <genrender/pipeline/render_settings.hpp>

#include <CLI/CLI.hpp>

#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace genrender::examples {

/// What the options say, in the words of the command line; what is not told stays as the method has it.
struct consistency_options {
    static constexpr named<adain_statistics> statistics_names[]{
        {"means", adain_statistics::mean},
        {"supported", adain_statistics::mean_and_supported_deviation},
        {"wavelets", adain_statistics::low_band},
        {"paper", adain_statistics::mean_and_deviation}};
    static constexpr named<adain_target> target_names[]{{"first", adain_target::first_frame},
                                                        {"mean", adain_target::all_frames},
                                                        {"background", adain_target::first_with_background}};

    std::optional<bool> has_consensus; ///< none where not told
    std::vector<double> window;        ///< its begin and end; empty where not told
    std::string sources;               ///< how many; empty where not told
    std::string normalization;         ///< empty where not told
    std::string target;                ///< empty where not told

    /// Adds the options to a command line, which `this` must outlive, and gives --normalization, which other options may say
    /// in other words.
    CLI::Option* add_to(CLI::App& app) {
        auto* const group = app.add_option_group("Consistency", "of every method, unless it has its own");
        auto* const with = group->add_flag_callback(
            "--consensus", [this] { has_consensus = true; },
            "clean estimates of all frames agree along the surfaces, between the method and latent\n"
            "normalisation (the preset vivid)");
        group
            ->add_flag_callback(
                "--no-consensus", [this] { has_consensus = false; },
                "they do not (the presets plain and paper, and baselines)")
            ->excludes(with);
        group
            ->add_option("--consensus-window", window,
                         "shares of the steps between which they do, each 0 to 1 (0 and 0.7)")
            ->expected(2)
            ->type_name("BEGIN END");
        group
            ->add_option("--consensus-sources", sources,
                         "frames that the consensus is the mean of, drawn anew each step, or the word all (16)")
            ->type_name("K");
        auto kinds = all_names(statistics_names);
        kinds.emplace_back("none");
        auto* const normalized =
            group
                ->add_option(
                    "--normalization", normalization,
                    "what of the backgrounds' latents is made alike: means, supported (means, and deviations as\n"
                    "far as their pixels prove a difference), wavelets (low bands), paper (means and\n"
                    "deviations) or none (the preset's: none with vivid, else means; baselines none)")
                ->check(CLI::IsMember(kinds).description(""))
                ->type_name("KIND");
        group
            ->add_option("--normalization-target", target,
                         "with whose: those of the first frame, the mean over all frames, or of the first frame with\n"
                         "enough background (first)")
            ->check(CLI::IsMember(all_names(target_names)).description(""))
            ->type_name("FRAME");
        return normalized;
    }

    /// Turns `settings`, which the method has left as it wants them, to what was told. Throws CLI::ValidationError for
    /// values out of range and where options contradict each other.
    template <class Real>
    void apply_to(render_settings<Real>& settings) const {
        settings.consensus.enabled = has_consensus.value_or(settings.consensus.enabled);
        require(settings.consensus.enabled || window.empty(), "--consensus-window", "is of --consensus");
        require(settings.consensus.enabled || sources.empty(), "--consensus-sources", "is of --consensus");
        if (!window.empty()) {
            require(window[0] >= 0 && window[0] <= window[1] && window[1] <= 1, "--consensus-window",
                    "expected 0 <= BEGIN <= END <= 1");
            settings.consensus.window_begin = static_cast<Real>(window[0]);
            settings.consensus.window_end = static_cast<Real>(window[1]);
        }
        if (!sources.empty()) {
            settings.consensus.sources.count = source_count();
        }
        if (!normalization.empty()) {
            settings.normalization.enabled = normalization != "none";
            settings.normalization.statistics = settings.normalization.enabled
                                                    ? value_in(statistics_names, normalization)
                                                    : settings.normalization.statistics;
        }
        require(settings.normalization.enabled || target.empty(), "--normalization-target",
                "there is no normalisation");
        if (!target.empty()) {
            settings.normalization.target = value_in(target_names, target);
        }
    }

private:
    static void require(bool holds, char const* option, char const* text) {
        if (!holds) {
            throw CLI::ValidationError(option, text);
        }
    }

    std::size_t source_count() const {
        if (sources == "all") {
            return std::numeric_limits<std::size_t>::max();
        }
        auto const is_number = sources.find_first_not_of("0123456789") == std::string::npos && sources.size() < 8;
        require(is_number && std::stoul(sources) > 0, "--consensus-sources",
                ("is " + sources + ", expected a number of frames or all").c_str());
        return std::stoul(sources);
    }
};

} // namespace genrender::examples
