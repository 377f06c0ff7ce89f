// SPDX-License-Identifier: MIT
// What a run of all benchmarks left behind: files of Google Benchmark, times of the peers, and the targets.
#pragma once

#include <benchmarks/support/median.hpp>

#include <genrender/core/error.hpp>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <regex>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace genrender::benchmarks {

/// One case of a benchmark: medians over its repetitions.
struct measurement {
    std::string name;                       ///< kernel and shape, `mix/tokens:64/channels:320`
    double seconds = 0;                     ///< by the clock on the wall
    std::size_t repetitions = 0;            ///< that the medians are of
    std::map<std::string, double> counters; ///< bytes_per_second, FLOP/s, share_of_floor, ...
    std::string label;                      ///< the floor, where there is a share of it
    std::string failure;                    ///< what the benchmark says if it could not run, else empty
    std::optional<double> noise;            ///< deviation of the repetitions' seconds, as a share; none of one alone

    std::string kernel() const { return name.substr(0, name.find('/')); }
    std::string shape() const { return name.substr(std::min(name.find('/'), name.size() - 1) + 1); }

    std::optional<double> counter(std::string const& which) const {
        auto const found = counters.find(which);
        return found == counters.end() ? std::nullopt : std::optional(found->second);
    }
};

/// Someone else's time for a case.
struct peer_time {
    std::string name; ///< that of the measurement
    std::string peer; ///< say PyTorch 2.1
    double seconds = 0;
};

/// What a case must reach.
struct target {
    std::regex cases;    ///< names of the measurements it holds for
    std::string says;    ///< the target in words
    std::string measure; ///< a counter, `seconds`, `ratio_to_peer` or `ratio_to_case`: their time over ours
    std::regex peer;     ///< which peer
    std::string beside;  ///< which case; $1 is the first group of `cases`
    double limit = 0;
    bool is_least = true; ///< whether the limit is the least value or the greatest
};

/// A cache of the processor.
struct cache {
    std::string name; ///< L1 Data, L2
    double bytes = 0;
};

/// The machine when the first program of a run began, as Google Benchmark found it.
struct run_start {
    std::string date;           ///< 2026-11-27T17:31:10+00:00
    std::optional<double> load; ///< programs that ran in the minute before, on average
    std::vector<cache> caches;  ///< from the nearest on
};

/// All of a run.
struct results {
    std::vector<measurement> measurements;      ///< in the order of the files and of their cases
    std::optional<run_start> began;             ///< none if no file tells
    std::vector<peer_time> peers;               ///< in the order of the files
    std::map<std::string, std::string> missing; ///< peers that did not run, and why
};

namespace detail {

/// Throws file_error unless the file is JSON.
inline nlohmann::json read_json(std::filesystem::path const& file) {
    std::ifstream stream(file);
    if (!stream) {
        throw file_error(file.string() + ": cannot be read, expected a file of JSON");
    }
    auto json = nlohmann::json::parse(stream, nullptr, false);
    if (json.is_discarded()) {
        throw file_error(file.string() + ": is no JSON, expected a whole file of it");
    }
    return json;
}

/// A field of an entry. Throws file_error that names the file and the field if it is missing or of another type.
template <class Value>
Value field(std::filesystem::path const& file, nlohmann::json const& entry, char const* name) {
    try {
        return entry.at(name).get<Value>();
    } catch (nlohmann::json::exception const&) {
        throw file_error(file.string() + ": an entry has no fit '" + name + "', expected one in " +
                         entry.dump().substr(0, 100));
    }
}

/// An array at the top, or under a name. Throws file_error if there is none.
inline nlohmann::json array_of(std::filesystem::path const& file, nlohmann::json const& json, char const* what) {
    if (!json.is_array()) {
        throw file_error(file.string() + ": holds no list, expected a list of " + what);
    }
    return json;
}

/// The name without what only says how time was taken: manual_time, iterations:1 and their like at the end.
inline std::string case_name(std::string const& name) {
    static std::regex const how("(/(manual_time|real_time|process_time|(iterations|repeats|min_time):[0-9.]+))+$");
    return std::regex_replace(name, how, "");
}

inline double seconds_in(std::filesystem::path const& file, std::string const& unit) {
    static std::map<std::string, double> const units{{"ns", 1e-9}, {"us", 1e-6}, {"ms", 1e-3}, {"s", 1}};
    auto const found = units.find(unit);
    if (found == units.end()) {
        throw file_error(file.string() + ": time_unit is '" + unit + "', expected ns, us, ms or s");
    }
    return found->second;
}

/// Fields of Google Benchmark that are numbers and no counters.
inline bool is_counter(std::string const& field, nlohmann::json const& value) {
    static std::set<std::string> const own{"family_index", "per_family_instance_index",
                                           "repetitions",  "repetition_index",
                                           "threads",      "iterations",
                                           "real_time",    "cpu_time"};
    return value.is_number() && !own.contains(field);
}

} // namespace detail

