// SPDX-License-Identifier: MIT
// Means, paired differences and the tables made of them.
#include <examples/evaluation/results.hpp>

#include <doctest/doctest.h>

using namespace genrender;
using namespace genrender::examples;

namespace {

std::vector<run_figures> three_runs() {
    return {{"ours", "method", "walk", "dots", 0, {{"error", 0.1}, {"sharp", 1.0}}},
            {"ours", "method", "walk", "dots", 1, {{"error", 0.3}}},
            {"theirs", "method", "walk", "dots", 0, {{"error", 0.4}}}};
}

} // namespace

TEST_SUITE("evaluation_program/results") {
    TEST_CASE("a figure is the mean of its runs with its standard error") {
        CHECK(figure_text(figure_of(three_runs(), "ours", "error")) == "0.2000 ± 0.1000");
        CHECK(figure_text(figure_of(three_runs(), "theirs", "error")) == "0.4000");
        CHECK(figure_text(figure_of(three_runs(), "theirs", "sharp")) == "-");
    }

    TEST_CASE("differences are between runs of the same scene prompt and seed") {
        auto const difference = paired_difference(three_runs(), "ours", "theirs", "error");
        REQUIRE(difference);
        CHECK(difference->mean == doctest::Approx(-0.3));
        CHECK(difference->count == 1);
        CHECK_FALSE(paired_difference(three_runs(), "ours", "others", "error"));
    }

    TEST_CASE("a table has a row for each of its methods, in their order") {
        std::vector<std::string> const methods{"theirs", "ours"};
        CHECK(markdown_table(three_runs(), methods, std::vector<table_column>{{"error", "RMSE"}}) ==
              "| Method | RMSE |\n|---|---|\n| theirs | 0.4000 |\n| ours | 0.2000 ± 0.1000 |\n");
        CHECK(difference_table(three_runs(), "ours", methods, std::vector<table_column>{{"error", "RMSE"}}) ==
              "| ours minus | RMSE |\n|---|---|\n| theirs | -0.3000 |\n");
        CHECK(examples::detail::methods_in_order(three_runs()) == std::vector<std::string>{"ours", "theirs"});
    }

    TEST_CASE("a table of variants has the base in thousandths and what each variant has more than it") {
        CHECK(variant_table(three_runs(), "ours", std::vector<table_column>{{"error", "RMSE"}, {"sharp", "Sharp"}}) ==
              "| Variant | RMSE | Sharp |\n|---|---|---|\n| ours itself | 200.0 ± 100.0 | 1000.0 |\n"
              "| theirs | +300.0 | - |\n");
    }

    TEST_CASE("columns without a figure in any run are left out") {
        auto const left = measured(three_runs(), std::vector<table_column>{{"error", "RMSE"}, {"blur", "Blur"}});
        REQUIRE(left.size() == 1);
        CHECK(left.front().heading == "RMSE");
    }

    TEST_CASE("a table of scenes has a row for each and the figures of its first run") {
        CHECK(scene_table(three_runs(), std::vector<table_column>{{"sharp", "Sharp"}, {"pairs", "Pairs"}}) ==
              "| Scene | Sharp | Pairs |\n|---|---|---|\n| walk | 1 | - |\n");
    }

    TEST_CASE("every run is a line with empty fields where it has no figure") {
        CHECK(runs_csv(three_runs()) == "group,method,scene,prompt,seed,error,sharp\n"
                                        "method,\"ours\",walk,\"dots\",0,0.100000,1.000000\n"
                                        "method,\"ours\",walk,\"dots\",1,0.300000,\n"
                                        "method,\"theirs\",walk,\"dots\",0,0.400000,\n");
        CHECK(means_csv(three_runs()) == "group,method,measure,mean,standard_error,runs\n"
                                         "method,\"ours\",error,0.200000,0.100000,2\n"
                                         "method,\"ours\",sharp,1.000000,,1\n"
                                         "method,\"theirs\",error,0.400000,,1\n");
    }
}
