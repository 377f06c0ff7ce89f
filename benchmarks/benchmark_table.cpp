// SPDX-License-Identifier: MIT
// Joins what a run of all benchmarks left in a folder into one table: beside targets and peers, as Markdown and JSON.
#include <benchmarks/support/benchmark_results.hpp>
#include <benchmarks/support/benchmark_table.hpp>
#include <benchmarks/support/judged_results.hpp>
#include <benchmarks/support/native_floors.hpp>
#include <benchmarks/support/this_machine.hpp>

#include <examples/support/output_file.hpp>

#include <CLI/CLI.hpp>

#include <algorithm>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <string>
#include <vector>

using namespace genrender::benchmarks;

int main(int argc, char** argv) {
    std::filesystem::path folder;
    std::filesystem::path targets_file;
    std::filesystem::path out;
    std::string filter;
    CLI::App app("Prints one table of all benchmarks that ran.");
    app.add_option("results", folder, "The folder of the files of --benchmark_out, those of the peers in peers/")
        ->required();
    app.add_option("--targets", targets_file, "A file of targets");
    app.add_option("--out", out, "The folder for benchmarks.md and benchmarks.json");
    app.add_option("--filter", filter, "What the rows of the run had to match, for the text under the table");
    CLI11_PARSE(app, argc, argv);
    try {
        auto const targets = targets_file.empty() ? std::vector<target>() : read_targets(targets_file);
        auto const all = read_results(folder);
        auto judged = judge(all, targets);
        judged.filter = filter;
        auto const machine = this_machine(
            all, GENRENDER_BENCHMARK_FLAGS,
            {"Eigen " GENRENDER_EIGEN_VERSION " (as a floor with " + native_vectors() + ")",
             "xtensor " GENRENDER_XTENSOR_VERSION, "Google Benchmark " GENRENDER_GOOGLE_BENCHMARK_VERSION});
        auto const table = markdown_table(judged, machine);
        if (!out.empty()) {
            genrender::examples::write_text(out / "benchmarks.md", table);
            genrender::examples::write_text(out / "benchmarks.json", to_json(judged, machine).dump(2) + "\n");
        }
        std::printf("%s", table.c_str());
        auto const failed =
            std::any_of(judged.cases.begin(), judged.cases.end(), [](auto const& c) { return !c.of.failure.empty(); });
        return failed ? 1 : 0;
    } catch (std::exception const& error) {
        std::fprintf(stderr, "benchmark_table: %s\n", error.what());
        return 1;
    }
}
