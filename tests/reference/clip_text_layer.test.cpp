// SPDX-License-Identifier: MIT
// Tests of a layer of the text encoder.
#include <genrender/reference/clip_text_layer.hpp>

#include "small_networks.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <string>
#include <vector>

using namespace genrender;

using namespace genrender::reference;
using namespace genrender::testing;

TEST_SUITE("reference/clip_text_layer") {
    clip_text_config small_text_config(clip_activation activation) {
        clip_text_config config;
        config.hidden_size = 12;
        config.intermediate_size = 20;
        config.num_attention_heads = 3;
        config.hidden_act = activation;
        return config;
    }

    /// LayerNorm with scales of 1 by its definition.
    template <class Real>
    stack<Real, 2> plain_layer_norm(in_view<Real, 2> in, std::vector<Real> const& bias) {
        stack<Real, 2> out(in.extents());
        auto const count = static_cast<double>(in.extent(1));
        for (std::size_t t = 0; t < in.extent(0); ++t) {
            double mean = 0;
            double squares = 0;
            for (std::size_t c = 0; c < in.extent(1); ++c) {
                mean += static_cast<double>(in(t, c)) / count;
            }
            for (std::size_t c = 0; c < in.extent(1); ++c) {
                squares += std::pow(static_cast<double>(in(t, c)) - mean, 2) / count;
            }
            for (std::size_t c = 0; c < in.extent(1); ++c) {
                out(t, c) = static_cast<Real>((static_cast<double>(in(t, c)) - mean) / std::sqrt(squares + 1e-5) +
                                              static_cast<double>(bias[c]));
            }
        }
        return out;
    }

    /// Softmax over the keys up to the query's own, by its definition, in three heads of four channels.
    template <class Real>
    stack<Real, 2> plain_causal_attention(in_view<Real, 2> Q, in_view<Real, 2> K, in_view<Real, 2> V) {
        stack<Real, 2> out(Q.extents());
        for (std::size_t t = 0; t < Q.extent(0); ++t) {
            for (std::size_t head = 0; head < 3; ++head) {
                std::vector<double> weights;
                double sum = 0;
                for (std::size_t key = 0; key <= t; ++key) {
                    double product = 0;
                    for (std::size_t c = 4 * head; c < 4 * head + 4; ++c) {
                        product += static_cast<double>(Q(t, c)) * static_cast<double>(K(key, c));
                    }
                    weights.push_back(std::exp(product / 2));
                    sum += weights.back();
                }
                for (std::size_t c = 4 * head; c < 4 * head + 4; ++c) {
                    double value = 0;
                    for (std::size_t key = 0; key <= t; ++key) {
                        value += weights[key] / sum * static_cast<double>(V(key, c));
                    }
                    out(t, c) = static_cast<Real>(value);
                }
            }
        }
        return out;
    }

    TEST_CASE_TEMPLATE("a layer is causal attention and an MLP, each added to its input", Real, float, double) {
        for (auto const activation : {clip_activation::quick_gelu, clip_activation::gelu}) {
            auto source = weights<Real>::seeded(1, "test");
            clip_text_layer<Real> const layer(small_text_config(activation), source, "l");
            auto h = random_stack<Real, 2>({7, 12}, 3);
            auto expected = h;
            auto const of = [&](std::string const& name, in_view<Real, 2> in, std::size_t out) {
                return plain_linear<Real>(in, source.take("l." + name + ".weight", {out, in.extent(1)}),
                                          source.take("l." + name + ".bias", {out}), out);
            };
            auto const add = [](stack<Real, 2>& to, stack<Real, 2> const& from) {
                for (std::size_t i = 0; i < to.size(); ++i) {
                    to.data()[i] += from.data()[i];
                }
            };
            auto const normed = plain_layer_norm<Real>(expected, source.take("l.layer_norm1.bias", {12}));
            auto const attended =
                plain_causal_attention<Real>(of("self_attn.q_proj", normed, 12), of("self_attn.k_proj", normed, 12),
                                             of("self_attn.v_proj", normed, 12));
            add(expected, of("self_attn.out_proj", attended, 12));
            auto between = of("mlp.fc1", plain_layer_norm<Real>(expected, source.take("l.layer_norm2.bias", {12})), 20);
            for (std::size_t i = 0; i < between.size(); ++i) {
                auto const x = static_cast<double>(between.data()[i]);
                between.data()[i] =
                    static_cast<Real>(activation == clip_activation::gelu ? x * 0.5 * std::erfc(-x / std::sqrt(2.0))
                                                                          : x / (1 + std::exp(-1.702 * x)));
            }
            add(expected, of("mlp.fc2", between, 12));
            layer(h.view());
            check_close<Real, 2>(h.view(), expected);
        }
    }

    TEST_CASE("features of other channels are told") {
        auto source = weights<float>::seeded(1, "test");
        clip_text_layer<float> const layer(small_text_config(clip_activation::gelu), source, "l");
        stack<float, 2> h({2, 8});
        CHECK_THROWS_WITH_AS(layer(h.view()), "clip_text_layer: h is [2, 8], expected [2, 12]", shape_error);
    }
}
