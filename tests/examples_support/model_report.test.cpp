// SPDX-License-Identifier: MIT
// What is said of a model: a line a kind, however many objects it has.
#include <examples/support/model_report.hpp>

#include <doctest/doctest.h>

using namespace genrender::examples;

namespace {

using report_lines = std::vector<std::string>;

model_object_report reported_object(std::string const& name, std::size_t triangles) {
    model_object_report made;
    made.name = name;
    made.vertices = 3 * triangles;
    made.triangles = triangles;
    return made;
}

} // namespace

TEST_SUITE("examples_support/model_report") {
    TEST_CASE("one object is named with what it holds and notes come first") {
        model_report report;
        report.notes = {"Looks through the file's camera.", "Plays Walk, one of 2 animations."};
        report.objects = {reported_object("Bison", 3732)};
        report.objects[0].joints = 37;
        report.objects[0].morph_targets = 1;
        CHECK(lines_of(report) == report_lines{"Looks through the file's camera.", "Plays Walk, one of 2 animations.",
                                               "Bison: 3,732 triangles, 37 joints, 1 morph target."});
    }

    TEST_CASE("five hundred objects are a line a kind and name three at most") {
        model_report report;
        for (int i = 0; i < 500; ++i) {
            report.objects.push_back(reported_object("part " + std::to_string(i), 24));
            report.objects.back().uvs_outside = i < 2 ? 5 : 0;
            report.objects.back().has_made_uvs = i >= 100;
            report.objects.back().overlap = {i == 50 ? 1000u : 0u, i == 50 ? 250u : 0u};
        }
        CHECK(
            lines_of(report) ==
            report_lines{
                "500 objects of 12,000 triangles.",
                "400 objects have no usable UVs (part 100, part 101, part 102 and 397 more): an atlas of the "
                "triangles was made.",
                "2 objects have UVs outside [0, 1] (part 0, part 1): where texels are used the texture repeats there.",
                "1 object has texels that belong to several places (part 50), up to 25 %: those places look alike; "
                "--atlas tells them apart."});
    }

    TEST_CASE("an atlas that was asked for is no fault of the file") {
        model_report report;
        report.objects = {reported_object("a", 1), reported_object("b", 1)};
        report.asked_for_uvs = report.objects[0].has_made_uvs = true;
        report.objects[1].has_made_uvs = true;
        report.objects[1].joints = 2;
        CHECK(lines_of(report) == report_lines{"2 objects of 2 triangles, up to 2 joints."});
    }

    TEST_CASE("a report of nothing is empty") { CHECK(lines_of({}).empty()); }
}
