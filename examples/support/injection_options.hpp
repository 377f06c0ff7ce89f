// SPDX-License-Identifier: MIT
// The options of the command line that say how features of keyframes are injected: presets, temperature, variance, weights.
#pragma once

#include "names.hpp"

#include <genrender/core/finite.hpp>
#include <genrender/pipeline/render_settings.hpp>

#include <CLI/CLI.hpp>

#include <charconv>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

namespace genrender::examples {

/// Settings that have a name.
enum class render_preset : std::uint8_t { paper, plain, vivid };

/// How alpha runs over the steps.
enum class named_schedule : std::uint8_t { constant, fading, rising, early };

/// What the options say, in the words of the command line.
struct injection_options {
    static constexpr named<render_preset> preset_names[]{
        {"paper", render_preset::paper}, {"plain", render_preset::plain}, {"vivid", render_preset::vivid}};
    static constexpr named<variance_target> variance_names[]{
        {"none", variance_target::none}, {"total", variance_target::total}, {"sources", variance_target::sources}};
    static constexpr named<named_schedule> schedule_names[]{{"constant", named_schedule::constant},
                                                            {"fading", named_schedule::fading},
                                                            {"rising", named_schedule::rising},
                                                            {"early", named_schedule::early}};
    static constexpr named<keyframe_drawing> drawing_names[]{{"uniform", keyframe_drawing::uniform},
                                                             {"stratified", keyframe_drawing::stratified},
                                                             {"held", keyframe_drawing::held}};
    /// The share of the steps that --alpha-schedule early has alpha in.
    static constexpr float early_share = 0.6f;

    std::string preset = "vivid";
    std::optional<double> temperature; ///< none: the preset's, as with all that follow
    std::string variance;
    bool counts_points = false;
    std::string quality_exponent; ///< `P`, or `FROM:TO`
    std::optional<double> quality_threshold;
    float alpha = 0.7f;
    std::optional<float> latents_grid_alpha;
    std::string schedule = "constant";
    std::string drawing = "uniform";

    /// Adds the options that go with tokenflow and pix2video too to a command line, and the others to a group of it;
    /// `this` must outlive both.
    void add_to(CLI::App& app, CLI::Option_group& ours) {
        app.add_option("--temperature", temperature,
                       "power of ln(keys) / ln(own keys) on the logits where frames attend to others: 0 none, 1 the\n"
                       "length-corrected temperature, 0.5 its root (0)")
            ->type_name("P");
        auto const add = [&ours](char const* name, std::string& value, auto const& names, char const* text) {
            return ours.add_option(name, value, text)
                ->check(CLI::IsMember(all_names(names)).description(""))
                ->type_name("KIND");
        };
        add("--preset", preset, preset_names,
            "vivid (a consensus of clean estimates, and eq. 6 on grids coarser than the latents'), plain (neither) or\n"
            "paper (to the letter: texels, plain averages, means and deviations); what else is told goes before it")
            ->capture_default_str();
        add("--variance", variance, variance_names,
            "that eq. 6 keeps: none (default), total (of all that is averaged) or sources (of keyframes)");
        ours.add_flag(
            "--count-points", counts_points,
            "keys that show one surface point count together for one (the logarithm of their number is taken off)");
        ours.add_option("--alpha", alpha, "of post-attention injection (eq. 6), 0 to 1")
            ->capture_default_str()
            ->check(CLI::Range(0.0, 1.0).description(""))
            ->type_name("A");
        ours.add_option(
                "--latents-grid-alpha", latents_grid_alpha,
                "what alpha is multiplied by where features are as fine as latents, 0 to 1 (the preset's: 0 of\n"
                "vivid, else 1)")
            ->check(CLI::Range(0.0, 1.0).description(""))
            ->type_name("SHARE");
        add("--alpha-schedule", schedule, schedule_names,
            "of alpha over the steps: constant, fading (to 0), rising (from 0), early (first 60 %)")
            ->capture_default_str();
        ours.add_option(
                "--quality-exponent", quality_exponent,
                "of the qualities that weigh keyframes (1): 0 all alike, large the best alone; FROM:TO runs from\n"
                "the first step to the last")
            ->type_name("P|FROM:TO");
        ours.add_option("--quality-threshold", quality_threshold,
                        "least quality of a match, as a share of the frame's own: tokens without such a match are not\n"
                        "covered (0)")
            ->type_name("SHARE");
        add("--keyframe-drawing", drawing, drawing_names,
            "uniform or stratified (one of each stretch) anew in each step, or held (drawn once)")
            ->capture_default_str();
    }

