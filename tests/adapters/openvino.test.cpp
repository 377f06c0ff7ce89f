// SPDX-License-Identifier: MIT
// [GR eq. 3, 5, 6 as a static graph] A module of OpenVINO's models gives what the library's own call gives.
#include <genrender/adapters/openvino.hpp>

#include "one_module.hpp"

#include <doctest/doctest.h>
#include <openvino/openvino.hpp>
#include <openvino/opsets/opset13.hpp>

#include <algorithm>
#include <cstddef>
#include <map>
#include <memory>
#include <utility>

using namespace genrender;
using namespace genrender::testing;

TEST_SUITE("adapters/openvino") {
    namespace {

    /// Models of one module, one for each pass and number of frames.
    struct openvino_module {
        using features_type = adapters::openvino_features;
        using value = adapters::openvino_value;

        openvino_module(run_shapes const& shapes, std::span<attention_site const> sites, matrix_module<float> const& m)
            : module(m), io(shapes, sites) {}

        // docs:begin openvino_call
        template <class Processor>
        stack<float, 3> operator()(Processor const& processor, attention_place place,
                                   std::span<frame_index const> frames, stack<float, 3> const& f) {
            auto const pass = io.pass_of(processor, frames);
            auto& request = requests[{pass, frames.size()}];
            if (!request) {
                request = build(place, pass, f);
            }
            ov::Tensor in = request.get_tensor("f");
            std::copy_n(f.data(), f.size(), in.data<float>());
            io.write(processor, pass, place.branch, frames);
            request.infer();
            io.record(processor, place.branch, frames);
            ov::Tensor const out = request.get_tensor("F");
            stack<float, 3> F(f.extents());
            std::copy_n(out.data<float>(), F.size(), F.data());
            return F;
        }
        // docs:end

        ov::InferRequest build(attention_place place, graph_pass pass, stack<float, 3> const& f) {
            adapters::openvino_ports ports;
            auto const in = std::make_shared<ov::opset13::Parameter>(ov::element::f32,
                                                                     ov::Shape{f.extent(0), f.extent(1), f.extent(2)});
            in->output(0).set_names({"f"});
            // docs:begin openvino_model
            auto const site = io.site(place, pass, f.extent(0), ports);
            auto const queries = site.queries(in);
            // Keys are projected of joined tokens, values of keyframes apart and joined then: both are allowed.
            auto const of_keyframes = site.keyframes();
            auto const own = projected(module.W_V, queries);
            auto const values =
                of_keyframes ? site.join(own, projected(module.W_V, *of_keyframes)) : site.join(own, std::nullopt);
            ov::OutputVector inputs{by_head(projected(module.W_Q, queries)),
                                    by_head(projected(module.W_K, site.sources(in))), by_head(values)};
            if (site.mask()) {
                inputs.push_back(*site.mask());
            }
            value const heads = std::make_shared<ov::opset13::ScaledDotProductAttention>(inputs, false);
            auto const s = heads.get_shape();
            auto const by_token = std::make_shared<ov::opset13::Transpose>(heads, numbers({0, 2, 1, 3}));
            auto const F = std::make_shared<ov::opset13::Convert>(
                site.output(in, reshaped(by_token, {s[0], s[2], s[1] * s[3]})), ov::element::f32);
            F->output(0).set_names({"F"});
            ov::ParameterVector parameters{in};
            parameters.insert(parameters.end(), ports.parameters().begin(), ports.parameters().end());
            ov::ResultVector results{std::make_shared<ov::opset13::Result>(F)};
            results.insert(results.end(), ports.results().begin(), ports.results().end());
            auto compiled = core.compile_model(std::make_shared<ov::Model>(results, parameters), "CPU",
                                               ov::hint::inference_precision(ov::element::f32));
            auto request = compiled.create_infer_request();
            ports.bind(request);
            // docs:end
            return request;
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
        ov::Core core;
        adapters::openvino_feature_io io;
        std::map<std::pair<graph_pass, std::size_t>, ov::InferRequest> requests;
    };

    } // namespace

    TEST_CASE("[GR eq. 3, 5, 6] a module of OpenVINO's models equals the library's call in every pass") {
        for (auto const pre : {true, false}) {
            for (auto const post : {true, false}) {
                for (auto const keeps : {true, false}) {
                    auto const apart = compare_module<openvino_module>({pre, post, keeps});
                    CHECK(apart.plain <= 1e-6);
                    CHECK(apart.keyframe <= 1e-6);
                    CHECK(apart.injected <= 1e-6);
                    CHECK(apart.second_step <= 1e-6);
                }
            }
        }
    }

    TEST_CASE("features in 16 bits differ from the library's by their rounding alone") {
        for (auto const storage : {feature_storage::f16, feature_storage::bf16}) {
            auto const apart = compare_module<openvino_module>({true, true, false, storage});
            CHECK(apart.keyframe <= 1e-6);
            CHECK(apart.injected > 0);
            CHECK(apart.injected <= (storage == feature_storage::f16 ? 2e-3 : 2e-2));
        }
    }

    TEST_CASE("runs that static graphs cannot do are refused before they begin") {
        run_shapes shapes;
        CHECK_THROWS_WITH_AS(adapters::openvino_feature_io(shapes, {}), doctest::Contains("shapes.lists_sources"),
                             value_error);
        shapes.lists_sources = false;
        shapes.banks = 2;
        CHECK_THROWS_WITH_AS(adapters::openvino_feature_io(shapes, {}), doctest::Contains("one bank"), value_error);
    }
}
