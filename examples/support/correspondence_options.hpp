// SPDX-License-Identifier: MIT
// The options of the command line that say how pixels are matched and what noise they start from.
#pragma once

#include "names.hpp"

#include <genrender/pipeline/render_settings.hpp>

#include <CLI/CLI.hpp>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

namespace genrender::examples {

/// What names a surface point: texture coordinates, or where it lies at rest.
enum class canonical_coordinates : std::uint8_t { uv, position };

/// What the options say, in the words of the command line.
struct correspondence_options {
    static constexpr named<canonical_coordinates> canonical_names[]{{"uv", canonical_coordinates::uv},
                                                                    {"position", canonical_coordinates::position}};
    static constexpr named<correspondence_kind> correspondence_names[]{{"footprint", correspondence_kind::footprint},
                                                                       {"texels", correspondence_kind::texel_grid}};
    static constexpr named<texel_average> average_names[]{
        {"plain", texel_average::plain}, {"quality", texel_average::by_quality}, {"winner", texel_average::winner}};
    static constexpr named<noise_reading> reading_names[]{{"surface", noise_reading::surface},
                                                          {"nearest", noise_reading::nearest_texel},
                                                          {"bilinear", noise_reading::bilinear_texel}};
    static constexpr named<background_noise> background_names[]{{"fixed", background_noise::fixed},
                                                                {"independent", background_noise::independent},
                                                                {"environment", background_noise::environment}};

    std::string canonical = "uv";
    std::string correspondence = "footprint";
    std::string average; ///< empty where not told: by quality, and plain with texels, whose quality is not known
    std::string noise = "surface";
    std::string background = "fixed";
    std::size_t feature_texels = 0;
    std::size_t noise_texels = 0;

    /// Adds the options to a command line; `this` must outlive it.
    void add_to(CLI::App& app) {
        auto* const group = app.add_option_group("Correspondence and noise", "the defaults need no setting");
        auto const add = [group](char const* name, std::string& value, auto const& names, char const* text) {
            group->add_option(name, value, text)
                ->capture_default_str()
                ->check(CLI::IsMember(all_names(names)).description(""))
                ->type_name("KIND");
        };
        add("--canonical", canonical, canonical_names,
            "what names a surface point: uv, or its rest position, which overlapping, mirrored\n"
            "and tiled UVs do not disturb");
        add("--correspondence", correspondence, correspondence_names,
            "footprint (of a feature cell on the surface), or texels: the paper's");
        add("--average", average, average_names,
            "of keyframes: by quality (how many pixels see the surface, how pure the cell), winner (the best\n"
            "alone) or plain, which is the paper's (quality; with texels plain)");
        add("--noise-reading", noise, reading_names,
            "surface (white in every frame), or one texel: nearest (the paper's), bilinear");
        add("--background", background, background_names,
            "noise where no object is: fixed to the screen, independent, or environment (turns with\n"
            "the camera)");
        auto const texels = CLI::Range(std::size_t{0}, std::size_t{1} << 20).description("");
        group
            ->add_option("--texture-resolution", feature_texels, "T of --correspondence texels; 0: matched to the maps")
            ->capture_default_str()
            ->check(texels)
            ->type_name("T");
        group->add_option("--noise-resolution", noise_texels, "T of noise read from texels; 0: matched to the maps")
            ->capture_default_str()
            ->check(texels)
            ->type_name("T");
    }

    /// Lets what was not told to a command line that was parsed be what `settings` say.
    template <class Real>
    void default_to(render_settings<Real> const& settings, CLI::App const& app) {
        auto const is_told = [&app](char const* name) { return app.get_option(name)->count() > 0; };
        if (!is_told("--correspondence")) {
            correspondence = name_in(correspondence_names, settings.correspondence.kind);
        }
        if (!is_told("--noise-reading")) {
            noise = name_in(reading_names, settings.noise.reading);
        }
        if (!is_told("--average") && settings.average == texel_average::plain) {
            average = "plain"; // Else empty: it follows the correspondence.
        }
    }

    /// Turns `settings` to what was told. Throws CLI::ValidationError where options contradict each other.
    template <class Real>
    void apply_to(render_settings<Real>& settings) const {
        settings.correspondence.kind = value_in(correspondence_names, correspondence);
        settings.correspondence.texels.T = feature_texels > 0 ? std::optional(feature_texels) : std::nullopt;
        settings.noise.reading = value_in(reading_names, noise);
        settings.noise.T = noise_texels > 0 ? std::optional(noise_texels) : std::nullopt;
        settings.noise.background = value_in(background_names, background);
        auto const has_texels = settings.correspondence.kind == correspondence_kind::texel_grid;
        settings.average = !average.empty() ? value_in(average_names, average)
                           : has_texels     ? texel_average::plain
                                            : texel_average::by_quality;
        auto const has_noise_texels = settings.noise.reading != noise_reading::surface;
        require(feature_texels == 0 || has_texels, "--texture-resolution", "is of --correspondence texels");
        require(noise_texels == 0 || has_noise_texels, "--noise-resolution",
                "is of --noise-reading nearest or bilinear");
        require(settings.average == texel_average::plain || !has_texels, "--average",
                "quality is not known to --correspondence texels");
        require(settings.noise.background != background_noise::environment || !has_noise_texels, "--background",
                "environment takes --noise-reading surface");
        require(coordinates() == canonical_coordinates::uv || (!has_texels && !has_noise_texels), "--canonical",
                "position has no texels: --correspondence footprint and --noise-reading surface");
    }

    canonical_coordinates coordinates() const { return value_in(canonical_names, canonical); }

private:
    static void require(bool holds, char const* option, char const* text) {
        if (!holds) {
            throw CLI::ValidationError(option, text);
        }
    }
};

} // namespace genrender::examples
