// SPDX-License-Identifier: MIT
// Measurements beside targets and peers, and the table of it.
#include <benchmarks/support/benchmark_table.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <string>
#include <vector>

using namespace genrender::benchmarks;

namespace {

target share_of_mix(double at_least) {
    return {std::regex("^mix/"), "mix is fast", "share_of_floor", std::regex(""), "", at_least, true};
}

/// Two cases of a kernel, the second with a peer, and one that failed.
results three_cases() {
    results all;
    all.measurements = {
        {"mix/tokens:64", 2e-3, 3, {{"share_of_floor", 0.8}, {"bytes_per_second", 2e9}}, "copy", "", 0.0125},
        {"mix/tokens:128", 4e-3, 1, {{"share_of_floor", 0.6}, {"FLOP/s", 3e10}, {"speed_up", 1.9}}, "copy", "", {}},
        {"plan", 0, 0, {}, "", "no memory", {}}};
    all.peers = {{"mix/tokens:128", "NumPy", 8e-3}, {"mix/tokens:256", "NumPy", 1}};
    all.missing = {{"engine", "No module named 'engine'"}};
    return all;
}

machine a_machine() {
    machine on;
    on.processor = "a processor";
    on.cores = 1;
    on.threads = 2;
    on.memory_bytes = 3.0 * 1024 * 1024 * 1024;
    on.compiler = "a compiler";
    on.flags = "-O3";
    on.vector_target = "v3";
    on.vector_targets = {"baseline", "v3"};
    on.libraries = {"Eigen 3", "xtensor 0.24"};
    on.peers = {"NumPy 2"};
    on.began = run_start{"2026-11-27", 0.25, {{"L1 Data", 32768}, {"L2", 1048576}}};
    return on;
}

} // namespace

