// SPDX-License-Identifier: MIT
// [GR alg. 1: f_KF, F_KF] What is put at a place is found there and nowhere else.
#include <genrender/keyframes/feature_bank.hpp>

#include <genrender/core/parallel.hpp>

#include <doctest/doctest.h>

#include <cstdint>
#include <utility>

using namespace genrender;

namespace {

keyframe_features<int> features(int number) {
    keyframe_features<int> kept;
    kept.F_KF = number;
    return kept;
}

} // namespace

TEST_SUITE("keyframes/feature_bank") {
    TEST_CASE("a new bank holds nothing anywhere") {
        feature_bank<int> const bank(3, 2);
        for (std::uint32_t site = 0; site < 3; ++site) {
            for (std::uint32_t branch = 0; branch < 2; ++branch) {
                CHECK(bank.find({{site}, branch}) == nullptr);
            }
        }
    }

    TEST_CASE("sites and branches are kept apart") {
        feature_bank<int> bank(3, 2);
        for (std::uint32_t site = 0; site < 3; ++site) {
            for (std::uint32_t branch = 0; branch < 2; ++branch) {
                bank.put({{site}, branch}, features(static_cast<int>(10 * site + branch)));
            }
        }
        for (std::uint32_t site = 0; site < 3; ++site) {
            for (std::uint32_t branch = 0; branch < 2; ++branch) {
                auto const* const kept = bank.find({{site}, branch});
                REQUIRE(kept != nullptr);
                CHECK(kept->F_KF == static_cast<int>(10 * site + branch));
            }
        }
    }

    TEST_CASE("a question is noted of its place alone, and moves with the bank") {
        feature_bank<int> bank(2, 2);
        bank.note_question({{1}, 0});
        auto const moved = std::move(bank);
        CHECK(moved.was_asked({{1}, 0}));
        CHECK_FALSE(moved.was_asked({{1}, 1}));
        CHECK_FALSE(moved.was_asked({{0}, 0}));
    }

    TEST_CASE("what is put again replaces all of what was there") {
        feature_bank<int> bank(1, 1);
        keyframe_features<int> first;
        first.f_KF = 1;
        first.K_KF = 2;
        bank.put({}, first);
        bank.put({}, features(7));
        REQUIRE(bank.find({}) != nullptr);
        CHECK_FALSE(bank.find({})->f_KF.has_value());
        CHECK_FALSE(bank.find({})->K_KF.has_value());
        CHECK(bank.find({})->F_KF == 7);
    }

    TEST_CASE("places that do not exist are refused with a sentence") {
        feature_bank<int> bank(3, 2);
        CHECK_THROWS_WITH_AS(bank.find({{3}, 0}),
                             "feature_bank: place is site 3 branch 0, expected 3 sites with 2 branches", value_error);
        CHECK_THROWS_WITH_AS(bank.put({{0}, 2}, {}),
                             "feature_bank: place is site 0 branch 2, expected 3 sites with 2 branches", value_error);
        CHECK_THROWS_AS(bank.find({{0xFFFFFFFFU}, 0xFFFFFFFFU}), value_error);
        feature_bank<int> const none(3, 0);
        CHECK_THROWS_WITH_AS(none.find({}), "feature_bank: place is site 0 branch 0, expected 3 sites with 0 branches",
                             value_error);
    }

    TEST_CASE("different places may be filled at the same time") {
        feature_bank<int> bank(40, 2);
        threaded_loop{4}(80, [&](std::size_t at) {
            bank.put({{static_cast<std::uint32_t>(at / 2)}, static_cast<std::uint32_t>(at % 2)},
                     features(static_cast<int>(at)));
        });
        for (std::uint32_t at = 0; at < 80; ++at) {
            REQUIRE(bank.find({{at / 2}, at % 2}) != nullptr);
            CHECK(bank.find({{at / 2}, at % 2})->F_KF == static_cast<int>(at));
        }
    }
}
