// SPDX-License-Identifier: MIT
// What is compared on what: rows, scenes, captions, seeds, frames and steps of each table.
#pragma once

#include "caption.hpp"
#include "evaluation_scene.hpp"
#include "measures.hpp"
#include "methods.hpp"

#include <genrender/core/error.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace genrender::examples {

/// How scenes and captions make runs.
enum class pairing {
    all,  ///< every caption on every scene
    each, ///< caption k on scene k, beginning again with the first scene
};

/// One table's worth of runs.
struct study {
    std::string name;                ///< of its files
    std::string title;               ///< of its tables
    std::vector<std::string> groups; ///< of rows
    std::vector<std::string> rows{}; ///< further rows by their names, first
    scene_set set = scene_set::held_out;
    pairing pairs = pairing::all;
    std::vector<std::string> scenes{}; ///< empty: all of the set
    std::size_t captions = 4;
    std::size_t seeds = 1;
    std::size_t frames = 16;
    std::size_t steps = 20;
    std::span<std::size_t const> apart = intervals; ///< what errors are measured at
    std::size_t map_pixels = 4;                     ///< of the maps, along a side of a pixel of the images
    bool is_alone = false; ///< one run at a time on all threads, so that its memory can be told
};

/// What the paper calls tables 1 and 2, on both presets.
inline study methods_study() { return {"methods", "Methods", {"method"}}; }
/// What each part of both presets is for.
inline study ablations_study() {
    return {"ablations", "Ablations", {"ablation"}, {"paper", "vivid"}, scene_set::held_out, pairing::each};
}

/// 96 runs of methods and 40 of ablations.
inline std::vector<study> usual_studies() { return {methods_study(), ablations_study()}; }

/// A look in a few minutes, no evidence: a caption a scene, few frames and steps.
inline std::vector<study> quick_studies() {
    auto methods = methods_study();
    methods.pairs = pairing::each;
    methods.captions = 3;
    methods.frames = 8;
    methods.steps = 10;
    return {methods};
}

/// Everything, in hours: three seeds, every ablation and noise on all scenes, more frames and more steps once.
inline std::vector<study> full_studies() {
    auto methods = methods_study();
    methods.seeds = 3;
    auto ablations = ablations_study();
    ablations.pairs = pairing::all;
    study noise{"noise",
                "Noise",
                {"noise"},
                {"Per-Frame, independent noise", "Per-Frame, UV noise", "vivid"},
                scene_set::held_out,
                pairing::each};
    study texels{"texels", "Texels", {"texels"}, {"vivid"}, scene_set::held_out, pairing::each};
    study frames{"frames_48", "48 frames", {"method"}, {}, scene_set::held_out, pairing::each};
    frames.captions = 3;
    frames.frames = 48;
    study steps{"steps_50", "50 steps", {"method"}, {}, scene_set::held_out, pairing::each};
    steps.captions = 3;
    steps.steps = 50;
    return {methods, ablations, noise, texels, frames, steps};
}

/// What settings are chosen by.
inline std::vector<study> development_studies() {
    study variants{
        "development",
        "Variants of vivid on the development scenes",
        {"development"},
        {"Per-Frame, UV noise", "TokenFlow*, fixed noise", "TokenFlow*, UV noise", "paper", "plain", "vivid"},
        scene_set::development};
    return {variants};
}

/// 240 frames of one scene, and a quarter of them, so that memory can be seen to grow or not.
inline std::vector<study> long_studies() {
    study frames{"long", "A long sequence", {}, {"Per-Frame, UV noise", "TokenFlow*, fixed noise", "vivid"}};
    frames.scenes = {"walking_figure"};
    frames.captions = 1;
    frames.frames = 240;
    frames.apart = long_intervals;
    frames.map_pixels = 2; // 18 bytes a pixel of maps and frame
    frames.is_alone = true;
    auto quarter = frames;
    quarter.name = "long_quarter";
    quarter.title = "A quarter of the long sequence";
    quarter.rows = {"vivid"};
    quarter.frames = 60;
    return {quarter, frames};
}

/// One animation to make and measure, by the numbers of what it is made of.
struct planned_run {
    std::size_t scene;
    std::size_t caption;
    std::uint64_t seed;
    std::size_t row; ///< of the study's rows; their number stands for the painted render
};

/// The scenes of a study.
inline std::vector<std::string> scenes_of(study const& of) {
    return of.scenes.empty() ? scene_names(of.set) : of.scenes;
}

/// The rows of a study: those that are named, then those of the groups. Throws value_error for a name that no row has.
inline std::vector<compared_row> rows_of(study const& of) {
    auto const all = compared_rows();
    std::vector<compared_row> rows;
    for (auto const& name : of.rows) {
        auto const row = std::find_if(all.begin(), all.end(), [&](auto const& each) { return each.name == name; });
        require_value(row != all.end(), "evaluate", "row", name, "a name of compared_rows in methods.hpp");
        rows.push_back(*row);
    }
    for (auto const& row : rows_of(of.groups)) {
        if (std::find(of.rows.begin(), of.rows.end(), row.name) == of.rows.end()) {
            rows.push_back(row);
        }
    }
    return rows;
}

/// All runs of a study, scene by scene, that of the painted render first.
inline std::vector<planned_run> runs_of(study const& of) {
    auto const scenes = scenes_of(of).size();
    auto const rows = rows_of(of).size();
    std::vector<planned_run> runs;
    for (std::size_t scene = 0; scene < scenes; ++scene) {
        for (std::size_t caption = 0; caption < of.captions; ++caption) {
            if (of.pairs == pairing::each && caption % scenes != scene) {
                continue;
            }
            for (std::uint64_t seed = 0; seed < of.seeds; ++seed) {
                runs.push_back({scene, caption, seed, rows});
                for (std::size_t row = 0; row < rows; ++row) {
                    runs.push_back({scene, caption, seed, row});
                }
            }
        }
    }
    return runs;
}

} // namespace genrender::examples
