// SPDX-License-Identifier: MIT
// Tests of the projections of attention.
#include <genrender/reference/attention_matrices.hpp>

#include "small_networks.hpp"

#include <genrender/injection/host_attention_call.hpp>

#include <doctest/doctest.h>

using namespace genrender;

using namespace genrender::reference;
using namespace genrender::testing;

static_assert(attention_projections<attention_matrices<float>, float>);
static_assert(attention_projections<attention_matrices<double>, double>);

TEST_SUITE("reference/attention_matrices") {
    TEST_CASE_TEMPLATE("[GR eq. 2] queries keys and values are products with their matrices", Real, float, double) {
        auto source = weights<Real>::seeded(1, "test");
        attention_matrices<Real> const module(source, "attn2", 4, 6, 2);
        CHECK(module.heads() == 2);
        CHECK(module.channels() == 4);
        auto const f = random_stack<Real, 2>({5, 4}, 1);
        auto const tokens = random_stack<Real, 2>({3, 6}, 2);
        stack<Real, 2> Q({5, 4});
        stack<Real, 2> K({3, 4});
        stack<Real, 2> V({3, 4});
        module.query(Q.view(), f);
        module.key(K.view(), tokens);
        module.value(V.view(), tokens);
        check_close<Real, 2>(Q.view(), plain_linear<Real>(f, source.take("attn2.to_q.weight", {4, 4}), {}, 4));
        check_close<Real, 2>(K.view(), plain_linear<Real>(tokens, source.take("attn2.to_k.weight", {4, 6}), {}, 4));
        check_close<Real, 2>(V.view(), plain_linear<Real>(tokens, source.take("attn2.to_v.weight", {4, 6}), {}, 4));
    }

    TEST_CASE_TEMPLATE("the output is added to the residual", Real, float, double) {
        auto source = weights<Real>::seeded(1, "test");
        attention_matrices<Real> const module(source, "attn1", 4, 4, 2);
        auto const F = random_stack<Real, 2>({5, 4}, 1);
        auto h = random_stack<Real, 2>({5, 4}, 2);
        auto expected = h;
        module.add_output(h.view(), F);
        auto const out = plain_linear<Real>(F, source.take("attn1.to_out.0.weight", {4, 4}),
                                            source.take("attn1.to_out.0.bias", {4}), 4);
        add_scaled(expected.view(), out);
        check_close<Real, 2>(h.view(), expected);
    }
}
