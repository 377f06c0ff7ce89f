// SPDX-License-Identifier: MIT
// The operations of the small network as nodes of an OpenVINO model; features are [frames, tokens, channels].
#pragma once

#include "../static_graph/network.hpp"

#include <genrender/adapters/openvino.hpp>

#include <openvino/opsets/opset13.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>

namespace genrender::examples {

/// Makes nodes of a graph.
struct openvino_operations {
    using value = adapters::openvino_value;
    adapters::openvino_graph& graph;

    template <class Node, class... Arguments>
    static value make(Arguments&&... arguments) {
        return std::make_shared<Node>(std::forward<Arguments>(arguments)...);
    }
    static value numbers(std::vector<std::int64_t> const& n) {
        return ov::opset13::Constant::create(ov::element::i64, {n.size()}, n);
    }
    static value reshaped(value const& x, ov::Shape const& shape) {
        return make<ov::opset13::Reshape>(x, ov::opset13::Constant::create(ov::element::i64, {shape.size()}, shape),
                                          false);
    }

    value linear(layer_weights const& w, value const& x) const {
        auto const matrix = ov::opset13::Constant::create(ov::element::f32, {w.outputs, w.inputs}, w.values);
        return make<ov::opset13::MatMul>(x, matrix, false, true);
    }
    value add(value const& a, value const& b) const { return make<ov::opset13::Add>(a, b); }
    value silu(value const& x) const { return make<ov::opset13::Swish>(x); }
    value normalized(value const& x) const {
        return make<ov::opset13::MVN>(x, numbers({2}), true, small_unet::epsilon, ov::op::MVNEpsMode::INSIDE_SQRT);
    }
    value pooled(value const& x, grid_extents from) const {
        auto const& s = x.get_shape();
        auto const cells = reshaped(x, {s[0], from.height / 2, 2, from.width / 2, 2, s[2]});
        return reshaped(make<ov::opset13::ReduceMean>(cells, numbers({2, 4}), false), {s[0], s[1] / 4, s[2]});
    }
    value enlarged(value const& x, grid_extents from) const {
        auto const& s = x.get_shape();
        auto const cells = reshaped(x, {s[0], from.height, 1, from.width, 1, s[2]});
        return reshaped(make<ov::opset13::Tile>(cells, numbers({1, 1, 2, 1, 2, 1})), {s[0], 4 * s[1], s[2]});
    }
    value attention(site_index index, small_unet::block const& block, value const& f) const {
        auto const module = graph.site(index);
        auto const sources = module.sources(f);
        ov::OutputVector in{by_head(module.scaled(linear(block.query, module.queries(f)))),
                            by_head(linear(block.key, sources)), by_head(linear(block.value, sources))};
        if (module.mask()) {
            in.push_back(*module.mask());
        }
        auto const heads = make<ov::opset13::ScaledDotProductAttention>(in, false);
        auto const& s = heads.get_shape(); // [frames, heads, tokens, channels of a head]
        auto const F = make<ov::opset13::Transpose>(heads, numbers({0, 2, 1, 3}));
        return module.output(f, reshaped(F, {s[0], s[2], s[1] * s[3]}));
    }
    static value by_head(value const& x) {
        auto const& s = x.get_shape();
        auto const split = reshaped(x, {s[0], s[1], small_unet::heads, s[2] / small_unet::heads});
        return make<ov::opset13::Transpose>(split, numbers({0, 2, 1, 3}));
    }
};

} // namespace genrender::examples