TEST_SUITE("benchmarks_support/benchmark_table") {
    TEST_CASE("a target is met or missed by every case that it holds for") {
        auto const judged = judge(three_cases(), std::vector{share_of_mix(0.7)});
        REQUIRE(judged.cases.size() == 3);
        REQUIRE(judged.cases[0].verdicts.size() == 1);
        CHECK(judged.cases[0].verdicts[0].is_met());
        CHECK_FALSE(judged.cases[1].verdicts[0].is_met());
        CHECK(judged.cases[2].verdicts.empty());
        CHECK(judged.count(true) == 1);
        CHECK(judged.count(false) == 1);
        CHECK(judged.unmeasured.empty());
    }

    TEST_CASE("a limit may be the greatest value too and is itself within") {
        CHECK(verdict{"share", 0.7, 0.7, true}.is_met());
        CHECK(verdict{"share", 0.7, 0.7, false}.is_met());
        CHECK_FALSE(verdict{"share", 0.8, 0.7, false}.is_met());
        CHECK_FALSE(verdict{"share", std::nan(""), 0.7, true}.is_met());
    }

    TEST_CASE("a target may be of the time itself") {
        target const in_time{std::regex("^mix"), "in 3 ms", "seconds", std::regex(""), "", 3e-3, false};
        auto const judged = judge(three_cases(), std::vector{in_time});
        REQUIRE(judged.cases[0].verdicts.size() == 1);
        CHECK(judged.cases[0].verdicts[0].value == 2e-3);
        CHECK(judged.cases[0].verdicts[0].is_met());
        CHECK_FALSE(judged.cases[1].verdicts[0].is_met());
    }

    TEST_CASE("a peer's ratio is its time over ours") {
        auto const judged =
            judge(three_cases(),
                  std::vector<target>{
                      {std::regex("."), "faster than NumPy", "ratio_to_peer", std::regex("^NumPy"), "", 1, true},
                      {std::regex("."), "faster than all others", "ratio_to_peer", std::regex("^Other"), "", 1, true}});
        REQUIRE(judged.cases[1].peers.size() == 1);
        CHECK(judged.cases[1].peers[0].ratio == doctest::Approx(2));
        REQUIRE(judged.cases[1].verdicts.size() == 1);
        CHECK(judged.cases[1].verdicts[0].value == doctest::Approx(2));
        CHECK(judged.unmatched == std::vector<std::string>{"mix/tokens:256"});
        CHECK(judged.unmeasured == std::vector<std::string>{"faster than all others"});
    }

    TEST_CASE("a target may set a case beside another of ours") {
        target const twice{std::regex("^mix/tokens:(1)28"),
                           "wide is no slower",
                           "ratio_to_case",
                           std::regex(""),
                           "mix/tokens:64",
                           0.5,
                           true};
        target const named_by_group{std::regex("^mix/tokens:(64)"),
                                    "as fast as itself",
                                    "ratio_to_case",
                                    std::regex(""),
                                    "mix/tokens:$1",
                                    1,
                                    false};
        target const of_nothing{std::regex("^mix"), "beside nothing", "ratio_to_case", std::regex(""), "plan", 1, true};
        auto const judged = judge(three_cases(), std::vector{twice, named_by_group, of_nothing});
        REQUIRE(judged.cases[0].verdicts.size() == 1);
        CHECK(judged.cases[0].verdicts[0].value == 1);
        REQUIRE(judged.cases[1].verdicts.size() == 1);
        CHECK(judged.cases[1].verdicts[0].measure == "ratio to mix/tokens:64");
        CHECK(judged.cases[1].verdicts[0].value == doctest::Approx(0.5));
        CHECK(judged.unmeasured == std::vector<std::string>{"beside nothing"});
    }

    TEST_CASE("the table has a row a case and tells below it what is missing") {
        auto const judged = judge(three_cases(), std::vector{share_of_mix(0.7)});
        CHECK(
            markdown_table(judged, a_machine()) ==
            "| run | |\n"
            "|---|---|\n"
            "| processor | a processor, 1 cores, 2 threads |\n"
            "| caches | L1 Data 32 KiB, L2 1 MiB |\n"
            "| memory | 3 GiB |\n"
            "| compiler | a compiler, -O3 |\n"
            "| vector target | v3 of baseline, v3 |\n"
            "| libraries | Eigen 3, xtensor 0.24 |\n"
            "| peers | NumPy 2 |\n"
            "| began | 2026-11-27, load of the minute before 0.250 |\n"
            "\n"
            "| kernel | shape | time | noise | rate | share of floor | target | ratio to peer |\n"
            "|---|---|---|---|---|---|---|---|\n"
            "| mix | tokens 64 | 2.00 ms | 1.25 % (3) | 2.00 GB/s | 0.800 of copy |"
            " met: 0.800 ≥ 0.700, share of floor | - |\n"
            "| mix | tokens 128 | 4.00 ms | - | 30.0 GFLOP/s; speed up 1.90 | 0.600 of copy |"
            " missed: 0.600 ≥ 0.700, share of floor | 2.00 NumPy |\n"
            "| plan | - | failed: no memory | - | - | - | - | - |\n"
            "\n"
            "Times are medians of repetitions, by the clock on the wall; half of the repetitions, whose number stands "
            "in brackets, lie within the noise around them.\n"
            "A share of 1 is as fast as the floor, which is timed in turn with the kernel; a ratio above 1 is faster "
            "than the peer.\n"
            "\n"
            "Targets: 1 met, 1 missed.\n"
            "- Beside NumPy: faster in 1 of 1 cases, ratios 2.00 to 2.00\n"
            "- A peer's case that we have not: mix/tokens:256\n"
            "- Peer missing: engine (No module named 'engine')\n");
    }

    TEST_CASE("several peers of a case stand side by side in the order of their files") {
        auto all = three_cases();
        all.peers = {{"mix/tokens:64", "PyTorch 2", 3e-3},
                     {"mix/tokens:64", "ONNX Runtime 1", 1e-3},
                     {"mix/tokens:128", "ONNX Runtime 1", 6e-3}};
        target const no_slower{std::regex("^mix"), "no slower", "ratio_to_peer", std::regex("^ONNX"), "", 1, true};
        auto const judged = judge(all, std::vector{no_slower});
        auto const on = a_machine();
        auto const table = markdown_table(judged, on);
        CHECK(
            table.find("| missed: 0.500 ≥ 1.00, ratio to ONNX Runtime 1 | 1.50 PyTorch 2; 0.500 ONNX Runtime 1 |\n") !=
            std::string::npos);
        CHECK(table.find("| met: 1.50 ≥ 1.00, ratio to ONNX Runtime 1 | 1.50 ONNX Runtime 1 |\n") != std::string::npos);
        CHECK(table.find("\n- Beside ONNX Runtime 1: faster in 1 of 2 cases, ratios 0.500 to 1.50\n"
                         "- Beside PyTorch 2: faster in 1 of 1 cases, ratios 1.50 to 1.50\n") != std::string::npos);
        auto const json = to_json(judged, on);
        REQUIRE(json["cases"][0]["peers"].size() == 2);
        CHECK(json["cases"][0]["peers"][0]["peer"] == "PyTorch 2");
        CHECK(json["cases"][0]["peers"][1]["peer"] == "ONNX Runtime 1");
    }

    TEST_CASE("a run of a part says what it is a part of and lists no target of the rest") {
        auto judged = judge(three_cases(),
                            std::vector<target>{{std::regex("^no"), "no row", "time", std::regex(""), "", 1, true}});
        CHECK(markdown_table(judged, a_machine()).find("- Not measured: no row\n") != std::string::npos);
        judged.filter = "mix";
        auto const table = markdown_table(judged, a_machine());
        CHECK(table.find("Not measured") == std::string::npos);
        CHECK(table.find("- Only rows that match 'mix' were measured.\n") != std::string::npos);
        CHECK(to_json(judged, a_machine())["filter"] == "mix");
    }

    TEST_CASE("what is not known of a run is not in its head") {
        machine on;
        on.processor = "p";
        auto const table = markdown_table(judge(three_cases(), {}), on);
        CHECK(table.find("| vector target |") == std::string::npos);
        CHECK(table.find("| caches |") == std::string::npos);
        CHECK(table.find("| peers |") == std::string::npos);
        CHECK(table.find("| began |") == std::string::npos);
    }

    TEST_CASE("a counter's name may tell its unit") {
        CHECK(detail::counter_text("held_bytes", 6.32e7) == "held 63.2 MB");
        CHECK(detail::counter_text("growth_a_frame_bytes", 12) == "growth a frame 12.0 B");
        CHECK(detail::counter_text("network_seconds", 4.6) == "network 4.60 s");
        CHECK(detail::counter_text("plan_error", 0.0586) == "plan error 0.0586");
    }

    TEST_CASE("the JSON holds every figure in full") {
        auto const json = to_json(judge(three_cases(), std::vector{share_of_mix(0.7)}), a_machine());
        CHECK(json["machine"]["processor"] == "a processor");
        CHECK(json["machine"]["cores"] == 1);
        CHECK(json["machine"]["threads"] == 2);
        CHECK(json["machine"]["memory_bytes"] == 3221225472.0);
        CHECK(json["machine"]["compiler"] == "a compiler");
        CHECK(json["machine"]["flags"] == "-O3");
        CHECK(json["machine"]["vector_target"] == "v3");
        CHECK(json["machine"]["vector_targets"] == nlohmann::ordered_json{"baseline", "v3"});
        CHECK(json["machine"]["libraries"] == nlohmann::ordered_json{"Eigen 3", "xtensor 0.24"});
        CHECK(json["machine"]["peers"] == nlohmann::ordered_json{"NumPy 2"});
        CHECK(json["machine"]["date"] == "2026-11-27");
        CHECK(json["machine"]["load"] == 0.25);
        CHECK(json["machine"]["caches"][1]["bytes"] == 1048576);
        CHECK(json["cases"][0]["noise"] == 0.0125);
        CHECK_FALSE(json["cases"][1].contains("noise"));
        CHECK_FALSE(json.contains("filter"));
        CHECK(json["cases"].size() == 3);
        CHECK(json["cases"][1]["name"] == "mix/tokens:128");
        CHECK(json["cases"][1]["counters"]["FLOP/s"] == 3e10);
        CHECK(json["cases"][1]["targets"][0]["at_least"] == 0.7);
        CHECK(json["cases"][1]["targets"][0]["met"] == false);
        CHECK(json["cases"][1]["peers"][0]["seconds"] == 8e-3);
        CHECK(json["cases"][2]["failure"] == "no memory");
        CHECK(json["peers_missing"]["engine"] == "No module named 'engine'");
    }

    TEST_CASE("numbers have three digits that count and a unit that suits them") {
        using genrender::benchmarks::detail::time_text;
        CHECK(time_text(1.234e-9) == "1.23 ns");
        CHECK(time_text(12.34e-6) == "12.3 us");
        CHECK(time_text(0.9996e-3) == "1.00 ms");
        CHECK(time_text(123.4) == "123 s");
        CHECK(genrender::benchmarks::detail::three_digits(0.0123) == "0.0123");
        CHECK(genrender::benchmarks::detail::three_digits(0) == "0");
    }

    TEST_CASE("names are read as words") {
        using genrender::benchmarks::detail::words;
        CHECK(words("mix_rows<float>") == "mix rows float");
        CHECK(words("tokens:64/channels:320") == "tokens 64, channels 320");
    }
}