    /// The preset, that everything else is told on top of. Steps stay.
    template <class Real>
    void start_from_preset(render_settings<Real>& settings) const {
        auto const steps = settings.steps;
        auto const of = value_in(preset_names, preset);
        settings = of == render_preset::paper   ? render_settings<Real>::paper()
                   : of == render_preset::plain ? render_settings<Real>::plain()
                                                : render_settings<Real>::vivid();
        settings.steps = steps;
    }

    /// Turns `settings` to what was told. Throws CLI::ValidationError for numbers that are none or out of range, and
    /// options that contradict each other.
    template <class Real>
    void apply_to(render_settings<Real>& settings) const {
        auto const require_number = [](char const* option, double value) {
            require(is_finite(value) && value >= 0 && value <= 100, option, "is not a number of 0 to 100");
        };
        require(alpha >= 0 && alpha <= 1, "--alpha", "is not a number, expected 0 to 1"); // Passes a range.
        if (temperature) {
            require_number("--temperature", *temperature);
            settings.injection.length_correction = *temperature;
        }
        if (!variance.empty()) {
            settings.injection.variance.target = value_in(variance_names, variance);
        }
        settings.latents_grid_alpha = latents_grid_alpha.value_or(settings.latents_grid_alpha);
        settings.injection.counts_points = settings.injection.counts_points || counts_points;
        if (!quality_exponent.empty()) {
            auto const [from, to] = exponents();
            require_number("--quality-exponent", from);
            require_number("--quality-exponent", to);
            require(settings.average == texel_average::by_quality, "--quality-exponent",
                    "is of --average quality and of --correspondence footprint");
            settings.quality.exponent_begin = from;
            settings.quality.exponent_end = to;
        }
        if (quality_threshold) {
            require_number("--quality-threshold", *quality_threshold);
            require(settings.correspondence.kind == correspondence_kind::footprint, "--quality-threshold",
                    "is of --correspondence footprint: texels know no quality");
            settings.quality.threshold = *quality_threshold;
        }
        auto const of = static_cast<Real>(alpha);
        switch (value_in(schedule_names, schedule)) {
        case named_schedule::constant:
            settings.alpha = constant_alpha(of);
            break;
        case named_schedule::fading:
            settings.alpha = running_alpha(of, 0, settings.steps);
            break;
        case named_schedule::rising:
            settings.alpha = running_alpha(Real{0}, of, settings.steps);
            break;
        case named_schedule::early:
            settings.alpha = early_alpha(of, static_cast<Real>(early_share), settings.steps);
            break;
        }
        settings.keyframes.drawing = value_in(drawing_names, drawing);
    }

private:
    static void require(bool holds, char const* option, char const* text) {
        if (!holds) {
            throw CLI::ValidationError(option, text);
        }
    }

    /// `P` or `FROM:TO`.
    std::pair<double, double> exponents() const {
        auto const number = [this](std::string_view text) {
            double value = 0;
            auto const [rest, error] = std::from_chars(text.data(), text.data() + text.size(), value);
            if (error != std::errc() || rest != text.data() + text.size()) {
                throw CLI::ValidationError("--quality-exponent",
                                           "is '" + quality_exponent + "', expected a number or two, as in 0:6");
            }
            return value;
        };
        auto const colon = quality_exponent.find(':');
        std::string_view const text = quality_exponent;
        auto const from = number(text.substr(0, colon));
        return {from, colon == std::string::npos ? from : number(text.substr(colon + 1))};
    }
};

} // namespace genrender::examples
