// SPDX-License-Identifier: MIT
// The pre-flight report as text: recommendations first, then the tables of grids, objects and frames they rest on.
#pragma once

#include "recommendation_text.hpp"
#include "text_table.hpp"

#include <genrender/inspection/preflight.hpp>

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace genrender::examples {

namespace detail {

/// A share as percents with one digit; `-` where nothing could be measured.
inline std::string share_text(std::optional<double> share) { return share ? fixed_text(100 * *share, 1) : "-"; }
inline std::string share_text(std::size_t part, std::size_t whole) {
    return whole > 0 ? share_text(share_of(part, whole)) : "-";
}
inline std::string extents_name(grid_extents grid) {
    return std::to_string(grid.height) + "x" + std::to_string(grid.width);
}

/// Format of the most coarsely stored coordinate.
inline std::string storage_text(object_check const& object) {
    std::string text = "float";
    double coarsest = 0;
    for (auto const& levels : object.levels) {
        if (levels.is_quantised() && levels.quantum_in_pixels > coarsest) {
            coarsest = levels.quantum_in_pixels;
            text = (levels.is_eight_bit ? "8 bit, " : "rounded, ") + fixed_text(coarsest, 1) + " px";
        }
    }
    return text;
}

inline std::string grids_text(preflight_report const& report) {
    std::vector<std::vector<std::string>> rows{
        {"grid", "map px", "hit rate %", "collisions %", "error px", "coverage %", "partners"}};
    for (auto const& check : report.grids) {
        if (check.refusal) {
            rows.push_back({extents_name(check.grid), "-", "refused"});
            continue;
        }
        rows.push_back({extents_name(check.grid), std::to_string(report.maps.grid.height / check.grid.height),
                        share_text(check.hit_rate()), share_text(check.collisions()),
                        check.error() ? fixed_text(*check.error(), 2) : "-", share_text(check.coverage()),
                        std::to_string(check.seen)});
    }
    return table_text(rows);
}

inline std::string objects_text(map_check const& maps) {
    std::vector<std::vector<std::string>> rows{{"object", "pixels", "frames", "lowest", "greatest", "outside %",
                                                "tiled %", "overlap %", "mirror %", "seams %", "blended %", "flat %",
                                                "not finite", "stored as"}};
    for (auto const& object : maps.objects) {
        std::string lowest;
        std::string greatest;
        for (auto const& range : object.range) {
            lowest.append(lowest.empty() ? "" : " ").append(fixed_text(range[0], 2));
            greatest.append(greatest.empty() ? "" : " ").append(fixed_text(range[1], 2));
        }
        rows.push_back({std::to_string(object.object.value), std::to_string(object.pixels),
                        std::to_string(object.frames.size()), lowest.empty() ? "-" : lowest,
                        greatest.empty() ? "-" : greatest,
                        maps.dimensions == 2 ? share_text(object.out_of_range, object.pixels) : "-",
                        maps.dimensions == 2 ? share_text(object.tiled, object.pixels) : "-",
                        share_text(object.overlapping, object.asked), share_text(object.mirrored, object.asked),
                        share_text(object.seams, object.pairs), share_text(object.blended_edges, object.edges),
                        share_text(object.without_footprint, object.looked_at), std::to_string(object.not_finite),
                        storage_text(object)});
    }
    return table_text(rows);
}

inline std::string frames_text(map_check const& maps) {
    std::vector<std::vector<std::string>> rows{{"frame", "background %", "objects", ""}};
    for (std::size_t i = 0; i < maps.frames.size(); ++i) {
        auto const& frame = maps.frames[i];
        rows.push_back({std::to_string(i), share_text(frame.pixels - frame.covered, frame.pixels),
                        std::to_string(frame.objects.size()),
                        frame.covered == 0       ? "nothing visible"
                        : frame.same_as_previous ? "as the frame before"
                                                 : ""});
    }
    return table_text(rows);
}

/// Levels a sixteenth of the range, of objects whose coordinates are rounded.
inline std::string levels_text(map_check const& maps) {
    std::string text;
    for (auto const& object : maps.objects) {
        for (std::size_t d = 0; d < object.levels.size(); ++d) {
            auto const& levels = object.levels[d];
            if (!levels.is_quantised()) {
                continue;
            }
            text += "  object " + std::to_string(object.object.value) + ", coordinate " + std::to_string(d) + ": " +
                    std::to_string(levels.distinct) + " levels in " + std::to_string(levels.samples) +
                    " pixels; in each sixteenth of the range:";
            for (auto const count : levels.histogram) {
                text.append(" ").append(std::to_string(count));
            }
            text += "\n";
        }
    }
    return text;
}

} // namespace detail

/// The whole report for a person to read. `advice(recommendation)` is what stands for one: its sentence, or one that
/// also says how the program's users follow it.
template <class Advice>
std::string text_of(preflight_report const& report, Advice const& advice) {
    auto const& maps = report.maps;
    auto text = std::to_string(maps.frames.size()) + " frames of " + detail::extents_name(maps.grid) + " pixels, " +
                std::to_string(maps.objects.size()) + " objects, " + std::to_string(maps.dimensions) +
                " canonical coordinates; " + fixed_text(static_cast<double>(report.map_bytes) / 1e6, 1) +
                " MB of maps\nlooked at for " + fixed_text(report.map_seconds, 1) + " s, at the grids for " +
                fixed_text(report.grid_seconds, 1) + " s\n\nRecommendations\n";
    for (auto const& one : report.recommendations) {
        text += (one.forbids_run() ? "  ! " : "  - ") + advice(one) + "\n";
    }
    text += report.recommendations.empty() ? "  none: these maps are as they should be\n" : "";
    if (!report.grids.empty()) {
        text += "\nFeature grids, by the keyframes of";
        for (std::size_t k = 0; k < report.steps.size(); ++k) {
            std::string frames;
            for (auto const keyframe : report.keyframes[k]) {
                frames += (frames.empty() ? "" : ", ") + std::to_string(keyframe.value);
            }
            text += std::string(k > 0 ? ";" : "") + " step " + std::to_string(report.steps[k]) + ": " + frames;
        }
        text += std::string(report.steps.empty() ? " no step" : "") + "\n" + detail::grids_text(report);
    }
    if (!maps.objects.empty()) {
        text += "\nObjects\n" + detail::objects_text(maps);
    }
    if (auto const levels = detail::levels_text(maps); !levels.empty()) {
        text += "\nLevels of rounded coordinates\n" + levels;
    }
    if (!maps.frames.empty()) {
        text += "\nFrames\n" + detail::frames_text(maps);
    }
    return text;
}

/// The same with the sentences alone.
inline std::string text_of(preflight_report const& report) { return text_of(report, sentence_of); }

} // namespace genrender::examples
