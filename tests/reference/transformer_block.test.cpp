// SPDX-License-Identifier: MIT
// Tests of the transformer block.
#include <genrender/reference/transformer_block.hpp>

#include "small_networks.hpp"

#include <doctest/doctest.h>

using namespace genrender;

using namespace genrender::reference;
using namespace genrender::testing;

namespace {

/// Keeps the handle of f that it was given, and returns ones instead of attending.
struct ones_attention {
    host_features<double>* f;
    attention_place* place;

    template <attention_call Call>
    typename Call::features_type operator()(Call& call) const {
        auto const F = Call::features_type::allocate(call.f().extents());
        if constexpr (std::is_same_v<typename Call::real_type, double>) {
            *f = call.f();
            *place = call.place();
            for (std::size_t e = 0; e < F.view().size(); ++e) {
                F.view().data()[e] = 1;
            }
        }
        return F;
    }
};

/// Multi-head attention by its definition.
template <class Real>
stack<Real, 2> plain_attend(in_view<Real, 2> Q, in_view<Real, 2> K, in_view<Real, 2> V, std::size_t heads) {
    stack<Real, 2> F(Q.extents());
    auto const size = Q.extent(1) / heads;
    for (std::size_t q = 0; q < Q.extent(0); ++q) {
        for (std::size_t head = 0; head < heads; ++head) {
            double total = 0;
            std::vector<double> sums(size);
            for (std::size_t k = 0; k < K.extent(0); ++k) {
                double logit = 0;
                for (std::size_t c = head * size; c < (head + 1) * size; ++c) {
                    logit += static_cast<double>(Q(q, c)) * static_cast<double>(K(k, c));
                }
                auto const weight = std::exp(logit / std::sqrt(static_cast<double>(size)));
                total += weight;
                for (std::size_t c = 0; c < size; ++c) {
                    sums[c] += weight * static_cast<double>(V(k, head * size + c));
                }
            }
            for (std::size_t c = 0; c < size; ++c) {
                F(q, head * size + c) = static_cast<Real>(sums[c] / total);
            }
        }
    }
    return F;
}

} // namespace

TEST_SUITE("reference/transformer_block") {
    TEST_CASE_TEMPLATE(
        "[GR eq. 1] a block adds self-attention then attention to the prompt then its feed-forward layer", Real, float,
        double) {
        auto const config = small_config();
        auto source = weights<Real>::seeded(1, "test");
        site_list sites({4, 4});
        transformer_block<Real> const block(config, source, sites, "t", 0, network_part::encoder);
        layer_norm<Real> const norm1(source, "t.norm1", 8);
        layer_norm<Real> const norm2(source, "t.norm2", 8);
        layer_norm<Real> const norm3(source, "t.norm3", 8);
        feed_forward<Real> const ff(source, "t.ff", 8);
        small_pass<Real> const small;
        auto const x = random_maps<Real>(2, {4, 4}, 8, 2);
        auto h = x;
        block(small.pass, h);
        for (std::size_t i = 0; i < 2; ++i) {
            stack<Real, 2> expected({16, 8});
            copy(expected.view(), x[i]);
            auto const attend = [&](std::string const& name, in_view<Real, 2> f, in_view<Real, 2> from) {
                auto const of = [&](char const* matrix, in_view<Real, 2> in) {
                    return plain_linear<Real>(in, source.take(name + matrix, {8, in.extent(1)}), {}, 8);
                };
                auto const F =
                    plain_attend<Real>(of(".to_q.weight", f), of(".to_k.weight", from), of(".to_v.weight", from), 2);
                auto const out = plain_linear<Real>(F, source.take(name + ".to_out.0.weight", {8, 8}),
                                                    source.take(name + ".to_out.0.bias", {8}), 8);
                add_scaled(expected.view(), out);
            };
            stack<Real, 2> normed({16, 8});
            norm1(normed.view(), expected);
            attend("t.attn1", normed, normed);
            norm2(normed.view(), expected);
            attend("t.attn2", normed, small.prompt);
            norm3(normed.view(), expected);
            ff.add_to(expected.view(), normed);
            check_close<Real, 2>(h[i], expected);
        }
    }

    TEST_CASE("the processor is told the place and gets the normalised features and its result is used") {
        auto const config = small_config();
        auto source = weights<double>::seeded(1, "test");
        site_list sites({4, 4});
        sites.add("other", network_part::encoder, 0, 8);
        transformer_block<double> const block(config, source, sites, "t", 0, network_part::decoder);
        layer_norm<double> const norm1(source, "t.norm1", 8);
        CHECK(sites.sites()[1].name == "t.attn1");
        host_features<double> f;
        attention_place place;
        ones_attention ones{&f, &place};
        small_pass<double> small;
        forward_pass<double> const pass{small.frames, 1, small.prompt.view(), ones, small.loop};
        auto const x = random_maps<double>(2, {4, 4}, 8, 2);
        auto with_ones = x;
        block(pass, with_ones);
        CHECK(place == attention_place{{1}, 1});
        stack<double, 2> normed({16, 8});
        norm1(normed.view(), x[1]);
        check_close<double, 2>(f.view()[1], normed);
        auto plain = x;
        block(small.pass, plain);
        CHECK(plain[0](0, 0) != with_ones[0](0, 0));
    }
}
