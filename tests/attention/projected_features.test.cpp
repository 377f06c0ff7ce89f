// SPDX-License-Identifier: MIT
// [GR eq. 2] Q, K and V at once.
#include <genrender/attention/projected_features.hpp>

#include <genrender/attention/plain_attention.hpp>
#include <genrender/baselines/previous_frame_attention.hpp>
#include <genrender/blending/blend_plans.hpp>
#include <genrender/injection/host_attention_call.hpp>
#include <genrender/injection/injector.hpp>
#include <genrender/keyframes/recorder.hpp>

#include "support/matrix_module.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

using namespace genrender;

TEST_SUITE("attention/projected_features") {
    namespace {

    using features = host_features<double>;
    using module_type = testing::matrix_module<double>;
    using three_calls = host_attention_call<double, module_type>;

    /// The same call with one operation for the three, which counts itself.
    struct fused_call : three_calls {
        std::size_t* fused;

        fused_call(attention_place place, std::span<frame_index const> frames, features f, module_type const& module,
                   std::size_t& count)
            : three_calls(place, frames, std::move(f), module), fused(&count) {}

        projected_features<features> project(features const& f) {
            ++*fused;
            return {query(f), key(f), value(f)};
        }
    };

    struct of_other_type : three_calls {
        using three_calls::three_calls;
        features project(features const& f) { return f; }
    };

    static_assert(!projecting_attention_call<three_calls>);
    static_assert(projecting_attention_call<fused_call>);
    static_assert(!projecting_attention_call<of_other_type>);

    features input(std::uint64_t seed) {
        auto const f = features::allocate({3, 5, 4});
        auto const values = testing::random_stack<double, 3>({3, 5, 4}, seed);
        copy(f.view(), values.view());
        return f;
    }

    bool equal_bits(features const& a, features const& b) {
        return a.extents() == b.extents() &&
               std::equal(a.view().data(), a.view().data() + a.view().size(), b.view().data());
    }

    /// Whether a processor gives the same features with either call, and asks the fused one to project once.
    template <class Make>
    void require_equal(Make const& make_processor, std::span<frame_index const> frames) {
        module_type const module(4, 2, 1);
        std::size_t fused = 0;
        three_calls one_by_one({{0}, 0}, frames, input(7), module);
        fused_call at_once({{0}, 0}, frames, input(7), module, fused);
        auto const expected = make_processor()(one_by_one);
        CHECK(equal_bits(make_processor()(at_once), expected));
        CHECK(fused == 1);
    }

    } // namespace

    TEST_CASE("every processor projects at once where it can, and gives the same to the bit") {
        std::vector<frame_index> const frames{{0}, {1}, {2}};
        auto const always = [](attention_place) { return true; };
        require_equal([] { return plain_attention{}; }, frames);

        feature_bank<features> bank(1, 1);
        require_equal([&] { return recorder<features>(bank, always); }, frames);

        blend_plans<double> plans({{1, 5}});
        for (auto const frame : frames) {
            blend_plan<double> plan;
            plan.offsets = {0, 2, 2, 3, 4, 5};
            plan.sources = {frame.value, 9, 14, 3, 8};
            plan.weights = {0.5, 0.5, 1, 1, 1};
            plans.add({1, 5}, frame, plan);
        }
        std::vector<frame_index> const KF{{2}, {5}, {1}};
        require_equal(
            [&] {
                return injector<features, double>(
                    bank, KF, plans, {.pre_attention = true, .post_attention = true, .keeps_own_copy = false});
            },
            frames);

        earlier_frames<features> const earlier;
        require_equal([&] { return previous_frame_attention<features>(earlier, bank, always); }, frames);
    }
    TEST_CASE("a call without project is asked for the three") {
        module_type const module(4, 2, 1);
        std::array<frame_index, 3> const frames{{{0}, {1}, {2}}};
        three_calls call({{0}, 0}, frames, input(3), module);
        auto const all = projections_of(call, call.f());
        CHECK(equal_bits(all.Q, call.query(call.f())));
        CHECK(equal_bits(all.K, call.key(call.f())));
        CHECK(equal_bits(all.V, call.value(call.f())));
    }
}
