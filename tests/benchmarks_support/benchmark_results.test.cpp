// SPDX-License-Identifier: MIT
// What is read from the files of a run of benchmarks.
#include <benchmarks/support/benchmark_results.hpp>

#include <doctest/doctest.h>

#include "support/scratch_folder.hpp"

#include <string>

using namespace genrender;
using namespace genrender::benchmarks;
using genrender::tests::scratch_folder;

namespace {

/// One repetition as Google Benchmark writes it; `more` are further fields.
std::string repetition(std::string const& name, double milliseconds, std::string const& more = "") {
    return R"({"name": ")" + name + R"(", "run_name": ")" + name +
           R"(", "run_type": "iteration", "repetitions": 3, "iterations": 7, "cpu_time": 1, "time_unit": "ms", )" +
           R"("real_time": )" + std::to_string(milliseconds) + more + "}";
}

std::string file_of(std::string const& repetitions) {
    return R"({"context": {}, "benchmarks": [)" + repetitions + "]}";
}

} // namespace

TEST_SUITE("benchmarks_support/benchmark_results") {
    TEST_CASE("a measurement is the medians of its repetitions") {
        scratch_folder const folder;
        auto const name = "mix/tokens:64/channels:320/iterations:1/manual_time";
        auto const file =
            folder.write("mix.json", file_of(repetition(name, 5, R"(, "share_of_floor": 0.5, "label": "copy")") + "," +
                                             repetition(name, 1, R"(, "share_of_floor": 0.9, "label": "copy")") + "," +
                                             repetition(name, 3, R"(, "share_of_floor": 0.6, "label": "copy")") +
                                             R"(, {"run_name": "mix", "run_type": "aggregate", "real_time": 100})"));
        auto const measurements = read_measurements(file);
        REQUIRE(measurements.size() == 1);
        auto const& mix = measurements.front();
        CHECK(mix.name == "mix/tokens:64/channels:320");
        CHECK(mix.kernel() == "mix");
        CHECK(mix.shape() == "tokens:64/channels:320");
        CHECK(mix.seconds == doctest::Approx(0.003));
        CHECK(mix.repetitions == 3);
        CHECK(mix.noise.value() == doctest::Approx(2.0 / 3)); // 1, 3 and 5 ms
        CHECK(mix.counters.size() == 1);
        CHECK(mix.counter("share_of_floor") == 0.6);
        CHECK_FALSE(mix.counter("speedup"));
        CHECK(mix.label == "copy");
    }

    TEST_CASE("a kernel without arguments has no shape") {
        measurement const of{"noise", 1, 1, {}, "", "", {}};
        CHECK(of.kernel() == "noise");
        CHECK(of.shape() == "");
    }

    TEST_CASE("one repetition has no noise") {
        scratch_folder const folder;
        CHECK_FALSE(read_measurements(folder.write("mix.json", file_of(repetition("mix", 1)))).front().noise);
    }

    TEST_CASE("the run began with the first of its programs") {
        scratch_folder const folder;
        auto const context = [](std::string const& date, std::string const& load) {
            return R"({"context": {"date": "2026-11-27T)" + date + R"(", "load_avg": [)" + load + R"(], "caches": [)" +
                   R"({"type": "Data", "level": 1, "size": 32768, "num_sharing": 1}, )" +
                   R"({"type": "Unified", "level": 2, "size": 1048576, "num_sharing": 1}]}, "benchmarks": [)" +
                   repetition("mix", 1) + "]}";
        };
        folder.write("a.json", context("17:31:10", "1.5, 0.5"));
        folder.write("b.json", context("17:30:59", "0.25, 0.5"));
        folder.write("c.json", file_of(repetition("add", 1)));
        auto const began = read_results(folder.path()).began;
        REQUIRE(began);
        CHECK(began->date == "2026-11-27T17:30:59");
        CHECK(began->load == 0.25);
        REQUIRE(began->caches.size() == 2);
        CHECK(began->caches[0].name == "L1 Data");
        CHECK(began->caches[0].bytes == 32768);
        CHECK(began->caches[1].name == "L2");
    }

    TEST_CASE("a run of which no file tells the beginning has none") {
        scratch_folder const folder;
        folder.write("a.json", file_of(repetition("mix", 1)));
        CHECK_FALSE(read_results(folder.path()).began);
    }

    TEST_CASE("a case that could not run says why") {
        scratch_folder const folder;
        auto const file = folder.write(
            "mix.json", file_of(repetition("mix", 0, R"(, "error_occurred": true, "error_message": "no memory")")));
        CHECK(read_measurements(file).front().failure == "no memory");
    }

    TEST_CASE("a folder holds programs and peers and says which are missing") {
        scratch_folder const folder;
        std::filesystem::create_directories(folder / "peers");
        folder.write("a.json", file_of(repetition("mix", 1)));
        folder.write("b.json", file_of(repetition("add", 2)));
        folder.write("notes.txt", "no result");
        folder.write("peers/array.json", R"([{"name": "mix/real_time", "peer": "NumPy", "seconds": 0.5}])");
        folder.write("peers/engine.json", R"({"missing": "No module named 'engine'"})");
        folder.write("peers/other.json", R"([{"name": "mix", "peer": "Other", "seconds": 2, "cpu_seconds": 3}])");
        auto const all = read_results(folder.path());
        REQUIRE(all.measurements.size() == 2);
        CHECK(all.measurements[0].name == "mix");
        CHECK(all.measurements[1].name == "add");
        REQUIRE(all.peers.size() == 2);
        CHECK(all.peers[0].name == "mix");
        CHECK(all.peers[0].seconds == 0.5);
        CHECK(all.peers[1].name == "mix");
        CHECK(all.peers[1].peer == "Other");
        CHECK(all.peers[1].seconds == 2);
        CHECK(all.missing.at("engine") == "No module named 'engine'");
    }

    TEST_CASE("targets are limits of counters or of ratios") {
        scratch_folder const folder;
        auto const targets = read_targets(
            folder.write("targets.json",
                         R"([{"cases": "^mix/", "says": "fast", "measure": "share_of_floor", "at_least": 0.7},
                {"cases": "^plan/", "says": "cheap", "measure": "ratio_to_peer", "peer": "^NumPy", "at_most": 2}])"));
        REQUIRE(targets.size() == 2);
        CHECK(targets[0].is_least);
        CHECK(targets[0].limit == 0.7);
        CHECK(std::regex_search("mix/tokens:64", targets[0].cases));
        CHECK_FALSE(std::regex_search("remix/tokens:64", targets[0].cases));
        CHECK(std::regex_search("any peer", targets[0].peer));
        CHECK_FALSE(targets[1].is_least);
        CHECK_FALSE(std::regex_search("PyTorch", targets[1].peer));
    }

    TEST_CASE("a folder without measurements is refused") {
        scratch_folder const folder;
        auto const text = folder.path().string() + ": holds no measurement, expected files of --benchmark_out";
        CHECK_THROWS_WITH_AS(read_results(folder.path()), text.c_str(), file_error);
        CHECK_THROWS_AS(read_results(folder / "nowhere"), file_error);
    }

    TEST_CASE("a peer that took no time is refused") {
        scratch_folder const folder;
        std::filesystem::create_directories(folder / "peers");
        folder.write("a.json", file_of(repetition("mix", 1)));
        auto const file = folder.write("peers/array.json", R"([{"name": "mix", "peer": "NumPy", "seconds": 0}])");
        auto const text = file.string() + ": seconds is 0.000000, expected more than 0";
        CHECK_THROWS_WITH_AS(read_results(folder.path()), text.c_str(), file_error);
    }

    TEST_CASE("a file that is not what it should be is refused by name") {
        scratch_folder const folder;
        auto const refusal = [&](auto const& read, std::string const& text) {
            auto const file = folder.write("file.json", text);
            try {
                read(file);
            } catch (file_error const& error) {
                return std::string(error.what()).substr(file.string().size());
            }
            return std::string("no refusal");
        };
        CHECK(refusal(read_measurements, "{") == ": is no JSON, expected a whole file of it");
        CHECK(refusal(read_measurements, "{}") == ": holds no list, expected a list of benchmarks");
        CHECK(refusal(read_measurements, file_of(R"({"run_type": "iteration"})")) ==
              ": an entry has no fit 'run_name', expected one in {\"run_type\":\"iteration\"}");
        CHECK(refusal(read_measurements,
                      file_of(R"({"run_name": "a", "run_type": "iteration", "real_time": 1, "time_unit": "days"})")) ==
              ": time_unit is 'days', expected ns, us, ms or s");
        CHECK(refusal(read_targets, R"([{"cases": "(", "says": "fast", "measure": "speedup", "at_least": 1}])") ==
              ": 'fast' has cases '(', expected regular expressions");
        CHECK(refusal(read_targets, R"([{"cases": "a", "says": "fast", "measure": "speedup"}])").find("'at_most'") !=
              std::string::npos);
    }
}
