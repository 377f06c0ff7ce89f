// SPDX-License-Identifier: MIT
// The figures of all runs, and the tables that are made of them: CSV for programs, Markdown for people.
#pragma once

#include <genrender/evaluation/mean_and_error.hpp>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <iterator>
#include <map>
#include <optional>
#include <span>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

namespace genrender::examples {

/// Named figures of one run; a figure is left out where the scene gives none.
using measures = std::map<std::string, double>;

/// One run and what was measured of it.
struct run_figures {
    std::string method; ///< name and noise
    std::string group;  ///< render, method, noise, ablation, texels or development
    std::string scene;
    std::string prompt;
    std::uint64_t seed;
    measures figures;
};

/// A column of a table: a measure and its heading.
struct table_column {
    std::string measure;
    std::string heading;
};

namespace detail {

inline std::string decimal(double value, int digits = 4) {
    std::array<char, 32> text{};
    std::snprintf(text.data(), text.size(), "%.*f", digits, value);
    return text.data();
}

/// The methods in the order in which they first ran.
inline std::vector<std::string> methods_in_order(std::span<run_figures const> runs) {
    std::vector<std::string> methods;
    for (auto const& run : runs) {
        if (std::find(methods.begin(), methods.end(), run.method) == methods.end()) {
            methods.push_back(run.method);
        }
    }
    return methods;
}

/// The first two lines of a Markdown table.
inline std::string markdown_head(std::string const& first, std::span<table_column const> columns) {
    std::string names = "| " + first + " |";
    std::string rule = "|---|";
    for (auto const& column : columns) {
        names += " " + column.heading + " |";
        rule += "---|";
    }
    return names + "\n" + rule + "\n";
}

} // namespace detail

/// Whether any run has the measure.
inline bool has_measure(std::span<run_figures const> runs, std::string const& measure) {
    return std::any_of(runs.begin(), runs.end(), [&](auto const& run) { return run.figures.contains(measure); });
}

/// The columns that some run has a figure for.
inline std::vector<table_column> measured(std::span<run_figures const> runs, std::span<table_column const> columns) {
    std::vector<table_column> left;
    std::copy_if(columns.begin(), columns.end(), std::back_inserter(left),
                 [&](auto const& column) { return has_measure(runs, column.measure); });
    return left;
}

/// Mean and standard error of a measure over all runs of a method; none if no run has it.
inline std::optional<mean_and_error> figure_of(std::span<run_figures const> runs, std::string const& method,
                                               std::string const& measure) {
    std::vector<double> values;
    for (auto const& run : runs) {
        if (run.method == method && run.figures.contains(measure)) {
            values.push_back(run.figures.at(measure));
        }
    }
    return values.empty() ? std::nullopt : std::optional(mean_and_error_of(values));
}

/// Mean and standard error of the difference `method` minus `other` between runs of the same scene, prompt and seed;
/// none if they share none.
inline std::optional<mean_and_error> paired_difference(std::span<run_figures const> runs, std::string const& method,
                                                       std::string const& other, std::string const& measure) {
    std::vector<double> values;
    for (auto const& a : runs) {
        for (auto const& b : runs) {
            if (a.method == method && b.method == other && a.scene == b.scene && a.prompt == b.prompt &&
                a.seed == b.seed && a.figures.contains(measure) && b.figures.contains(measure)) {
                values.push_back(a.figures.at(measure) - b.figures.at(measure));
            }
        }
    }
    return values.empty() ? std::nullopt : std::optional(mean_and_error_of(values));
}

/// `0.1234 ± 0.0056`; `-` for none.
inline std::string figure_text(std::optional<mean_and_error> const& figure) {
    if (!figure) {
        return "-";
    }
    return detail::decimal(figure->mean) + (figure->error ? " ± " + detail::decimal(*figure->error) : "");
}

/// A Markdown table: the methods as rows, means and standard errors over their runs.
inline std::string markdown_table(std::span<run_figures const> runs, std::span<std::string const> methods,
                                  std::span<table_column const> columns) {
    std::ostringstream text;
    text << detail::markdown_head("Method", columns);
    for (auto const& method : methods) {
        text << "| " << method << " |";
        for (auto const& column : columns) {
            text << ' ' << figure_text(figure_of(runs, method, column.measure)) << " |";
        }
        text << '\n';
    }
    return text.str();
}

/// A Markdown table of `reference` against every other of the methods: paired differences, reference minus
/// method, so that their sign says which is greater.
inline std::string difference_table(std::span<run_figures const> runs, std::string const& reference,
                                    std::span<std::string const> methods, std::span<table_column const> columns) {
    std::ostringstream text;
    text << detail::markdown_head(reference + " minus", columns);
    for (auto const& method : methods) {
        if (method == reference) {
            continue;
        }
        text << "| " << method << " |";
        for (auto const& column : columns) {
            text << ' ' << figure_text(paired_difference(runs, reference, method, column.measure)) << " |";
        }
        text << '\n';
    }
    return text.str();
}

/// A Markdown table of variants of `base`: the base's own figures, and below them how much every other method has more
/// than it in runs of the same scene, prompt and seed, both in thousandths with their standard errors.
inline std::string variant_table(std::span<run_figures const> runs, std::string const& base,
                                 std::span<table_column const> columns) {
    auto const thousandths = [](std::optional<mean_and_error> const& figure, bool has_sign) {
        if (!figure) {
            return std::string("-");
        }
        auto text = detail::decimal(1000 * figure->mean, 1);
        text = has_sign && figure->mean > 0 ? "+" + text : text;
        return text + (figure->error ? " ± " + detail::decimal(1000 * *figure->error, 1) : "");
    };
    std::ostringstream text;
    text << detail::markdown_head("Variant", columns) << "| " << base << " itself |";
    for (auto const& column : columns) {
        text << ' ' << thousandths(figure_of(runs, base, column.measure), false) << " |";
    }
    text << '\n';
    for (auto const& method : detail::methods_in_order(runs)) {
        if (method == base) {
            continue;
        }
        text << "| " << method << " |";
        for (auto const& column : columns) {
            text << ' ' << thousandths(paired_difference(runs, method, base, column.measure), true) << " |";
        }
        text << '\n';
    }
    return text.str();
}

/// A Markdown table of what depends on the scene and not on the method: scenes as rows, the first run's figures.
inline std::string scene_table(std::span<run_figures const> runs, std::span<table_column const> columns) {
    std::ostringstream text;
    text << detail::markdown_head("Scene", columns);
    std::vector<std::string> done;
    for (auto const& run : runs) {
        if (std::find(done.begin(), done.end(), run.scene) != done.end()) {
            continue;
        }
        done.push_back(run.scene);
        text << "| " << run.scene << " |";
        for (auto const& column : columns) {
            auto const has = run.figures.contains(column.measure);
            text << ' ' << (has ? detail::decimal(run.figures.at(column.measure), 0) : "-") << " |";
        }
        text << '\n';
    }
    return text.str();
}

/// Every run on a line of its own, with all measures of any run as columns.
inline std::string runs_csv(std::span<run_figures const> runs) {
    std::map<std::string, bool> names;
    for (auto const& run : runs) {
        for (auto const& [name, figure] : run.figures) {
            names[name] = true;
        }
    }
    std::ostringstream text;
    text << "group,method,scene,prompt,seed";
    for (auto const& [name, present] : names) {
        text << ',' << name;
    }
    text << '\n';
    for (auto const& run : runs) {
        text << run.group << ",\"" << run.method << "\"," << run.scene << ",\"" << run.prompt << "\"," << run.seed;
        for (auto const& [name, present] : names) {
            text << ',' << (run.figures.contains(name) ? detail::decimal(run.figures.at(name), 6) : "");
        }
        text << '\n';
    }
    return text.str();
}

/// Mean and standard error of every measure of every method, one a line.
inline std::string means_csv(std::span<run_figures const> runs) {
    std::map<std::string, bool> names;
    std::vector<std::pair<std::string, std::string>> rows;
    for (auto const& run : runs) {
        for (auto const& [name, figure] : run.figures) {
            names[name] = true;
        }
        if (std::pair const row(run.group, run.method); std::find(rows.begin(), rows.end(), row) == rows.end()) {
            rows.push_back(row);
        }
    }
    std::ostringstream text;
    text << "group,method,measure,mean,standard_error,runs\n";
    for (auto const& [group, method] : rows) {
        for (auto const& [name, present] : names) {
            if (auto const figure = figure_of(runs, method, name)) {
                text << group << ",\"" << method << "\"," << name << ',' << detail::decimal(figure->mean, 6) << ','
                     << (figure->error ? detail::decimal(*figure->error, 6) : "") << ',' << figure->count << '\n';
            }
        }
    }
    return text.str();
}

} // namespace genrender::examples
