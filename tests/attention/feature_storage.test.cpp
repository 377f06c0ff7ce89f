// SPDX-License-Identifier: MIT
// Formats of kept features: bytes, who can keep them, who cannot.
#include <genrender/attention/feature_storage.hpp>

#include <genrender/injection/host_attention_call.hpp>

#include "support/matrix_module.hpp"

#include <doctest/doctest.h>

#include <array>
#include <vector>

using namespace genrender;

namespace {

using call_type = host_attention_call<float, testing::matrix_module<float>>;
using foreign_call = attention_call_archetype<int, float>;

} // namespace

TEST_SUITE("attention/feature_storage") {
    TEST_CASE("a kept value takes its format's bytes") {
        CHECK(feature_bytes<float>(feature_storage::same) == 4);
        CHECK(feature_bytes<double>(feature_storage::same) == 8);
        CHECK(feature_bytes<double>(feature_storage::f16) == 2);
        CHECK(feature_bytes<float>(feature_storage::bf16) == 2);
    }
    TEST_CASE("calls of host memory store features and an engine's need not") {
        CHECK(storing_attention_call<call_type>);
        CHECK(attention_call<foreign_call>);
        CHECK_FALSE(storing_attention_call<foreign_call>);
    }
    TEST_CASE("features stay the same handle unless another format is asked for") {
        testing::matrix_module<float> const module(2, 1, 1);
        std::array const frames{frame_index{0}};
        auto const f = host_features<float>::allocate({1, 3, 2});
        f.view()(0, 1, 1) = 1.0F + 0x1p-9F;
        call_type call({}, frames, f, module);
        CHECK(stored_features(call, f, feature_storage::same).view().data() == f.view().data());
        CHECK(stored_features(call, f, feature_storage::f16).storage() == feature_storage::f16);
    }
    TEST_CASE_TEMPLATE("features of host memory need no call to be stored", Real, float, double) {
        CHECK(storable_features<host_features<Real>>);
        CHECK_FALSE(storable_features<int>);
        testing::matrix_module<Real> const module(2, 1, 1);
        std::array const frames{frame_index{0}};
        auto const f = host_features<Real>::allocate({1, 2, 2});
        f.view()(0, 1, 1) = Real(1) + Real(0x1p-9);
        host_attention_call<Real, testing::matrix_module<Real>> const call({}, frames, f, module);
        CHECK(stored_features(f, feature_storage::same).view().data() == f.view().data());
        for (auto const storage : {feature_storage::f16, feature_storage::bf16}) {
            auto const kept = stored_features(f, storage);
            CHECK(kept.storage() == storage);
            call.stored(f, storage).visit([&](auto const& expected) {
                kept.visit([&](auto const& found) {
                    CHECK(static_cast<float>(found(0, 1, 1)) == static_cast<float>(expected(0, 1, 1)));
                    CHECK(static_cast<float>(found(0, 1, 1)) == (storage == feature_storage::f16 ? 1 + 0x1p-9F : 1));
                });
            });
        }
    }
    TEST_CASE("features of 16 bits stay as they are or go over to the other format") {
        auto f = host_features<float>::allocate({1, 1, 2});
        f.view()(0, 0, 0) = 1 + 0x1p-9F;
        f.view()(0, 0, 1) = -3;
        auto const half = stored_features(f, feature_storage::f16);
        auto const value = [](host_features<float> const& of, std::size_t c) {
            return of.visit([&](auto const& view) { return static_cast<float>(view(0, 0, c)); });
        };
        auto const same = stored_features(half, feature_storage::f16);
        CHECK(same.storage() == feature_storage::f16);
        CHECK(value(same, 0) == 1 + 0x1p-9F);
        auto const other = stored_features(half, feature_storage::bf16);
        CHECK(other.storage() == feature_storage::bf16);
        CHECK(value(other, 0) == 1);
        CHECK(value(other, 1) == -3);
    }
    TEST_CASE("features that cannot be stored are refused") {
        CHECK(stored_features(5, feature_storage::same) == 5);
        CHECK_THROWS_WITH_AS(stored_features(5, feature_storage::bf16),
                             "stored_features: storage is of 16 bits, expected feature_storage::same for features "
                             "without `stored`",
                             value_error);
    }
    TEST_CASE("a format that the engine cannot store is refused") {
        auto const store = [](feature_storage storage) {
            foreign_call call; // nothing of it is called
            return stored_features(call, 5, storage);
        };
        CHECK(store(feature_storage::same) == 5);
        CHECK_THROWS_WITH_AS(store(feature_storage::f16),
                             "stored_features: storage is of 16 bits, expected feature_storage::same for an attention "
                             "call without `stored`",
                             value_error);
    }
}
