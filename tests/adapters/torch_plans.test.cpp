// SPDX-License-Identifier: MIT
// Plans as tensors: what they hold, and how often they are uploaded.
#include <genrender/adapters/torch_plans.hpp>

#include <ATen/ATen.h>

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

using namespace genrender;
using namespace genrender::adapters;

TEST_SUITE("adapters/torch_plans") {
    namespace {

    std::vector<std::uint32_t> const plan_offsets{0, 2, 2, 3};
    std::vector<std::uint32_t> const plan_sources{5, 1, 4};
    std::vector<float> const plan_weights{0.25f, 0.75f, 1.0f};

    sparse_rows<float> plan_of(std::uint32_t frame, std::uint64_t evaluation) {
        return {plan_offsets, plan_sources, plan_weights, plan_key{{1, 3}, {frame}, evaluation}};
    }

    template <class T>
    std::vector<T> values(at::Tensor const& x) {
        return {x.data_ptr<T>(), x.data_ptr<T>() + x.numel()};
    }

    } // namespace

    TEST_CASE("a view and its tensor share elements, extents and strides") {
        std::vector<float> memory(24);
        strided_view<float, 3> const view(memory.data(), {2, 3, 2}, {12, 4, 1});
        auto const tensor = tensor_of(view);
        CHECK(tensor.sizes().equals({2, 3, 2}));
        tensor.fill_(1);
        tensor[1][2][0] = 7;
        CHECK(view(1, 2, 0) == 7);
        CHECK(memory[2] == 0); // between the rows
        CHECK(tensor_of(strided_view<float const, 3>(view)).data_ptr<float>() == memory.data());
        std::vector<double> other(3);
        CHECK(bool(tensor_of(strided_view<double, 1>(other.data(), {3})).scalar_type() == at::kDouble));
    }

    TEST_CASE("plans of a call become the arrays of an embedding bag") {
        std::array const plans{plan_of(0, 1), plan_of(1, 1)};
        auto const rows = torch_plans().rows(plans, 0.5f, at::kCPU);
        CHECK(values<std::int32_t>(rows.offsets) == std::vector<std::int32_t>{0, 2, 2, 3, 5, 5, 6});
        CHECK(values<std::int32_t>(rows.index) == std::vector<std::int32_t>{5, 1, 4, 5, 1, 4});
        CHECK(values<float>(rows.weights) == std::vector{0.125f, 0.375f, 0.5f, 0.125f, 0.375f, 0.5f});
        CHECK(values<float>(rows.own) == std::vector{0.5f, 1.0f, 0.5f, 0.5f, 1.0f, 0.5f});
        CHECK(rows.own.sizes().equals({6, 1}));
    }

    TEST_CASE("plans with keys are uploaded once for all copies of the handle, others each time") {
        torch_plans const plans;
        torch_plans const copy = plans;
        std::array const stack{plan_of(0, 1), plan_of(1, 1)};
        auto const first = plans.rows(stack, 0.5f, at::kCPU);
        CHECK(copy.rows(stack, 0.5f, at::kCPU).index.is_same(first.index));
        CHECK(plans.uploads() == 1);
        std::array const other{plan_of(2, 1), plan_of(1, 1)};
        plans.rows(other, 0.5f, at::kCPU);  // other frames
        plans.rows(stack, 0.25f, at::kCPU); // another alpha
        CHECK(plans.uploads() == 3);
        std::array const unnamed{sparse_rows<float>{plan_offsets, plan_sources, plan_weights}};
        plans.rows(unnamed, 0.5f, at::kCPU);
        plans.rows(unnamed, 0.5f, at::kCPU);
        CHECK(copy.uploads() == 5);
    }

    TEST_CASE("what was uploaded for an evaluation is dropped when a later one comes") {
        torch_plans const plans;
        std::array const early{plan_of(0, 1)};
        std::array const late{plan_of(0, 2)};
        auto const first = plans.rows(early, 0.5f, at::kCPU);
        CHECK(first.index.use_count() == 2);
        plans.rows(late, 0.5f, at::kCPU);
        CHECK(first.index.use_count() == 1);
        plans.rows(late, 0.5f, at::kCPU);
        CHECK(plans.uploads() == 2);
    }

    TEST_CASE("an alpha that is not finite is refused and keeps nothing") {
        torch_plans const plans;
        std::array const stack{plan_of(0, 1)};
        CHECK_THROWS_AS(plans.rows(stack, std::numeric_limits<float>::infinity(), at::kCPU), value_error);
        CHECK_THROWS_AS(plans.rows(stack, std::nanf(""), at::kCPU), value_error);
        CHECK(plans.uploads() == 0);
    }
}
