// SPDX-License-Identifier: MIT
// Memory of OpenVINO's models: plans are written once, in rows, and features kept as they were asked for.
#include <genrender/adapters/openvino_memory.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

using namespace genrender;
using namespace genrender::adapters;

TEST_SUITE("adapters/openvino_memory") {
    TEST_CASE("features tell their extents and are of one storage") {
        openvino_features const f{ov::Tensor(ov::element::f16, {3, 6, 8})};
        CHECK(f.extents() == std::array<std::size_t, 3>{3, 6, 8});
        CHECK(openvino_features{}.extents() == std::array<std::size_t, 3>{});
        CHECK(stored(f, feature_storage::f16).tensor.data() == f.tensor.data());
        CHECK_THROWS_WITH_AS(stored(f, feature_storage::bf16), doctest::Contains("another type"), value_error);
    }

    TEST_CASE("a plan is written when its key or alpha is another") {
        run_shapes shapes;
        shapes.keyframes = 2;
        shapes.row_width = 2;
        openvino_plan plan(1, 3, shapes);
        std::vector<std::uint32_t> const offsets{0, 2, 2, 3};
        std::vector<std::uint32_t> const sources{1, 5, 4};
        std::vector<float> const weights{0.25f, 0.75f, 1};
        std::vector<sparse_rows<float>> rows{{offsets, sources, weights, plan_key{{1, 3}, {4}, 1}}};
        plan.write_rows(rows, 0.5f);
        plan.write_rows(rows, 0.5f);
        CHECK(plan.writes() == 1);
        plan.write_rows(rows, 0.75f);
        CHECK(plan.writes() == 2);
        std::vector<std::int32_t> const index(plan.index.data<std::int32_t>(), plan.index.data<std::int32_t>() + 6);
        std::vector<float> const own(plan.own.data<float>(), plan.own.data<float>() + 3);
        CHECK(index == std::vector<std::int32_t>{1, 5, 0, 0, 4, 0});
        CHECK(own == std::vector<float>{0.25f, 1, 0.25f});
        shapes.row_width = 1;
        openvino_plan narrow(1, 3, shapes);
        CHECK_THROWS_WITH_AS(narrow.write_rows(rows, 0.5f), doctest::Contains("at most the width 1"), value_error);
    }

    TEST_CASE("a mask hides the keyframe that a frame leaves out, and none at first") {
        run_shapes shapes;
        shapes.keyframes = 2;
        openvino_plan plan(2, 3, shapes);
        for (std::size_t e = 0; e < 18; ++e) {
            CHECK(plan.mask.data<float>()[e] == 0);
        }
        std::vector<std::optional<std::size_t>> const left_out{std::nullopt, 1};
        plan.write_mask(left_out);
        for (std::size_t e = 0; e < 18; ++e) {
            CHECK(std::isinf(plan.mask.data<float>()[e]) == (e >= 15));
        }
    }
}
