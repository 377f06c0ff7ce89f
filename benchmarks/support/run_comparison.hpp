// SPDX-License-Identifier: MIT
// Two runs of the benchmarks side by side: which rows changed by more than the noise of both.
#pragma once

#include <benchmarks/support/benchmark_results.hpp>
#include <benchmarks/support/table_text.hpp>

#include <genrender/core/error.hpp>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace genrender::benchmarks {

/// A run as the table's JSON tells it.
struct earlier_run {
    nlohmann::json machine;
    std::string filter;                    ///< that its rows match, else empty
    std::vector<measurement> measurements; ///< without their counters
};

/// What became of a row from one run to another.
enum class change { faster, slower, within_noise, not_judged, before_only, after_only };

/// A row of both runs, or of one.
struct compared_row {
    std::string name;
    change is = change::not_judged;
    double ratio = 0;            ///< time after over time before, of a row of both
    std::optional<double> noise; ///< the least change that counts, as a share of the faster time
};

/// Changes below this share are never told from noise: repetitions of one program agree better with each other than
/// with those of another start.
inline constexpr double least_change = 0.02;

/// The run in a file benchmarks.json. Throws file_error if it is no such file.
inline earlier_run read_run(std::filesystem::path const& file) {
    auto const json = detail::read_json(file);
    earlier_run run;
    run.machine = detail::field<nlohmann::json>(file, json, "machine");
    run.filter = json.contains("filter") ? detail::field<std::string>(file, json, "filter") : "";
    for (auto const& entry : detail::array_of(file, detail::field<nlohmann::json>(file, json, "cases"), "cases")) {
        measurement of;
        of.name = detail::field<std::string>(file, entry, "name");
        if (entry.contains("failure")) {
            of.failure = detail::field<std::string>(file, entry, "failure");
        } else {
            of.seconds = detail::field<double>(file, entry, "seconds");
            if (!(of.seconds > 0)) {
                throw file_error(file.string() + ": seconds of '" + of.name + "' is " + std::to_string(of.seconds) +
                                 ", expected more than 0");
            }
            of.repetitions = detail::field<std::size_t>(file, entry, "repetitions");
            if (entry.contains("noise")) {
                of.noise = detail::field<double>(file, entry, "noise");
            }
        }
        run.measurements.push_back(std::move(of));
    }
    return run;
}

/// A row that is in both runs. A change counts from three standard deviations on, each 1.4826 median deviations, those
/// of both runs together, and from least_change on; without repetitions, or if one of both failed, it is not judged.
inline compared_row compare(measurement const& before, measurement const& after) {
    compared_row row{after.name, change::not_judged, 0, std::nullopt};
    if (!before.failure.empty() || !after.failure.empty()) {
        return row;
    }
    row.ratio = after.seconds / before.seconds;
    if (before.noise && after.noise) {
        row.noise = std::max(least_change, 3 * 1.4826 * std::hypot(*before.noise, *after.noise));
        auto const is_noise = std::max(row.ratio, 1 / row.ratio) <= 1 + *row.noise;
        row.is = is_noise ? change::within_noise : row.ratio < 1 ? change::faster : change::slower;
    }
    return row;
}

/// All rows in the order of the later run, then those that only the earlier one has.
inline std::vector<compared_row> compare(earlier_run const& before, earlier_run const& after) {
    auto const find = [](earlier_run const& in, std::string const& name) {
        return std::find_if(in.measurements.begin(), in.measurements.end(),
                            [&](measurement const& of) { return of.name == name; });
    };
    std::vector<compared_row> rows;
    for (auto const& of : after.measurements) {
        auto const earlier = find(before, of.name);
        rows.push_back(earlier == before.measurements.end() ? compared_row{of.name, change::after_only, 0, {}}
                                                            : compare(*earlier, of));
    }
    for (auto const& of : before.measurements) {
        if (find(after, of.name) == after.measurements.end()) {
            rows.push_back({of.name, change::before_only, 0, {}});
        }
    }
    return rows;
}

namespace detail {

inline std::string change_text(change is) {
    switch (is) {
    case change::faster:
        return "faster";
    case change::slower:
        return "slower";
    case change::within_noise:
        return "within noise";
    case change::not_judged:
        return "not judged";
    case change::before_only:
        return "only before";
    case change::after_only:
        return "only after";
    }
    return "";
}

} // namespace detail

/// The comparison in Markdown: a row a case, how many of each kind there are, and what else differs between the runs.
inline std::string comparison_table(earlier_run const& before, earlier_run const& after) {
    std::string text = "| kernel | shape | time after / before | noise | verdict |\n|---|---|---|---|---|\n";
    std::array<std::size_t, 6> counts{};
    for (auto const& row : compare(before, after)) {
        ++counts[static_cast<std::size_t>(row.is)];
        if (row.is == change::before_only && !after.filter.empty()) {
            continue;
        }
        measurement of;
        of.name = row.name;
        text += "| " + detail::words(of.kernel()) + " | " + (of.shape().empty() ? "-" : detail::words(of.shape())) +
                " | " + (row.ratio > 0 ? detail::three_digits(row.ratio) : "-") + " | " +
                (row.noise ? detail::percent_text(*row.noise) : "-") + " | " + detail::change_text(row.is) + " |\n";
    }
    std::string sum;
    for (std::size_t kind = 0; kind < counts.size(); ++kind) {
        if (counts[kind] > 0) {
            sum += (sum.empty() ? "" : ", ") + std::to_string(counts[kind]) + " " +
                   detail::change_text(static_cast<change>(kind));
        }
    }
    text += "\nA ratio below 1 is faster. A change counts if it is more than the noise: three standard deviations of "
            "both runs' repetitions, at least " +
            detail::percent_text(least_change) + ". A row without repetitions, or that failed, is not judged.\n\n" +
            (sum.empty() ? "no row" : sum) + ".\n";
    if (!after.filter.empty()) {
        text += "- The later run has only rows that match '" + after.filter + "'.\n";
    }
    for (auto const& [fact, value] : after.machine.items()) {
        auto const earlier = before.machine.contains(fact) ? before.machine[fact].dump() : "not told";
        if (earlier != value.dump()) {
            text += "- " + detail::words(fact) + ": before " + earlier + ", after " + value.dump() + "\n";
        }
    }
    return text;
}

} // namespace genrender::benchmarks
