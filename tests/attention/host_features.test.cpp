// SPDX-License-Identifier: MIT
// Handles of features: who owns, who borrows, and that copies share.
#include <genrender/attention/host_features.hpp>

#include <doctest/doctest.h>

#include <array>
#include <concepts>
#include <memory>
#include <type_traits>
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
}
