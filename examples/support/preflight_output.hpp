// SPDX-License-Identifier: MIT
// The pre-flight report as files: text, JSON and a picture.
#pragma once

#include "output_file.hpp"
#include "pictures.hpp"
#include "preflight_picture.hpp"
#include "preflight_text.hpp"

#include <genrender/inspection/preflight.hpp>

#include <nlohmann/json.hpp>

#include <cstddef>
#include <filesystem>
#include <optional>
#include <utility>
#include <vector>

namespace genrender::examples {

/// The report as JSON; what could not be measured is null. `advice(recommendation)` is its sentence.
template <class Advice>
nlohmann::ordered_json preflight_json(preflight_report const& report, Advice const& advice) {
    using json = nlohmann::ordered_json;
    auto const measured = [](std::optional<double> value) { return value ? json(*value) : json(nullptr); };
    auto const share = [](std::size_t part, std::size_t whole) {
        return whole > 0 ? json(share_of(part, whole)) : json(nullptr);
    };
    auto const numbers = [](auto const& indices) {
        auto list = json::array();
        for (auto const index : indices) {
            list.push_back(index.value);
        }
        return list;
    };
    auto const& maps = report.maps;
    json result;
    result["allows_run"] = report.allows_run();
    result["frames"] = maps.frames.size();
    result["map_size"] = {maps.grid.height, maps.grid.width};
    result["dimensions"] = maps.dimensions;
    result["map_bytes"] = report.map_bytes;
    result["seconds"] = {{"maps", report.map_seconds}, {"grids", report.grid_seconds}};
    result["recommendations"] = json::array();
    for (auto const& one : report.recommendations) {
        json entry{{"kind", one.name()}, {"figure", one.figure}};
        if (one.object) {
            entry["object"] = one.object->value;
        }
        if (one.grid) {
            entry["grid"] = {one.grid->height, one.grid->width};
        }
        if (!one.frames.empty()) {
            entry["frames"] = numbers(one.frames);
        }
        entry["forbids_run"] = one.forbids_run();
        entry["sentence"] = advice(one);
        result["recommendations"].push_back(std::move(entry));
    }
    result["keyframes"] = json::array();
    for (std::size_t k = 0; k < report.steps.size(); ++k) {
        result["keyframes"].push_back({{"step", report.steps[k]}, {"frames", numbers(report.keyframes[k])}});
    }
    result["grids"] = json::array();
    for (auto const& grid : report.grids) {
        result["grids"].push_back({{"grid", {grid.grid.height, grid.grid.width}},
                                   {"refusal", grid.refusal ? json(*grid.refusal) : json(nullptr)},
                                   {"hit_rate", measured(grid.hit_rate())},
                                   {"collisions", measured(grid.collisions())},
                                   {"error_pixels", measured(grid.error())},
                                   {"coverage", measured(grid.coverage())},
                                   {"partners", grid.seen}});
    }
    result["objects"] = json::array();
    for (auto const& object : maps.objects) {
        auto levels = json::array();
        for (auto const& one : object.levels) {
            levels.push_back({{"samples", one.samples},
                              {"distinct", one.distinct},
                              {"eight_bit", one.is_eight_bit},
                              {"quantised", one.is_quantised()},
                              {"quantum", measured(one.quantum)},
                              {"pixels_a_value", one.quantum_in_pixels},
                              {"levels_in_sixteenths", one.histogram}});
        }
        result["objects"].push_back({{"object", object.object.value},
                                     {"pixels", object.pixels},
                                     {"frames", numbers(object.frames)},
                                     {"range", object.range},
                                     {"not_finite", object.not_finite},
                                     {"out_of_range", share(object.out_of_range, object.pixels)},
                                     {"tiled", share(object.tiled, object.pixels)},
                                     {"overlapping", share(object.overlapping, object.asked)},
                                     {"mirrored", share(object.mirrored, object.asked)},
                                     {"seams", share(object.seams, object.pairs)},
                                     {"blended_edges", share(object.blended_edges, object.edges)},
                                     {"without_footprint", share(object.without_footprint, object.looked_at)},
                                     {"footprint_side", object.side},
                                     {"levels", std::move(levels)}});
    }
    result["frame_contents"] = json::array();
    for (auto const& frame : maps.frames) {
        result["frame_contents"].push_back({{"background", share(frame.pixels - frame.covered, frame.pixels)},
                                            {"objects", numbers(frame.objects)},
                                            {"same_as_previous", frame.same_as_previous}});
    }
    return result;
}

/// Looks at maps before a run and writes preflight.txt, preflight.json and preflight.png into `folder`. `advice` is
/// what stands for a recommendation in text and JSON: its sentence, or the program's. Throws file_error if a file
/// cannot be written.
template <canonical_maps Maps, class Real, class Advice>
preflight_report write_preflight(std::filesystem::path const& folder, Maps const& maps,
                                 std::vector<grid_extents> const& grids, render_settings<Real> const& settings,
                                 any_loop const& loop, Advice const& advice) {
    auto report = preflight(maps, grids, settings, loop);
    write_text(folder / "preflight.txt", text_of(report, advice));
    write_text(folder / "preflight.json", preflight_json(report, advice).dump(2) + "\n");
    write_png(folder / "preflight.png", preflight_picture(maps, report));
    return report;
}

/// The same with the sentences alone.
template <canonical_maps Maps, class Real>
preflight_report write_preflight(std::filesystem::path const& folder, Maps const& maps,
                                 std::vector<grid_extents> const& grids, render_settings<Real> const& settings,
                                 any_loop const& loop) {
    return write_preflight(folder, maps, grids, settings, loop, sentence_of);
}

} // namespace genrender::examples
