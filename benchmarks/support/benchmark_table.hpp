// SPDX-License-Identifier: MIT
// The results of a run judged by their targets and beside their peers: a table for people, JSON for programs.
#pragma once

#include <benchmarks/support/benchmark_results.hpp>
#include <benchmarks/support/machine.hpp>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <map>
#include <optional>
#include <regex>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace genrender::benchmarks {

/// A peer's time for a case beside ours.
struct comparison {
    std::string peer;
    double seconds = 0;
    double ratio = 0; ///< the peer's time over ours: above 1 we are faster
};

/// What became of a target in one case.
struct verdict {
    std::string measure;
    double value = 0;
    double limit = 0;
    bool is_least = true;

    bool is_met() const { return is_least ? value >= limit : value <= limit; }
};

/// One row of the table.
struct judged_case {
    measurement of;
    std::vector<comparison> peers;
    std::vector<verdict> verdicts;
};

/// All rows and what the foot of the table says.
struct judged_results {
    std::vector<judged_case> cases;
    std::map<std::string, std::string> missing; ///< peers that did not run, and why
    std::vector<std::string> unmatched;         ///< cases that only a peer ran
    std::vector<std::string> unmeasured;        ///< targets that no case tells anything about

    /// Number of verdicts that are met, or that are not.
    std::size_t count(bool met) const {
        std::size_t sum = 0;
        for (auto const& c : cases) {
            sum += static_cast<std::size_t>(
                std::count_if(c.verdicts.begin(), c.verdicts.end(), [&](auto const& v) { return v.is_met() == met; }));
        }
        return sum;
    }
};

namespace detail {

/// What becomes of a target in a case with its peers; nothing if it does not hold for it or its measure is unknown.
inline std::vector<verdict> verdicts_of(target const& target, judged_case const& c, results const& all) {
    std::vector<verdict> verdicts;
    auto const add = [&](std::string const& measure, double value) {
        verdicts.push_back({measure, value, target.limit, target.is_least});
    };
    std::smatch match;
    if (!std::regex_search(c.of.name, match, target.cases)) {
        return verdicts;
    }
    if (auto const value = c.of.counter(target.measure)) {
        add(target.measure, *value);
    } else if (target.measure == "ratio_to_peer") {
        for (auto const& beside : c.peers) {
            if (std::regex_search(beside.peer, target.peer)) {
                add("ratio to " + beside.peer, beside.ratio);
            }
        }
    } else if (target.measure == "ratio_to_case") {
        auto const name = match.format(target.beside);
        for (auto const& beside : all.measurements) {
            if (beside.name == name && beside.failure.empty()) {
                add("ratio to " + name, beside.seconds / c.of.seconds);
            }
        }
    }
    return verdicts;
}

} // namespace detail

/// Joins measurements with the peers' times of the same name and with the targets that hold for them.
inline judged_results judge(results const& all, std::span<target const> targets) {
    judged_results judged;
    judged.missing = all.missing;
    std::set<std::string> unmatched;
    for (auto const& time : all.peers) {
        unmatched.insert(time.name);
    }
    std::set<std::string> measured;
    for (auto const& of : all.measurements) {
        judged_case c{of, {}, {}};
        unmatched.erase(of.name);
        if (of.failure.empty()) {
            for (auto const& time : all.peers) {
                if (time.name == of.name) {
                    c.peers.push_back({time.peer, time.seconds, time.seconds / of.seconds});
                }
            }
            for (auto const& target : targets) {
                auto verdicts = detail::verdicts_of(target, c, all);
                if (!verdicts.empty()) {
                    measured.insert(target.says);
                }
                std::move(verdicts.begin(), verdicts.end(), std::back_inserter(c.verdicts));
            }
        }
        judged.cases.push_back(std::move(c));
    }
    judged.unmatched.assign(unmatched.begin(), unmatched.end());
    for (auto const& target : targets) {
        if (measured.insert(target.says).second) {
            judged.unmeasured.push_back(target.says);
        }
    }
    return judged;
}

