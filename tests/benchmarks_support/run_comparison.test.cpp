// SPDX-License-Identifier: MIT
// Which rows of two runs differ by more than their noise.
#include <benchmarks/support/run_comparison.hpp>

#include <doctest/doctest.h>

#include "support/scratch_folder.hpp"

#include <string>
#include <vector>

using namespace genrender;
using namespace genrender::benchmarks;
using genrender::tests::scratch_folder;

namespace {

measurement timed(std::string const& name, double seconds, std::optional<double> noise) {
    return {name, seconds, noise ? std::size_t{5} : std::size_t{1}, {}, "", "", noise};
}

measurement failed(std::string const& name) { return {name, 0, 0, {}, "", "no memory", {}}; }

change change_of(double before, double after, double noise) {
    return compare(timed("mix", before, noise), timed("mix", after, noise)).is;
}

} // namespace

TEST_SUITE("benchmarks_support/run_comparison") {
    TEST_CASE("a change counts if it is more than three deviations of both runs together") {
        // 3 x 1.4826 x sqrt(0.01^2 + 0.01^2) is 6.29 %.
        CHECK(change_of(1, 1.06, 0.01) == change::within_noise);
        CHECK(change_of(1, 1.07, 0.01) == change::slower);
        CHECK(change_of(1.06, 1, 0.01) == change::within_noise);
        CHECK(change_of(1.07, 1, 0.01) == change::faster);
        auto const row = compare(timed("mix", 2, 0.03), timed("mix", 1, 0.04));
        CHECK(row.ratio == 0.5);
        CHECK(row.noise.value() == doctest::Approx(3 * 1.4826 * 0.05));
    }

    TEST_CASE("repetitions that agree too well do not make a change of two percent count") {
        CHECK(change_of(1, 1.019, 0) == change::within_noise);
        CHECK(change_of(1, 1.021, 0) == change::slower);
    }

    TEST_CASE("without repetitions, or if it failed, a row is not judged") {
        auto const once = compare(timed("run", 1, {}), timed("run", 3, 0.01));
        CHECK(once.is == change::not_judged);
        CHECK(once.ratio == 3);
        CHECK_FALSE(once.noise);
        CHECK(compare(failed("run"), timed("run", 1, 0.01)).is == change::not_judged);
        CHECK(compare(timed("run", 1, 0.01), failed("run")).is == change::not_judged);
        CHECK(compare(timed("run", 1, 0.01), failed("run")).ratio == 0);
    }

    TEST_CASE("a row of one run alone is said to be so") {
        earlier_run const before{{}, "", {timed("gone", 1, 0.1), timed("mix", 1, 0.1)}};
        earlier_run const after{{}, "", {timed("mix", 1, 0.1), timed("new", 1, 0.1)}};
        auto const rows = compare(before, after);
        REQUIRE(rows.size() == 3);
        CHECK(rows[0].name == "mix");
        CHECK(rows[0].is == change::within_noise);
        CHECK(rows[1].name == "new");
        CHECK(rows[1].is == change::after_only);
        CHECK(rows[2].name == "gone");
        CHECK(rows[2].is == change::before_only);
    }

    TEST_CASE("the table has a row a case, counts the verdicts and tells what differs between the machines") {
        earlier_run const before{{{"processor", "a"}, {"threads", 2}},
                                 "",
                                 {timed("mix/tokens:64", 1, 0.01), timed("add", 1, 0.01), timed("gone", 1, 0.01)}};
        earlier_run after{{{"processor", "b"}, {"threads", 2}, {"date", "today"}},
                          "",
                          {timed("mix/tokens:64", 0.5, 0.01), timed("add", 1, 0.01), timed("new/a:1", 1, 0.01)}};
        auto const head =
            std::string("| kernel | shape | time after / before | noise | verdict |\n|---|---|---|---|---|\n"
                        "| mix | tokens 64 | 0.500 | 6.29 % | faster |\n"
                        "| add | - | 1.00 | 6.29 % | within noise |\n"
                        "| new | a 1 | - | - | only after |\n");
        auto const table = comparison_table(before, after);
        CHECK(table.starts_with(head + "| gone | - | - | - | only before |\n\n"));
        CHECK(table.ends_with("\n\n1 faster, 1 within noise, 1 only before, 1 only after.\n"
                              "- date: before not told, after \"today\"\n"
                              "- processor: before \"a\", after \"b\"\n"));

        after.filter = "mix|add|new";
        auto const part = comparison_table(before, after);
        CHECK(part.starts_with(head + "\n"));
        CHECK(part.find("1 only before, 1 only after.\n- The later run has only rows that match 'mix|add|new'.\n") !=
              std::string::npos);
    }

    TEST_CASE("a run is read from the JSON of its table") {
        scratch_folder const folder;
        auto const run = read_run(folder.write("benchmarks.json",
                                               R"({"machine": {"threads": 2}, "filter": "mix", "cases": [
            {"name": "mix", "seconds": 0.5, "repetitions": 5, "noise": 0.01},
            {"name": "run", "seconds": 2, "repetitions": 1}, {"name": "bad", "failure": "no memory"}]})"));
        CHECK(run.machine["threads"] == 2);
        CHECK(run.filter == "mix");
        REQUIRE(run.measurements.size() == 3);
        CHECK(run.measurements[0].name == "mix");
        CHECK(run.measurements[0].seconds == 0.5);
        CHECK(run.measurements[0].repetitions == 5);
        CHECK(run.measurements[0].noise == 0.01);
        CHECK_FALSE(run.measurements[1].noise);
        CHECK(run.measurements[2].failure == "no memory");
    }

    TEST_CASE("a file that is no run is refused by name") {
        scratch_folder const folder;
        auto const refusal = [&](std::string const& text) {
            auto const file = folder.write("file.json", text);
            try {
                read_run(file);
            } catch (file_error const& error) {
                return std::string(error.what()).substr(file.string().size());
            }
            return std::string("no refusal");
        };
        CHECK(refusal("[]") == ": an entry has no fit 'machine', expected one in []");
        CHECK(refusal(R"({"machine": {}, "cases": 1})") == ": holds no list, expected a list of cases");
        CHECK(refusal(R"({"machine": {}, "cases": [{"name": "mix", "seconds": 0, "repetitions": 1}]})") ==
              ": seconds of 'mix' is 0.000000, expected more than 0");
        CHECK(refusal(R"({"machine": {}, "cases": [{"name": "mix", "seconds": 1}]})").find("'repetitions'") !=
              std::string::npos);
    }
}
