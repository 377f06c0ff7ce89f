// SPDX-License-Identifier: MIT
// Memory of ggml's graphs: views keep what they look into, plans are uploaded once.
#include <genrender/adapters/ggml_memory.hpp>

#include <doctest/doctest.h>
#include <ggml-cpu.h>

#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

using namespace genrender;
using namespace genrender::adapters;

TEST_SUITE("adapters/ggml_memory") {
    TEST_CASE("an output that is a view of a view keeps the memory that it looks into") {
        ggml_context_ptr const ctx(ggml_init({16 * ggml_tensor_overhead(), nullptr, true}));
        auto* const x = ggml_new_tensor_2d(ctx.get(), GGML_TYPE_F32, 4, 6);
        auto* const y = ggml_scale(ctx.get(), x, 2);
        auto* const view = ggml_view_1d(ctx.get(), ggml_reshape_1d(ctx.get(), y, 24), 4, 0);
        keep_output(view);
        CHECK((view->flags & GGML_TENSOR_FLAG_OUTPUT) != 0);
        CHECK((y->flags & GGML_TENSOR_FLAG_OUTPUT) != 0);
        CHECK((x->flags & GGML_TENSOR_FLAG_OUTPUT) == 0);
    }

    TEST_CASE("a bank keeps features in the storage that is asked for and no other") {
        ggml_backend_ptr const backend(ggml_backend_cpu_init());
        ggml_bank const bank(backend.get(), 8, 6, 3, feature_storage::bf16);
        CHECK(ggml_features{bank.f_KF}.extents() == std::array<std::size_t, 3>{3, 6, 8});
        CHECK(ggml_features{}.extents() == std::array<std::size_t, 3>{});
        CHECK(bank.f_KF->data != bank.F_KF->data);
        CHECK(stored(ggml_features{bank.F_KF}, feature_storage::bf16).tensor == bank.F_KF);
        CHECK_THROWS_WITH_AS(stored(ggml_features{bank.F_KF}, feature_storage::f16), doctest::Contains("another type"),
                             value_error);
    }

    TEST_CASE("a plan is uploaded when its key or alpha is another, in columns") {
        ggml_backend_ptr const backend(ggml_backend_cpu_init());
        run_shapes shapes;
        shapes.keyframes = 2;
        shapes.row_width = 2;
        ggml_plan plan(backend.get(), 1, 3, shapes);
        std::vector<std::uint32_t> const offsets{0, 2, 2, 3};
        std::vector<std::uint32_t> const sources{1, 5, 4};
        std::vector<float> const weights{0.25f, 0.75f, 1};
        std::vector<sparse_rows<float>> rows{{offsets, sources, weights, plan_key{{1, 3}, {4}, 1}}};
        plan.write_rows(rows, 0.5f);
        plan.write_rows(rows, 0.5f);
        CHECK(plan.uploads() == 1);
        plan.write_rows(rows, 0.75f);
        rows[0].key->evaluation = 2;
        plan.write_rows(rows, 0.75f);
        CHECK(plan.uploads() == 3);
        rows[0].key.reset();
        plan.write_rows(rows, 0.75f);
        plan.write_rows(rows, 0.75f);
        CHECK(plan.uploads() == 5);

        std::vector<std::int32_t> index(6);
        std::vector<float> own(3);
        ggml_backend_tensor_get(plan.index, index.data(), 0, ggml_nbytes(plan.index));
        ggml_backend_tensor_get(plan.own, own.data(), 0, ggml_nbytes(plan.own));
        CHECK(index == std::vector<std::int32_t>{1, 0, 4, 5, 0, 0});
        CHECK(own == std::vector<float>{0.25f, 1, 0.25f});

        shapes.row_width = 1;
        ggml_plan narrow(backend.get(), 1, 3, shapes);
        CHECK_THROWS_WITH_AS(narrow.write_rows(rows, 0.5f), doctest::Contains("at most the width 1"), value_error);
    }

    TEST_CASE("a mask hides the keyframe that a frame leaves out") {
        ggml_backend_ptr const backend(ggml_backend_cpu_init());
        run_shapes shapes;
        shapes.keyframes = 2;
        ggml_plan plan(backend.get(), 2, 3, shapes);
        std::vector<std::optional<std::size_t>> const left_out{std::nullopt, 1};
        plan.write_mask(left_out);
        std::vector<float> mask(18);
        ggml_backend_tensor_get(plan.mask, mask.data(), 0, ggml_nbytes(plan.mask));
        for (std::size_t e = 0; e < 18; ++e) {
            CHECK(std::isinf(mask[e]) == (e >= 15));
        }
        shapes.leaves_out = false;
        ggml_plan none(backend.get(), 2, 3, shapes);
        CHECK_THROWS_WITH_AS(none.write_mask(left_out), doctest::Contains("shapes.leaves_out"), value_error);
    }
}
