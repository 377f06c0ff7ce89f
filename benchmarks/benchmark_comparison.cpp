// SPDX-License-Identifier: MIT
// Says which rows of two runs of the benchmarks differ by more than their noise.
#include <benchmarks/support/run_comparison.hpp>

#include <CLI/CLI.hpp>

#include <cstdio>
#include <exception>
#include <filesystem>

using namespace genrender::benchmarks;

int main(int argc, char** argv) {
    std::filesystem::path before;
    std::filesystem::path after;
    CLI::App app("Compares two runs of the benchmarks, row by row.");
    app.add_option("before", before, "The file benchmarks.json of the earlier run")->required();
    app.add_option("after", after, "That of the later run")->required();
    CLI11_PARSE(app, argc, argv);
    try {
        std::printf("%s", comparison_table(read_run(before), read_run(after)).c_str());
        return 0;
    } catch (std::exception const& error) {
        std::fprintf(stderr, "benchmark_comparison: %s\n", error.what());
        return 1;
    }
}
