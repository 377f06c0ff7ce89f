// SPDX-License-Identifier: MIT
// The options of the command line that say how pixels are matched and what noise they start from.
#pragma once

#include <genrender/pipeline/render_settings.hpp>

#include <CLI/CLI.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace genrender::examples {

/// What names a surface point: texture coordinates, or where it lies at rest.
enum class canonical_coordinates : std::uint8_t { uv, position };

/// What the options say, in the words of the command line.
struct correspondence_options {
    static constexpr std::array<std::string_view, 2> canonical_names{"uv", "position"};
    static constexpr std::array<std::string_view, 2> correspondence_names{"footprint", "texels"};
    static constexpr std::array<std::string_view, 2> average_names{"plain", "quality"};
    static constexpr std::array<std::string_view, 3> noise_names{"surface", "nearest", "bilinear"};
    static constexpr std::array<std::string_view, 3> background_names{"fixed", "independent", "environment"};

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
                ->check(CLI::IsMember(std::vector<std::string>(names.begin(), names.end())).description(""))
                ->type_name("KIND");
        };
        add("--canonical", canonical, canonical_names,
            "what names a surface point: uv, or its rest position, which overlapping, mirrored\n"
            "and tiled UVs do not disturb");
        add("--correspondence", correspondence, correspondence_names,
            "footprint (of a feature cell on the surface), or texels: the paper's");
        add("--average", average, average_names,
            "of keyframes: by quality (how many pixels see the surface, how pure the cell), or plain,\n"
            "which is the paper's (quality; with texels plain)");
        add("--noise-reading", noise, noise_names,
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

    /// Turns `settings` to what was told. Throws CLI::ValidationError where options contradict each other.
    template <class Real>
    void apply_to(render_settings<Real>& settings) const {
        settings.correspondence.kind = chosen<correspondence_kind>(correspondence, correspondence_names);
        settings.correspondence.texels.T = feature_texels > 0 ? std::optional(feature_texels) : std::nullopt;
        settings.noise.reading = chosen<noise_reading>(noise, noise_names);
        settings.noise.T = noise_texels > 0 ? std::optional(noise_texels) : std::nullopt;
        settings.noise.background = chosen<background_noise>(background, background_names);
        auto const has_texels = settings.correspondence.kind == correspondence_kind::texel_grid;
        settings.average = !average.empty() ? chosen<texel_average>(average, average_names)
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

    canonical_coordinates coordinates() const { return chosen<canonical_coordinates>(canonical, canonical_names); }

private:
    template <class Kind>
    static Kind chosen(std::string const& name, auto const& names) {
        return static_cast<Kind>(std::find(names.begin(), names.end(), name) - names.begin());
    }

    static void require(bool holds, char const* option, char const* text) {
        if (!holds) {
            throw CLI::ValidationError(option, text);
        }
    }
};

} // namespace genrender::examples
