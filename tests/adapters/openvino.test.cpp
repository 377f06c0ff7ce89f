// SPDX-License-Identifier: MIT
// Models of OpenVINO are compiled once and run often; a denoiser of them gives the clean estimate.
#include <genrender/adapters/openvino.hpp>

#include "one_module.hpp"

#include <doctest/doctest.h>
#include <openvino/opsets/opset13.hpp>

#include <cstddef>
#include <memory>

using namespace genrender;
using namespace genrender::testing;

TEST_SUITE("adapters/openvino") {
    using adapters::openvino_graph;
    using adapters::openvino_value;

    TEST_CASE("inputs and output of a model go by name and must fit") {
        check_inputs_and_output<openvino_graph>(
            {}, [](openvino_graph&, openvino_value const& x) { return std::make_shared<ov::opset13::Add>(x, x); });
    }

    TEST_CASE("an output of 16 bits is read as floats") {
        check_inputs_and_output<openvino_graph>({}, [](openvino_graph&, openvino_value const& x) {
            return std::make_shared<ov::opset13::Convert>(std::make_shared<ov::opset13::Add>(x, x), ov::element::f16);
        });
    }

    TEST_CASE("two inputs of one name are refused") {
        run_shapes shapes;
        shapes.lists_sources = false;
        auto const io = openvino_graph::make_feature_io({}, shapes, {});
        openvino_graph graph({}, *io, {});
        graph.add_input("x", {1});
        CHECK_THROWS_WITH_AS(graph.add_input("x", {2}), doctest::Contains("name is x"), value_error);
    }

    TEST_CASE("[EDM eq. 7] a denoiser of OpenVINO's models gives the guided estimate in either layout") {
        check_denoiser<openvino_graph>({}, [](openvino_graph&, openvino_value const& a, openvino_value const& b) {
            return std::make_shared<ov::opset13::Add>(a, b);
        });
    }

    TEST_CASE("runs that OpenVINO's models cannot do are refused before they begin") {
        check_refused_runs<openvino_graph>({});
    }

    static_assert(preparable_denoiser<adapters::openvino_denoiser>);
}
