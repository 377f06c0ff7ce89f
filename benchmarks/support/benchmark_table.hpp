// SPDX-License-Identifier: MIT
// The judged results of a run as a table for people and as JSON for programs.
#pragma once

#include <benchmarks/support/benchmark_results.hpp>
#include <benchmarks/support/judged_results.hpp>
#include <benchmarks/support/machine.hpp>
#include <benchmarks/support/table_text.hpp>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstddef>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace genrender::benchmarks {

namespace detail {

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

/// The noise and, in brackets, of how many repetitions; nothing of one alone.
inline std::string noise_text(measurement const& of) {
    return of.noise ? percent_text(*of.noise) + " (" + std::to_string(of.repetitions) + ")" : "";
}

/// All of a list, with commas between.
inline std::string joined(std::span<std::string const> items) {
    std::string text;
    for (auto const& item : items) {
        text += (text.empty() ? "" : ", ") + item;
    }
    return text;
}

/// What the head of the table tells, each under its name; nothing of what is not known.
inline std::vector<std::pair<std::string, std::string>> head_of(machine const& on) {
    std::vector<std::pair<std::string, std::string>> head;
    auto const add = [&head](char const* name, std::string const& text) {
        if (!text.empty()) {
            head.emplace_back(name, text);
        }
    };
    add("processor",
        on.processor + ", " + std::to_string(on.cores) + " cores, " + std::to_string(on.threads) + " threads");
    std::vector<std::string> caches;
    for (auto const& cache : on.began ? on.began->caches : std::vector<cache>()) {
        caches.push_back(cache.name + " " + memory_text(cache.bytes));
    }
    add("caches", joined(caches));
    add("memory", memory_text(on.memory_bytes));
    add("compiler", on.compiler + ", " + on.flags);
    add("vector target", on.vector_target.empty() ? "" : on.vector_target + " of " + joined(on.vector_targets));
    add("libraries", joined(on.libraries));
    add("peers", joined(on.peers));
    if (on.began) {
        add("began",
            on.began->date + (on.began->load ? ", load of the minute before " + three_digits(*on.began->load) : ""));
    }
    return head;
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
                             noise_text(c.of), rate_text(c.of), floor, verdicts, peers}) {
        row += " " + (cell.empty() ? "-" : cell) + " |";
    }
    return row + "\n";
}

} // namespace detail

/// The table in Markdown: before it what the figures are true of, under it what is true of all of it.
inline std::string markdown_table(judged_results const& judged, machine const& on) {
    std::string text = "| run | |\n|---|---|\n";
    for (auto const& [name, what] : detail::head_of(on)) {
        text += "| " + name + " | " + what + " |\n";
    }
    text += "\n| kernel | shape | time | noise | rate | share of floor | target | ratio to peer |\n"
            "|---|---|---|---|---|---|---|---|\n";
    for (auto const& c : judged.cases) {
        text += detail::row_text(c);
    }
    text +=
        "\nTimes are medians of repetitions, by the clock on the wall; half of the repetitions, whose number stands in "
        "brackets, lie within the noise around them.\n"
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
    if (judged.filter.empty()) {
        list("- Not measured: ", judged.unmeasured);
    } else {
        text += "- Only rows that match '" + judged.filter + "' were measured.\n";
    }
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
                       {"cores", on.cores},
                       {"threads", on.threads},
                       {"memory_bytes", on.memory_bytes},
                       {"compiler", on.compiler},
                       {"flags", on.flags},
                       {"vector_target", on.vector_target},
                       {"vector_targets", on.vector_targets},
                       {"libraries", on.libraries},
                       {"peers", on.peers}};
    if (on.began) {
        for (auto const& cache : on.began->caches) {
            json["machine"]["caches"].push_back({{"name", cache.name}, {"bytes", cache.bytes}});
        }
        json["machine"]["date"] = on.began->date;
        if (on.began->load) {
            json["machine"]["load"] = *on.began->load;
        }
    }
    json["cases"] = nlohmann::ordered_json::array();
    for (auto const& c : judged.cases) {
        nlohmann::ordered_json entry{{"name", c.of.name}, {"kernel", c.of.kernel()}, {"shape", c.of.shape()}};
        if (c.of.failure.empty()) {
            entry["seconds"] = c.of.seconds;
            entry["repetitions"] = c.of.repetitions;
            if (c.of.noise) {
                entry["noise"] = *c.of.noise;
            }
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
    if (!judged.filter.empty()) {
        json["filter"] = judged.filter;
    }
    json["targets_not_measured"] = judged.unmeasured;
    json["cases_of_peers_alone"] = judged.unmatched;
    json["peers_missing"] = judged.missing;
    return json;
}

} // namespace genrender::benchmarks