namespace detail {

/// A number with three digits that count: 0.0123, 1.23, 123, 12300.
inline std::string three_digits(double value) {
    std::array<char, 32> text{};
    auto const size = std::abs(value);
    auto decimals = size == 0 ? 0 : 4;
    for (auto next = 0.09995; decimals > 0 && size >= next; next *= 10) {
        --decimals;
    }
    std::snprintf(text.data(), text.size(), "%.*f", decimals, value);
    return text.data();
}

/// A value with the prefix of its unit, `units` from the smallest on, each 1000 times the one before.
inline std::string with_unit(double value, std::span<char const* const> units) {
    std::size_t u = 0;
    for (; u + 1 < units.size() && value >= 999.5; ++u) {
        value /= 1000;
    }
    return three_digits(value) + " " + units[u];
}

inline std::string time_text(double seconds) { return with_unit(seconds * 1e9, std::array{"ns", "us", "ms", "s"}); }

/// A name as words: `mix_rows<float>` is `mix rows float`, `tokens:64/channels:320` is `tokens 64, channels 320`.
inline std::string words(std::string const& name) {
    std::string text;
    for (auto const letter : name) {
        if (letter == '/') {
            text += ',';
        }
        if (letter != '>') {
            text += letter == '/' || letter == ':' || letter == '_' || letter == '<' ? ' ' : letter;
        }
    }
    return text;
}

inline void append(std::string& list, std::string const& item) { list += (list.empty() ? "" : "; ") + item; }

/// A counter and its name, which may tell its unit: `held_bytes` is `held 63.2 MB`, `network_seconds` `network 4.60 s`.
inline std::string counter_text(std::string const& name, double value) {
    auto const before = [&name](std::string const& unit) { return words(name.substr(0, name.size() - unit.size())); };
    if (name.ends_with("_bytes")) {
        return before("_bytes") + " " + with_unit(value, std::array{"B", "kB", "MB", "GB", "TB"});
    }
    if (name.ends_with("_seconds")) {
        return before("_seconds") + " " + time_text(value);
    }
    return words(name) + " " + three_digits(value);
}

/// Bytes and FLOPs a second, then every other counter but the share of the floor.
inline std::string rate_text(measurement const& of) {
    std::string text;
    for (auto const& [name, value] : of.counters) {
        if (name == "bytes_per_second") {
            append(text, with_unit(value, std::array{"B/s", "kB/s", "MB/s", "GB/s", "TB/s"}));
        } else if (name == "FLOP/s") {
            append(text, with_unit(value, std::array{"FLOP/s", "kFLOP/s", "MFLOP/s", "GFLOP/s", "TFLOP/s"}));
        }
    }
    for (auto const& [name, value] : of.counters) {
        if (name != "bytes_per_second" && name != "FLOP/s" && name != "share_of_floor" && name != "items_per_second") {
            append(text, counter_text(name, value));
        }
    }
    return text;
}

inline std::string verdict_text(verdict const& v) {
    return std::string(v.is_met() ? "met" : "missed") + ": " + three_digits(v.value) + (v.is_least ? " ≥ " : " ≤ ") +
           three_digits(v.limit) + ", " + words(v.measure);
}

/// How each peer did in all cases that it ran, in the order of their names.
inline std::vector<std::string> peer_texts(std::span<judged_case const> cases) {
    std::map<std::string, std::vector<double>> ratios;
    for (auto const& c : cases) {
        for (auto const& beside : c.peers) {
            ratios[beside.peer].push_back(beside.ratio);
        }
    }
    std::vector<std::string> texts;
    for (auto const& [peer, of] : ratios) {
        auto const faster = std::count_if(of.begin(), of.end(), [](double ratio) { return ratio > 1; });
        auto const [least, greatest] = std::minmax_element(of.begin(), of.end());
        texts.push_back(peer + ": faster in " + std::to_string(faster) + " of " + std::to_string(of.size()) +
                        " cases, ratios " + three_digits(*least) + " to " + three_digits(*greatest));
    }
    return texts;
}

inline std::string row_text(judged_case const& c) {
    std::string floor;
    if (auto const share = c.of.counter("share_of_floor")) {
        floor = three_digits(*share) + " of " + c.of.label;
    } else {
        floor = c.of.label;
    }
    std::string verdicts;
    for (auto const& v : c.verdicts) {
        append(verdicts, verdict_text(v));
    }
    std::string peers;
    for (auto const& beside : c.peers) {
        append(peers, three_digits(beside.ratio) + " " + beside.peer);
    }
    std::string row = "|";
    for (auto const& cell : {words(c.of.kernel()), words(c.of.shape()),
                             c.of.failure.empty() ? time_text(c.of.seconds) : "failed: " + c.of.failure,
                             rate_text(c.of), floor, verdicts, peers}) {
        row += " " + (cell.empty() ? "-" : cell) + " |";
    }
    return row + "\n";
}

} // namespace detail

