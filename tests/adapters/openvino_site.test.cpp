// SPDX-License-Identifier: MIT
// [GR eq. 3, 5, 6 as a static graph] A module of OpenVINO's models gives what the library's own call gives.
#include <genrender/adapters/openvino_site.hpp>

#include "one_module.hpp"

#include <genrender/adapters/openvino.hpp>

#include <doctest/doctest.h>
#include <openvino/opsets/opset13.hpp>

#include <cstddef>
#include <memory>
#include <vector>

using namespace genrender;
using namespace genrender::testing;

TEST_SUITE("adapters/openvino_site") {
    namespace {

    /// A self-attention module of matrices in OpenVINO.
    struct openvino_module {
        using graph_type = adapters::openvino_graph;
        using value = adapters::openvino_value;

        explicit openvino_module(matrix_module<float> const& m) : module(m) {}

        adapters::openvino_device const& device() const { return processor; }

        value build(adapters::openvino_graph& graph, value const& f) const {
            // docs:begin openvino_model
            auto const site = graph.site({1});
            auto const queries = site.queries(f);
            // Keys are projected of joined tokens, values of keyframes apart and joined then: both are allowed.
            auto const of_keyframes = site.keyframes();
            auto const own = projected(module.W_V, queries);
            auto const values =
                of_keyframes ? site.join(own, projected(module.W_V, *of_keyframes)) : site.join(own, std::nullopt);
            ov::OutputVector inputs{by_head(site.scaled(projected(module.W_Q, queries))),
                                    by_head(projected(module.W_K, site.sources(f))), by_head(values)};
            if (site.mask()) {
                inputs.push_back(*site.mask());
            }
            value const heads = std::make_shared<ov::opset13::ScaledDotProductAttention>(inputs, false);
            auto const s = heads.get_shape();
            auto const by_token = std::make_shared<ov::opset13::Transpose>(heads, numbers({0, 2, 1, 3}));
            return site.output(f, reshaped(by_token, {s[0], s[2], s[1] * s[3]}));
            // docs:end
        }

        static value numbers(std::vector<std::size_t> const& n) {
            return ov::opset13::Constant::create(ov::element::i64, {n.size()}, n);
        }
        static value reshaped(value const& x, std::vector<std::size_t> const& shape) {
            return std::make_shared<ov::opset13::Reshape>(x, numbers(shape), false);
        }
        static value projected(stack<float, 2> const& W, value const& x) {
            auto const matrix = std::make_shared<ov::opset13::Constant>(ov::element::f32,
                                                                        ov::Shape{W.extent(0), W.extent(1)}, W.data());
            return std::make_shared<ov::opset13::MatMul>(x, matrix, false, true);
        }
        value by_head(value const& x) const {
            auto const& s = x.get_shape();
            auto const split = reshaped(x, {s[0], s[1], module.heads(), s[2] / module.heads()});
            return std::make_shared<ov::opset13::Transpose>(split, numbers({0, 2, 1, 3}));
        }

        matrix_module<float> const& module;
        adapters::openvino_device processor;
    };

    } // namespace

    TEST_CASE("[GR eq. 3, 5, 6] a module of OpenVINO's models equals the library's call in every pass") {
        check_every_pass<openvino_module>();
    }

    TEST_CASE("features of OpenVINO in 16 bits differ from the library's by their rounding alone") {
        check_half_precision<openvino_module>();
    }

    TEST_CASE("queries are left as they are where nothing is scaled: a model of OpenVINO has no node for it") {
        adapters::openvino_ports ports;
        adapters::openvino_site const site(graph_pass::injected, {}, nullptr, nullptr, nullptr, ports, "site");
        auto const Q = ports.add_input("Q", ov::Tensor(ov::element::f32, {1, 2, 3}));
        CHECK(site.scaled(Q) == Q);
        CHECK(ports.parameters().size() == 1);
    }

    TEST_CASE("extra inputs and outputs of a model are listed in the order in which they were added") {
        adapters::openvino_ports ports;
        ov::Tensor const tensor(ov::element::f16, {2, 3});
        auto const in = ports.add_input("in", tensor);
        ports.add_output("out", in, ov::Tensor(ov::element::f32, {2, 3}));
        REQUIRE(ports.parameters().size() == 1);
        REQUIRE(ports.results().size() == 1);
        CHECK(in.get_element_type() == ov::element::f16);
        CHECK(in.get_shape() == ov::Shape{2, 3});
        CHECK(ports.results()[0]->input_value(0).get_element_type() == ov::element::f32);
    }
}