/// The cases in a file that a program wrote for --benchmark_out. Throws file_error if it is no such file.
inline std::vector<measurement> read_measurements(std::filesystem::path const& file) {
    struct repetitions_of_case {
        measurement of;
        std::vector<double> seconds;
        std::map<std::string, std::vector<double>> counters;
    };
    std::vector<repetitions_of_case> cases;
    auto const json = detail::read_json(file);
    auto const entries = json.is_object() && json.contains("benchmarks") ? json["benchmarks"] : nlohmann::json();
    for (auto const& entry : detail::array_of(file, entries, "benchmarks")) {
        // Means and deviations of a case are of no use here.
        if (detail::field<std::string>(file, entry, "run_type") != "iteration") {
            continue;
        }
        auto const name = detail::case_name(detail::field<std::string>(file, entry, "run_name"));
        auto found = std::find_if(cases.begin(), cases.end(), [&](auto const& c) { return c.of.name == name; });
        if (found == cases.end()) {
            found = cases.emplace(cases.end());
            found->of.name = name;
        }
        found->of.label = entry.value("label", "");
        if (entry.value("error_occurred", false)) {
            found->of.failure = entry.value("error_message", "no reason given");
            continue;
        }
        found->seconds.push_back(detail::field<double>(file, entry, "real_time") *
                                 detail::seconds_in(file, detail::field<std::string>(file, entry, "time_unit")));
        for (auto const& [counter, value] : entry.items()) {
            if (detail::is_counter(counter, value)) {
                found->counters[counter].push_back(value.get<double>());
            }
        }
    }
    std::vector<measurement> measurements;
    for (auto& [of, seconds, counters] : cases) {
        if (of.failure.empty()) {
            of.repetitions = seconds.size();
            of.seconds = median(seconds);
            if (of.repetitions > 1 && of.seconds > 0) {
                of.noise = median_deviation(std::move(seconds)) / of.seconds;
            }
            for (auto& [counter, values] : counters) {
                of.counters[counter] = median(std::move(values));
            }
        }
        measurements.push_back(std::move(of));
    }
    return measurements;
}

/// What a file of --benchmark_out says of the run's beginning; nothing if its context has no date.
inline std::optional<run_start> read_run_start(std::filesystem::path const& file) {
    auto const json = detail::read_json(file);
    auto const context = json.is_object() ? json.value("context", nlohmann::json::object()) : nlohmann::json();
    if (!context.is_object() || !context.contains("date")) {
        return std::nullopt;
    }
    run_start start;
    start.date = detail::field<std::string>(file, context, "date");
    if (auto const load = context.value("load_avg", std::vector<double>()); !load.empty()) {
        start.load = load.front();
    }
    for (auto const& entry : context.value("caches", nlohmann::json::array())) {
        auto const level = detail::field<int>(file, entry, "level");
        auto const type = detail::field<std::string>(file, entry, "type");
        start.caches.push_back({"L" + std::to_string(level) + (type == "Unified" ? "" : " " + type),
                                detail::field<double>(file, entry, "size")});
    }
    return start;
}

/// The targets in a file: a list of {"says": <words>, "cases": <regular expression>, "measure": <counter,
/// seconds, ratio_to_peer or ratio_to_case>, "at_least" or "at_most": <number>}. With "peer", a regular expression, a ratio is
/// to such peers alone; a ratio_to_case is to "case", in which $1 is the first group of "cases". Throws file_error if
/// it is no such file.
inline std::vector<target> read_targets(std::filesystem::path const& file) {
    std::vector<target> targets;
    for (auto const& entry : detail::array_of(file, detail::read_json(file), "targets")) {
        target t;
        t.says = detail::field<std::string>(file, entry, "says");
        t.measure = detail::field<std::string>(file, entry, "measure");
        t.is_least = entry.contains("at_least");
        t.limit = detail::field<double>(file, entry, t.is_least ? "at_least" : "at_most");
        if (t.measure == "ratio_to_case") {
            t.beside = detail::field<std::string>(file, entry, "case");
        }
        auto const cases = detail::field<std::string>(file, entry, "cases");
        try {
            t.cases = cases;
            t.peer = entry.value("peer", "");
        } catch (std::regex_error const&) {
            throw file_error(file.string() + ": '" + t.says + "' has cases '" + cases +
                             "', expected regular expressions");
        }
        targets.push_back(std::move(t));
    }
    return targets;
}

/// Everything in a folder: <program>.json of the benchmarks, and peers/<script>.json, each a list of peer_time or
/// {"missing": <why>}. Throws file_error if the folder holds no measurement or a file is not what it should be.
inline results read_results(std::filesystem::path const& folder) {
    auto const files_in = [](std::filesystem::path const& place) {
        std::set<std::filesystem::path> files;
        std::error_code none;
        for (auto const& entry : std::filesystem::directory_iterator(place, none)) {
            if (entry.path().extension() == ".json") {
                files.insert(entry.path());
            }
        }
        return files;
    };
    results all;
    for (auto const& file : files_in(folder)) {
        auto measurements = read_measurements(file);
        std::move(measurements.begin(), measurements.end(), std::back_inserter(all.measurements));
        auto start = read_run_start(file);
        if (start && (!all.began || start->date < all.began->date)) {
            all.began = std::move(start);
        }
    }
    if (all.measurements.empty()) {
        throw file_error(folder.string() + ": holds no measurement, expected files of --benchmark_out");
    }
    for (auto const& file : files_in(folder / "peers")) {
        auto const json = detail::read_json(file);
        if (json.is_object() && json.contains("missing")) {
            all.missing[file.stem().string()] = detail::field<std::string>(file, json, "missing");
            continue;
        }
        for (auto const& entry : detail::array_of(file, json, "peers' times")) {
            auto const seconds = detail::field<double>(file, entry, "seconds");
            if (!(seconds > 0)) {
                throw file_error(file.string() + ": seconds is " + std::to_string(seconds) + ", expected more than 0");
            }
            all.peers.push_back({detail::case_name(detail::field<std::string>(file, entry, "name")),
                                 detail::field<std::string>(file, entry, "peer"), seconds});
        }
    }
    return all;
}

} // namespace genrender::benchmarks