/// The table in Markdown and, under it, what is true of all of it.
inline std::string markdown_table(judged_results const& judged, machine const& on) {
    std::string text = "| kernel | shape | time | rate | share of floor | target | ratio to peer |\n"
                       "|---|---|---|---|---|---|---|\n";
    std::size_t repetitions = 0;
    for (auto const& c : judged.cases) {
        text += detail::row_text(c);
        repetitions = std::max(repetitions, c.of.repetitions);
    }
    text += "\nMedians of " + std::to_string(repetitions) + " repetitions on " + on.processor + ", " +
            std::to_string(on.threads) + " threads, " + on.compiler + ", " + on.flags + " (" + on.vectors + ").\n";
    text +=
        "A share of 1 is as fast as the floor, which is timed in turn with the kernel; a ratio above 1 is faster than "
        "the peer.\n";
    text += "\nTargets: " + std::to_string(judged.count(true)) + " met, " + std::to_string(judged.count(false)) +
            " missed.\n";
    auto const list = [&text](std::string const& heading, auto const& items) {
        for (auto const& item : items) {
            text += heading + item + "\n";
        }
    };
    list("- Beside ", detail::peer_texts(judged.cases));
    list("- Not measured: ", judged.unmeasured);
    list("- A peer's case that we have not: ", judged.unmatched);
    for (auto const& [peer, why] : judged.missing) {
        text += "- Peer missing: " + peer + " (" + why + ")\n";
    }
    return text;
}

/// The same as JSON, with every figure in full.
inline nlohmann::ordered_json to_json(judged_results const& judged, machine const& on) {
    nlohmann::ordered_json json;
    json["machine"] = {{"processor", on.processor},
                       {"threads", on.threads},
                       {"compiler", on.compiler},
                       {"flags", on.flags},
                       {"vectors", on.vectors}};
    json["cases"] = nlohmann::ordered_json::array();
    for (auto const& c : judged.cases) {
        nlohmann::ordered_json entry{{"name", c.of.name}, {"kernel", c.of.kernel()}, {"shape", c.of.shape()}};
        if (c.of.failure.empty()) {
            entry["seconds"] = c.of.seconds;
            entry["repetitions"] = c.of.repetitions;
            entry["counters"] = c.of.counters;
        } else {
            entry["failure"] = c.of.failure;
        }
        if (!c.of.label.empty()) {
            entry["label"] = c.of.label;
        }
        for (auto const& v : c.verdicts) {
            entry["targets"].push_back({{"measure", v.measure},
                                        {"value", v.value},
                                        {v.is_least ? "at_least" : "at_most", v.limit},
                                        {"met", v.is_met()}});
        }
        for (auto const& beside : c.peers) {
            entry["peers"].push_back({{"peer", beside.peer}, {"seconds", beside.seconds}, {"ratio", beside.ratio}});
        }
        json["cases"].push_back(std::move(entry));
    }
    json["targets_not_measured"] = judged.unmeasured;
    json["cases_of_peers_alone"] = judged.unmatched;
    json["peers_missing"] = judged.missing;
    return json;
}

} // namespace genrender::benchmarks
