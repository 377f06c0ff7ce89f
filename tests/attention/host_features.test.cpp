// SPDX-License-Identifier: MIT
// Handles of features: who owns, who borrows, and that copies share.
#include <genrender/attention/host_features.hpp>

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <concepts>
#include <memory>
#include <type_traits>
#include <utility>
#include <vector>

using namespace genrender;

TEST_SUITE("attention/host_features") {
    TEST_CASE_TEMPLATE("new features are zeros that the handle owns", Real, float, double) {
        auto const features = host_features<Real>::allocate({2, 3, 4});
        CHECK(features.extents() == std::array<std::size_t, 3>{2, 3, 4});
        CHECK(features.view().is_contiguous());
        CHECK_FALSE(features.is_borrowed());
        bool all_zero = true;
        for (std::size_t e = 0; e < 24; ++e) {
            all_zero = all_zero && features.view().data()[e] == Real{0};
        }
        CHECK(all_zero);
    }

    TEST_CASE("copies share the elements and keep them alive") {
        host_features<float> kept;
        {
            auto const features = host_features<float>::allocate({1, 2, 2});
            kept = features;
            features.view()(0, 1, 1) = 8;
        }
        CHECK(kept.view()(0, 1, 1) == 8);
        CHECK(std::copyable<host_features<float>>);
    }

    TEST_CASE("borrowed features read the engine's memory through its strides") {
        // Channel-major: [tokens, channels] with tokens next to each other.
        std::vector<float> engine{0, 1, 2, 10, 11, 12};
        host_features<float> const features(strided_view<float, 3>(engine.data(), {1, 3, 2}, {6, 1, 3}));
        CHECK(features.is_borrowed());
        CHECK(features.view()(0, 2, 1) == 12);
        features.view()(0, 0, 1) = -1;
        CHECK(engine[3] == -1);
    }

    TEST_CASE("shared memory lives as long as the last handle") {
        auto memory = std::make_shared<std::vector<float>>(4, 3.0F);
        std::weak_ptr<std::vector<float>> const watched = memory;
        {
            host_features<float> const first(strided_view<float, 3>(memory->data(), {1, 2, 2}), memory);
            auto const second = first;
            memory.reset();
            CHECK_FALSE(watched.expired());
            CHECK(second.view()(0, 1, 1) == 3);
            CHECK_FALSE(second.is_borrowed());
        }
        CHECK(watched.expired());
    }

    TEST_CASE("a handle converts to views and a view does not silently become a handle") {
        CHECK(std::is_convertible_v<host_features<float> const&, strided_view<float, 3>>);
        CHECK(std::is_convertible_v<host_features<float> const&, strided_view<float const, 3>>);
        CHECK_FALSE(std::is_convertible_v<strided_view<float, 3>, host_features<float>>);
        CHECK_FALSE(std::is_constructible_v<strided_view<double const, 3>, host_features<float>&>);
        CHECK(host_features<float>().view().size() == 0);
    }

    TEST_CASE_TEMPLATE("features are kept in 16 bits to half a unit in the last place", Real, float, double) {
        auto const f = host_features<Real>::allocate({2, 5, 3});
        for (std::size_t e = 0; e < 30; ++e) {
            f.view().data()[e] =
                std::ldexp(Real(1) + Real(e) / 31, static_cast<int>(e % 9) - 4) * (e % 2 == 0 ? 1 : -1);
        }
        for (auto const& [storage, unit] :
             {std::pair(feature_storage::f16, 0x1p-11), {feature_storage::bf16, 0x1p-8}}) {
            auto const kept = host_features<Real>::rounded(f.view(), storage);
            CHECK(kept.storage() == storage);
            CHECK(kept.extents() == f.extents());
            CHECK_FALSE(kept.is_borrowed());
            std::size_t exact = 0;
            kept.visit([&, u = unit](auto const& view) {
                for (std::size_t e = 0; e < 30; ++e) {
                    auto const was = static_cast<double>(f.view().data()[e]);
                    auto const is = static_cast<double>(view.data()[e]);
                    CHECK(std::abs(is - was) <= u * std::abs(was));
                    exact += is == was ? 1U : 0U;
                }
            });
            CHECK(exact < 10); // they were rounded
        }
    }

    TEST_CASE("a copy in the same format is new memory with the same values") {
        auto const f = host_features<float>::allocate({1, 2, 2});
        f.view()(0, 1, 0) = 3;
        auto const kept = host_features<float>::rounded(f.view(), feature_storage::same);
        CHECK(kept.storage() == feature_storage::same);
        CHECK(kept.view().data() != f.view().data());
        CHECK(kept.view()(0, 1, 0) == 3);
    }
}
