// SPDX-License-Identifier: MIT
// Tests of the gated feed-forward layer.
#include <genrender/reference/feed_forward.hpp>

#include "small_networks.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

using namespace genrender;

using namespace genrender::reference;
using namespace genrender::testing;

TEST_SUITE("reference/feed_forward") {
    TEST_CASE_TEMPLATE("the second half of the hidden channels gates the first", Real, float, double) {
        auto source = weights<Real>::seeded(1, "test");
        feed_forward<Real> const layer(source, "ff", 3);
        auto const x = random_stack<Real, 2>({4, 3}, 1);
        auto const hidden = plain_linear<Real>(x, source.take("ff.net.0.proj.weight", {24, 3}),
                                               source.take("ff.net.0.proj.bias", {24}), 24);
        stack<Real, 2> gated({4, 12});
        for (std::size_t token = 0; token < 4; ++token) {
            for (std::size_t c = 0; c < 12; ++c) {
                auto const gate = static_cast<double>(hidden(token, 12 + c));
                gated(token, c) = static_cast<Real>(static_cast<double>(hidden(token, c)) * gate * 0.5 *
                                                    std::erfc(-gate / std::sqrt(2.0)));
            }
        }
        auto expected =
            plain_linear<Real>(gated, source.take("ff.net.2.weight", {3, 12}), source.take("ff.net.2.bias", {3}), 3);
        add_scaled(expected.view(), x);
        auto h = x;
        layer.add_to(h.view(), x);
        check_close<Real, 2>(h.view(), expected);
    }

    TEST_CASE_TEMPLATE("a token is the same to the bit in any company and on any number of threads", Real, float,
                       double) {
        auto source = weights<Real>::seeded(1, "test");
        feed_forward<Real> const layer(source, "ff", 4);
        auto const x = random_stack<Real, 2>({1500, 4}, 1);
        auto alone = x;
        auto shared = x;
        layer.add_to(alone.view(), x);
        layer.add_to(shared.view(), x, threaded_loop(3));
        CHECK(std::equal(alone.data(), alone.data() + alone.size(), shared.data()));
        auto some = random_stack<Real, 2>({1500, 4}, 1);
        layer.add_to(some.view().slice(700, 9), x.view().slice(700, 9));
        CHECK(std::equal(&some(700, 0), &some(709, 0), &alone(700, 0)));
    }
}
