// SPDX-License-Identifier: MIT
// Counts of keys find their blocks, and who may be asked for them.
#include <genrender/attention/key_counts.hpp>

#include "../injection/dense_equations.hpp"

#include <genrender/attention/extended_attention.hpp>
#include <genrender/attention/length_correction.hpp>
#include <genrender/injection/host_attention_call.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

using namespace genrender;
using namespace genrender::testing;

TEST_SUITE("attention/key_counts") {
    namespace {

    using counting_call = host_attention_call<double, matrix_module<double>>;

    /// The same call without the capability.
    struct call_without_counts : private counting_call {
        using counting_call::attend;
        using counting_call::counting_call;
        using counting_call::f;
        using counting_call::frames;
        using counting_call::key;
        using counting_call::mix;
        using counting_call::place;
        using counting_call::query;
        using counting_call::value;
        using typename counting_call::features_type;
        using typename counting_call::real_type;
    };

    std::vector<frame_index> const two_frames{{4}, {6}};

    } // namespace

    TEST_CASE("each block has its own numbers, also of a frame that leaves one out") {
        int const K = 0;
        std::vector<std::optional<std::size_t>> const left_out{std::nullopt, 1};
        auto sources = attention_sources<int>::own_and_joined(K, K, K, K, 3, left_out);
        CHECK_FALSE(sources.counts_keys());
        auto const numbers = count_keys(
            sources, {2}, two_frames,
            [](site_index site, frame_index frame) {
                CHECK(site == site_index{2});
                auto const first = static_cast<float>(10 * frame.value);
                return std::vector<float>{first,     first,     first + 1, first + 1,
                                          first + 2, first + 2, first + 3, first + 3};
            },
            left_out);
        CHECK(sources.counts_keys());
        CHECK(sources.pattern().meaning == attention_meaning::own_and_joined);
        auto const counts = [&](std::size_t i) {
            std::vector<float> found;
            for (auto const& block : std::as_const(sources)[i]) {
                found.insert(found.end(), block.counts, block.counts + 2);
            }
            return found;
        };
        CHECK(counts(0) == std::vector<float>{40, 40, 41, 41, 42, 42, 43, 43});
        CHECK(counts(1) == std::vector<float>{60, 60, 61, 61, 63, 63}); // without the second joined one
        auto uncounted = attention_sources<int>::own(K, K, 2);
        CHECK(count_keys(uncounted, {2}, two_frames, {}).empty());
        CHECK_FALSE(uncounted.counts_keys());
    }
    TEST_CASE("features of host memory are counted, and a call that cannot is refused where keys are") {
        CHECK(counting_attention_call<counting_call>);
        CHECK_FALSE(counting_attention_call<call_without_counts>);
        matrix_module<double> const module(4, 2, 11);
        auto const f = random_features<double>({2, 5, 4}, 12);
        counting_call with({}, two_frames, f, module);
        call_without_counts without({}, two_frames, f, module);
        auto const Q = with.query(f);
        auto const K = with.key(f);
        auto const V = with.value(f);
        auto const plain = with.attend(Q, extended_attention_sources(K, V, 2));
        // A count of 2 for every key changes nothing; of 2 for those of frame 0 it is as frame 0 twice.
        auto const counted = [&](float of_first, float of_second) {
            auto sources = extended_attention_sources(K, V, 2);
            auto const numbers = count_keys(sources, {0}, two_frames, [&](site_index, frame_index) {
                std::vector<float> all(10, of_second);
                std::fill_n(all.begin(), 5, of_first);
                return all;
            });
            CHECK_THROWS_WITH_AS(attend_scaled(without, Q, sources),
                                 "attend_scaled: keys are counted, expected counts_points to be false for an attention "
                                 "call without `counts_keys`",
                                 value_error);
            return attend_scaled(with, Q, sources);
        };
        attention_sources<host_features<double>> twice(2);
        twice[0] = twice[1] = {{&K, &V, 0}, {&K, &V, 0}, {&K, &V, 1}};
        auto const expected = with.attend(Q, twice);
        auto const alike = counted(2, 2);
        auto const doubled = counted(2, 1);
        for (std::size_t e = 0; e < plain.view().size(); ++e) {
            CHECK(alike.view().data()[e] == doctest::Approx(plain.view().data()[e]).epsilon(1e-12));
            CHECK(doubled.view().data()[e] == doctest::Approx(expected.view().data()[e]).epsilon(1e-12));
        }
    }
}
