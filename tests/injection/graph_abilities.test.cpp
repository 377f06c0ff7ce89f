// SPDX-License-Identifier: MIT
// What a graph does not say that it can is refused.
#include <genrender/injection/graph_abilities.hpp>

#include <doctest/doctest.h>

using namespace genrender;

TEST_SUITE("injection/graph_abilities") {
    TEST_CASE("a run that asks for more than its graphs can is refused in a sentence, and no other") {
        run_shapes shapes;
        CHECK_NOTHROW(require_abilities("my_graphs", {}, shapes));
        shapes.scales_logits = true;
        CHECK_THROWS_WITH_AS(require_abilities("my_graphs", {}, shapes),
                             "my_graphs: shapes.scales_logits is true, expected a length_correction of 0 for graphs "
                             "that do not scale logits",
                             value_error);
        CHECK_NOTHROW(require_abilities("my_graphs", {.scales_logits = true}, shapes));
        shapes.keeps_variance = true;
        CHECK_THROWS_WITH_AS(require_abilities("my_graphs", {.scales_logits = true}, shapes),
                             "my_graphs: shapes.keeps_variance is true, expected variance_target::none for graphs that "
                             "do not keep the variance of eq. 6",
                             value_error);
        CHECK_NOTHROW(require_abilities("my_graphs", {.scales_logits = true, .keeps_variance = true}, shapes));
        shapes.counts_keys = true;
        CHECK_THROWS_WITH_AS(require_abilities("my_graphs", {.scales_logits = true, .keeps_variance = true}, shapes),
                             "my_graphs: shapes.counts_keys is true, expected counts_points to be false for a static "
                             "graph",
                             value_error);
    }
}
