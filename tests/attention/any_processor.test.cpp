// SPDX-License-Identifier: MIT
// A processor behind one type does what it does by itself.
#include <genrender/attention/any_processor.hpp>

#include <genrender/attention/plain_attention.hpp>
#include <genrender/injection/host_attention_call.hpp>
#include <genrender/testing/analytic_denoiser.hpp>
#include <genrender/testing/attention_processor_laws.hpp>

#include <doctest/doctest.h>

#include <array>

using namespace genrender;

namespace {

using erased_call = host_attention_call<float, testing::identity_projections>;

/// Counts its runs, and is plain at site 1 alone.
struct counting_processor {
    int runs = 0;
    host_features<float> operator()(erased_call& call) {
        ++runs;
        return plain_attention{}(call);
    }
    bool is_plain_at(attention_place place) const { return place.site.value == 1; }
};

} // namespace

TEST_SUITE("attention/any_processor") {
    TEST_CASE("it runs the processor that it refers to, const or not, and returns what that returns") {
        std::array<frame_index, 2> const frames{{{0}, {1}}};
        auto f = host_features<float>::allocate({2, 3, 4});
        for (std::size_t e = 0; e < f.view().size(); ++e) {
            f.view().data()[e] = static_cast<float>(e % 5);
        }
        testing::identity_projections const module;
        erased_call call({}, frames, f, module);
        plain_attention const plain;
        auto const expected = plain(call);
        counting_processor counting;
        any_processor<erased_call> const of_counting(counting);
        auto const counted = of_counting(call);
        auto const plainly = any_processor<erased_call>(plain)(call);
        CHECK(counting.runs == 1);
        for (std::size_t e = 0; e < f.view().size(); ++e) {
            CHECK(counted.view().data()[e] == expected.view().data()[e]);
            CHECK(plainly.view().data()[e] == expected.view().data()[e]);
        }
    }
    TEST_CASE("it tells where the processor is plain") {
        counting_processor counting;
        any_processor<erased_call> const of_counting(counting);
        CHECK(is_plain_at(of_counting, {{1}, 0}));
        CHECK_FALSE(is_plain_at(of_counting, {{0}, 0}));
    }
    TEST_CASE("it is a processor of its engine's calls") {
        CHECK(attention_processor<any_processor<erased_call>, erased_call>);
    }
}
