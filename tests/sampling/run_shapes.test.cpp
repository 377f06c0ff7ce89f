// SPDX-License-Identifier: MIT
// The shapes of a run, told to a denoiser that asks.
#include <genrender/sampling/run_shapes.hpp>

#include <genrender/testing/analytic_denoiser.hpp>

#include <doctest/doctest.h>

#include <optional>
#include <string>

using namespace genrender;

TEST_SUITE("sampling/run_shapes") {
    namespace {

    struct told_denoiser : testing::analytic_denoiser<float> {
        mutable std::optional<run_shapes> told;
        void prepare(run_shapes const& shapes) const {
            if (shapes.row_width > 4) {
                throw value_error("told_denoiser: row_width is " + std::to_string(shapes.row_width) +
                                  ", expected at most 4");
            }
            told = shapes;
        }
    };
    struct forgot_const : testing::analytic_denoiser<float> {
        void prepare(run_shapes const&) {}
    };

    static_assert(preparable_denoiser<told_denoiser>);
    static_assert(!preparable_denoiser<testing::analytic_denoiser<float>>);
    static_assert(!preparable_denoiser<forgot_const>);

    } // namespace

    TEST_CASE("a denoiser that asks is told, and may refuse with its own sentence") {
        told_denoiser const phi;
        run_shapes shapes;
        shapes.keyframes = 4;
        shapes.row_width = 4;
        prepare_denoiser(phi, shapes);
        REQUIRE(phi.told.has_value());
        CHECK(phi.told->keyframes == 4);
        shapes.row_width = 8;
        CHECK_THROWS_WITH_AS(prepare_denoiser(phi, shapes), "told_denoiser: row_width is 8, expected at most 4",
                             value_error);
    }
    TEST_CASE("one that does not ask is left alone") {
        CHECK_NOTHROW(prepare_denoiser(testing::analytic_denoiser<float>{}, run_shapes{}));
    }
}
