// SPDX-License-Identifier: MIT
// The tables of a study: which measures stand in which, and the paper's own beside them.
#pragma once

#include "measures.hpp"
#include "paper_figures.hpp"
#include "results.hpp"
#include "studies.hpp"

#include <algorithm>
#include <cstddef>
#include <span>
#include <sstream>
#include <string>
#include <vector>

namespace genrender::examples {

/// Columns of a measure at several intervals: the first heading has the name, the others the interval alone.
inline void add_intervals(std::vector<table_column>& columns, std::string const& measure, std::string const& name,
                          std::span<std::size_t const> apart) {
    auto is_first = true;
    for (auto const interval : apart) {
        auto const number = std::to_string(interval);
        columns.push_back({measure + "_" + number, is_first ? name + " " + number : number});
        is_first = false;
    }
}

/// Frame consistency against the interval, for the plot: measured, its standard error and the paper's figure.
inline std::string consistency_csv(std::span<run_figures const> runs) {
    std::ostringstream text;
    text << "method,interval,measured,standard_error,paper\n";
    for (auto const& row : paper_rows) {
        for (std::size_t k = 0; k < intervals.size(); ++k) {
            auto const figure = figure_of(runs, std::string(row.method), "consistency_" + std::to_string(intervals[k]));
            text << row.name << ',' << intervals[k] << ',' << (figure ? detail::decimal(figure->mean, 6) : "") << ','
                 << (figure && figure->error ? detail::decimal(*figure->error, 6) : "") << ','
                 << (row.fidelity ? detail::decimal(row.consistency[k]) : "") << '\n';
        }
    }
    return text.str();
}

/// The paper's tables 1 and 2 with what was measured beside what it reports.
inline std::string paper_tables(std::span<run_figures const> runs) {
    std::ostringstream text;
    auto const figure = [&](paper_row const& row, std::string const& measure) {
        return " " + figure_text(figure_of(runs, std::string(row.method), measure)) + " |";
    };
    auto const quoted = [](bool is_quoted, double value) {
        return " " + (is_quoted ? detail::decimal(value) : std::string("-")) + " |";
    };
    text << "| Method | Frame consistency | paper | Prompt fidelity | paper |\n|---|---|---|---|---|\n";
    for (auto const& row : paper_rows) {
        text << "| " << row.name << " |" << figure(row, "consistency_1")
             << quoted(row.fidelity.has_value(), row.consistency[0]) << figure(row, "fidelity")
             << quoted(row.fidelity.has_value(), row.fidelity.value_or(0)) << '\n';
    }
    text << "\n| Frame consistency at interval |";
    std::string rule = "\n|---|";
    std::vector<std::size_t> measured;
    for (std::size_t k = 0; k < intervals.size(); ++k) {
        if (has_measure(runs, "consistency_" + std::to_string(intervals[k]))) {
            measured.push_back(k);
            text << ' ' << intervals[k] << " | paper |";
            rule += "---|---|";
        }
    }
    text << rule << '\n';
    for (auto const& row : paper_rows) {
        text << "| " << row.name << " |";
        for (auto const k : measured) {
            text << figure(row, "consistency_" + std::to_string(intervals[k]))
                 << quoted(row.fidelity.has_value(), row.consistency[k]);
        }
        text << '\n';
    }
    return text.str();
}

/// All tables of a study, each with a head of its own. Columns that no run has figures for are left out.
inline std::string study_tables(study const& of, std::span<run_figures const> runs) {
    auto const rows = detail::methods_in_order(runs);
    std::vector<table_column> errors, looks, embedded, flickers, pairs;
    add_intervals(errors, "error", "RMSE", of.apart);
    for (std::size_t const interval : {1U, 10U, 100U}) {
        if (std::find(of.apart.begin(), of.apart.end(), interval) != of.apart.end()) {
            auto const number = std::to_string(interval);
            errors.push_back({"relative_error_" + number, "RMSE " + number + " / contrast"});
        }
    }
    looks = {{"contrast", "Contrast"},
             {"sharpness", "Sharpness"},
             {"fidelity", "Fidelity"},
             {"pattern_recognised", "Pattern"},
             {"colours_recognised", "Colours"}};
    add_intervals(embedded, "perceptual_error", "Perceptual error", of.apart);
    add_intervals(embedded, "consistency", "Consistency", of.apart);
    embedded.push_back({"subject_consistency", "Subject consistency"});
    flickers = {{"background_flicker", "Background"},
                {"open_background_flicker", "Away from objects"},
                {"colour_flicker", "Mean colour"},
                {"deviation_flicker", "Colour deviation"},
                {"temporal_flicker", "Temporal flicker"}};
    add_intervals(flickers, "sticking", "Sticking", of.apart);
    add_intervals(pairs, "pairs", "Pairs", of.apart);
    add_intervals(pairs, "moving_pairs", "Moving pairs", of.apart);
    std::vector<table_column> const differences{{"error_1", "RMSE 1"},
                                                {"error_5", "RMSE 5"},
                                                {"error_10", "RMSE 10"},
                                                {"relative_error_10", "RMSE 10 / contrast"},
                                                {"perceptual_error_10", "Perceptual 10"},
                                                {"consistency_1", "Consistency 1"},
                                                {"consistency_10", "Consistency 10"},
                                                {"fidelity", "Fidelity"},
                                                {"pattern_recognised", "Pattern"},
                                                {"contrast", "Contrast"},
                                                {"sharpness", "Sharpness"},
                                                {"background_flicker", "Background flicker"},
                                                {"open_background_flicker", "Away from objects"}};
    std::ostringstream text;
    auto const scenes = scenes_of(of);
    text << "# " << of.title << "\n\n"
         << (of.set == scene_set::development ? "Development scenes " : "Held-out scenes ");
    for (auto const& scene : scenes) {
        text << (&scene == &scenes.front() ? "" : ", ") << scene;
    }
    text << "; " << runs.size() / std::max<std::size_t>(1, rows.size()) << " runs a row, " << of.frames << " frames, "
         << of.steps << " steps; mean ± standard error over runs.\n";
    auto const section = [&](char const* title, std::string const& table) {
        text << "\n## " << title << "\n\n" << table;
    };
    if (of.set == scene_set::development) {
        section("Differences from vivid in thousandths", variant_table(runs, "vivid", measured(runs, differences)));
    } else if (of.name == methods_study().name) {
        section("Tables 1 and 2 of the paper", paper_tables(runs));
    }
    section("Error along surfaces", markdown_table(runs, rows, measured(runs, errors)));
    section("Pairs of pixels behind each error of a run", scene_table(runs, measured(runs, pairs)));
    section("What pictures look like", markdown_table(runs, rows, measured(runs, looks)));
    section("By the embedder", markdown_table(runs, rows, measured(runs, embedded)));
    section("Flicker and sticking", markdown_table(runs, rows, measured(runs, flickers)));
    section("Cost", markdown_table(runs, rows,
                                   measured(runs, std::vector<table_column>{{"seconds_a_frame", "Seconds a frame"},
                                                                            {"megabytes", "Memory of the run, MB"},
                                                                            {"map_megabytes", "of maps, MB"}})));
    if (of.set == scene_set::held_out) {
        for (auto const* const preset : {"vivid", "paper"}) {
            if (std::find(rows.begin(), rows.end(), preset) != rows.end()) {
                section("Paired differences", difference_table(runs, preset, rows, measured(runs, differences)));
            }
        }
    }
    return text.str();
}

} // namespace genrender::examples
