// SPDX-License-Identifier: MIT
// What frames attend to, and what the lists amount to.
#include <genrender/attention/attention_sources.hpp>

#include <doctest/doctest.h>

#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

using namespace genrender;

TEST_SUITE("attention/attention_sources") {
    namespace {

    struct stack_handle {};
    using sources_type = attention_sources<stack_handle>;
    using block_list = sources_type::block_list;

    /// The blocks of a frame as letters and numbers: k and v of the stack itself, K and V of the joined one.
    struct two_stacks {
        stack_handle K;
        stack_handle V;
        stack_handle K_KF;
        stack_handle V_KF;

        std::vector<std::pair<char, std::size_t>> text(block_list const& blocks) const {
            std::vector<std::pair<char, std::size_t>> result;
            for (auto const& block : blocks) {
                CHECK((block.K == &K ? block.V == &V : block.K == &K_KF && block.V == &V_KF));
                result.emplace_back(block.K == &K ? 'o' : 'j', block.frame);
            }
            return result;
        }
    };
    using text = std::vector<std::pair<char, std::size_t>>;

    } // namespace

    TEST_CASE("[GR eq. 1] own sources list one block a frame and say so") {
        two_stacks const s;
        auto const sources = sources_type::own(s.K, s.V, 3);
        REQUIRE(sources.size() == 3);
        CHECK(s.text(sources[2]) == text{{'o', 2}});
        CHECK(sources.pattern().meaning == attention_meaning::own);
        CHECK(sources.pattern().K == &s.K);
        CHECK(sources.pattern().V == &s.V);
        CHECK(sources.pattern().K_KF == nullptr);
    }
    TEST_CASE("[GR eq. 3] sources of a stack list all of its frames and say so") {
        two_stacks const s;
        auto const sources = sources_type::stack(s.K, s.V, 3);
        for (auto const& blocks : sources) {
            CHECK(s.text(blocks) == text{{'o', 0}, {'o', 1}, {'o', 2}});
        }
        CHECK(sources.pattern().meaning == attention_meaning::stack);
        CHECK(sources.pattern().V == &s.V);
    }
    TEST_CASE("[GR eq. 5] own and joined sources say which joined frame a frame leaves out") {
        two_stacks const s;
        auto const sources = sources_type::own_and_joined(s.K, s.V, s.K_KF, s.V_KF, 3, {std::nullopt, 1});
        REQUIRE(sources.size() == 2);
        CHECK(s.text(sources[0]) == text{{'o', 0}, {'j', 0}, {'j', 1}, {'j', 2}});
        CHECK(s.text(sources[1]) == text{{'o', 1}, {'j', 0}, {'j', 2}});
        auto const& pattern = sources.pattern();
        CHECK(pattern.meaning == attention_meaning::own_and_joined);
        CHECK(pattern.K_KF == &s.K_KF);
        CHECK(pattern.V_KF == &s.V_KF);
        CHECK(pattern.joined == 3);
        REQUIRE(pattern.left_out.size() == 2);
        CHECK(!pattern.left_out[0]);
        CHECK(pattern.left_out[1] == 1);
    }
    TEST_CASE("where no frame leaves one out there is no list of them") {
        two_stacks const s;
        auto const sources = sources_type::own_and_joined(s.K, s.V, s.K_KF, s.V_KF, 2, {std::nullopt, std::nullopt});
        CHECK(sources.pattern().meaning == attention_meaning::own_and_joined);
        CHECK(sources.pattern().left_out.empty());
    }
    TEST_CASE("lists that may have been written to are nothing but lists") {
        two_stacks const s;
        auto const whole = sources_type::stack(s.K, s.V, 2);
        auto read = whole;
        CHECK(std::as_const(read)[0].size() == 2);
        CHECK(read.pattern().meaning == attention_meaning::stack);
        read[0].pop_back();
        CHECK(read.pattern().meaning == attention_meaning::listed);
        CHECK(read.pattern().K == nullptr);
        auto run_through = whole;
        for (auto& blocks : run_through) {
            blocks.clear();
        }
        CHECK(run_through.pattern().meaning == attention_meaning::listed);
        auto longer = whole;
        longer.push_back({{&s.K, &s.V, 1}});
        CHECK(longer.size() == 3);
        CHECK(longer.pattern().meaning == attention_meaning::listed);
        CHECK(whole.pattern().meaning == attention_meaning::stack);
    }
    TEST_CASE("lists of a caller's own are read as lists, and given as lists") {
        two_stacks const s;
        sources_type const sources{{{&s.K, &s.V, 1}}, {{&s.K, &s.V, 0}, {&s.K_KF, &s.V_KF, 4}}};
        REQUIRE(sources.size() == 2);
        CHECK(s.text(sources[1]) == text{{'o', 0}, {'j', 4}});
        CHECK(sources.pattern().meaning == attention_meaning::listed);
        std::vector<block_list> const& lists = sources;
        CHECK(lists.data() == &sources[0]);
        CHECK(sources_type(lists).size() == 2);
        CHECK(sources_type(3, lists[1])[2].size() == 2);
        CHECK(sources_type(3)[2].empty());
        CHECK(sources_type{}.empty());
    }
    TEST_CASE("scales stay with their frames and leave the pattern, and ones are none") {
        two_stacks const s;
        auto sources = sources_type::stack(s.K, s.V, 2);
        CHECK_FALSE(sources.is_scaled());
        CHECK(sources.scale(1) == 1);
        sources.set_scales({1, 1.5});
        CHECK(sources.is_scaled());
        CHECK(sources.scale(1) == 1.5);
        CHECK(sources.pattern().meaning == attention_meaning::stack);
        int const other = 0;
        auto const of_others = sources.of_features<int>([&](stack_handle const&) { return &other; });
        CHECK(of_others.scale(1) == 1.5);
        sources.push_back({{&s.K, &s.V, 0}});
        CHECK(sources.scale(1) == 1.5);
        CHECK(sources.scale(2) == 1);
        sources.set_scales({1, 1, 1});
        CHECK_FALSE(sources.is_scaled());
        CHECK(sources.scales().empty());
        CHECK_THROWS_WITH_AS(sources.set_scales({1}), "attention_sources: scales is [1], expected [3]", shape_error);
        CHECK_THROWS_WITH_AS(sources.set_scales({1, 0, 1}),
                             "attention_sources: scales is 0.000000, expected finite and above 0", value_error);
    }
}
