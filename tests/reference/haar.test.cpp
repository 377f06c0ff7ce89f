// SPDX-License-Identifier: MIT
// Tests of the Haar transform.
#include <genrender/reference/haar.hpp>

#include <genrender/testing/random_stack.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <limits>

using namespace genrender;

using namespace genrender::reference;
using genrender::testing::random_stack;

TEST_SUITE("reference/haar") {
    TEST_CASE_TEMPLATE("decoding undoes encoding and encoding undoes decoding", Real, float, double) {
        auto const image = random_stack<Real, 3>({3, 6, 8}, 1);
        stack<Real, 3> latent({12, 3, 4});
        stack<Real, 3> decoded({3, 6, 8});
        haar_encode(latent.view(), image);
        haar_decode(decoded.view(), latent);
        stack<Real, 3> again({12, 3, 4});
        haar_encode(again.view(), decoded);
        auto const bound = 30 * static_cast<double>(std::numeric_limits<Real>::epsilon());
        for (std::size_t e = 0; e < image.size(); ++e) {
            CHECK(std::abs(static_cast<double>(decoded.data()[e] - image.data()[e])) < bound);
            CHECK(std::abs(static_cast<double>(again.data()[e] - latent.data()[e])) < 3 * bound);
        }
    }

    TEST_CASE_TEMPLATE("the transform of a square keeps its energy and is its own inverse", Real, float, double) {
        auto const x = random_stack<Real, 1>({4}, 2);
        auto const bands = internal::haar_square(x(0), x(1), x(2), x(3));
        auto const back = internal::haar_square(bands[0], bands[1], bands[2], bands[3]);
        double before = 0;
        double after = 0;
        for (std::size_t i = 0; i < 4; ++i) {
            before += static_cast<double>(x(i) * x(i));
            after += static_cast<double>(bands[i] * bands[i]);
            CHECK(static_cast<double>(back[i]) == doctest::Approx(static_cast<double>(x(i))).epsilon(1e-5));
        }
        CHECK(after == doctest::Approx(before));
    }

    TEST_CASE_TEMPLATE("a worked example", Real, float, double) {
        // Red is white on the left and black on the right; green is white on top; blue is white on one diagonal.
        stack<Real, 3> image({3, 2, 2});
        image(0, 0, 0) = image(0, 1, 0) = 1;
        image(1, 0, 0) = image(1, 0, 1) = 1;
        image(2, 0, 0) = image(2, 1, 1) = 1;
        stack<Real, 3> latent({12, 1, 1});
        haar_encode(latent.view(), image);
        for (std::size_t channel = 0; channel < 12; ++channel) {
            auto const expected = channel < 3                                     ? 1.05 * -0.38
                                  : channel == 3 || channel == 7 || channel == 11 ? 4.5 * 2
                                                                                  : 0.0;
            CHECK(static_cast<double>(latent(channel, 0, 0)) == doctest::Approx(expected));
        }
    }

    TEST_CASE("extents that do not fit are refused") {
        stack<float, 3> latent({12, 2, 2});
        CHECK_THROWS_WITH_AS(haar_encode(latent.view(), stack<float, 3>({3, 5, 4})),
                             "haar_encode: height of image is 5, expected an even number", value_error);
        CHECK_THROWS_WITH_AS(haar_encode(latent.view(), stack<float, 3>({3, 4, 6})),
                             "haar_encode: latent is [12, 2, 2], expected [12, 2, 3]", shape_error);
        stack<float, 3> image({3, 4, 4});
        CHECK_THROWS_WITH_AS(haar_decode(image.view(), stack<float, 3>({10, 2, 2})),
                             "haar_decode: channels of latent is 10, expected a multiple of 4", value_error);
        CHECK_THROWS_WITH_AS(haar_decode(image.view(), stack<float, 3>({12, 2, 3})),
                             "haar_decode: image is [3, 4, 4], expected [3, 4, 6]", shape_error);
    }
}
