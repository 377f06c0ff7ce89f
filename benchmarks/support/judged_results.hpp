// SPDX-License-Identifier: MIT
// The results of a run judged by their targets and beside their peers.
#pragma once

#include <benchmarks/support/benchmark_results.hpp>

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <map>
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
    std::string filter;                         ///< that the cases of the run had to match, else empty

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
    } else if (target.measure == "seconds") {
        add(target.measure, c.of.seconds);
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

} // namespace genrender::benchmarks
