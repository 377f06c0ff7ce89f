# SPDX-License-Identifier: MIT
"""Adds the extra inputs and outputs of feature I/O to a UNet that diffusers' classes were exported from by torch.onnx.export
(dynamo=False, static shapes): one file a pass, for ONNX Runtime and OpenVINO.

    python -m genrender.add_feature_io unet.onnx injected.onnx --pass injected --keyframes 3 --width 3 [--sites up_blocks]

The file must be of batches of the pass's number of frames. Self-attention modules are found by the names of their nodes
(attn1) and numbered in the order in which they run; those whose name holds --sites take part. Tensors are named
genrender.<number>.<what>, as genrender/adapters/openvino_site.hpp names them; genrender.graphs writes and reads them:

    keyframe   outputs f, F [frames, tokens, channels]; attention over the whole stack (eq. 3)
    injected   inputs f_KF, F_KF [keyframes, tokens, channels] (eqs. 5, 6); index int32 [frames tokens, width], weights
               [frames tokens, 1, width], own [frames, tokens, 1], the padded rows of eq. 6

With --scales-logits both have an input genrender.length_correction [1]: the logits of joined keys are multiplied by
(ln keys / ln own keys) to this power. An output genrender.scales_logits [1] gives it back and so says that it is honoured.

No keyframe is left out (the default, injection_settings::keeps_own_copy).
"""
import argparse
import math

import numpy
import onnx
from onnx import TensorProto, helper, numpy_helper


POWER, HONOURED = "genrender.length_correction", "genrender.scales_logits"


def modules_of(graph):
    """Prefixes of names of self-attention modules, in the order in which they run."""
    names = [node.name for node in graph.node]
    return [name.removesuffix("to_q/MatMul") for name in names if name.endswith("attn1/to_q/MatMul")]


def add_feature_io(model, pass_name, keyframes, width, sites="up_blocks", scales_logits=False):
    """Changes a model with known shapes in place; returns the numbers and names of the modules that take part."""
    graph = onnx.shape_inference.infer_shapes(model, data_prop=True).graph
    shapes = {info.name: [d.dim_value for d in info.type.tensor_type.shape.dim]
              for info in [*graph.value_info, *graph.input, *graph.output]}
    graph = model.graph
    taking_part = []
    for number, prefix in enumerate(modules_of(graph)):
        if sites not in prefix:
            continue
        taking_part.append((number, prefix))
        at = f"genrender.{number}."
        by_name = {node.name: node for node in graph.node}
        f = by_name[prefix + "to_q/MatMul"].input[0]
        last = by_name[prefix + "to_out.0/Add"]
        frames, tokens, channels = shapes[f]

        def add(op, inputs, output, before, **attributes):
            nodes = list(graph.node)
            node = helper.make_node(op, inputs, [at + output], at + output, **attributes)
            graph.node.insert(next(i for i, n in enumerate(nodes) if n.name == before), node)
            return at + output

        def sizes(name, numbers):
            graph.initializer.append(numpy_helper.from_array(numpy.array(numbers, numpy.int64), at + name))
            return at + name

        def extra_input(name, shape, kind=TensorProto.FLOAT):
            graph.input.append(helper.make_tensor_value_info(at + name, kind, shape))
            return at + name

        first = prefix + "to_q/MatMul"
        own_projection = [by_name[prefix + "to_k/MatMul"], by_name[prefix + "to_v/MatMul"]]
        if pass_name == "keyframe":
            row = add("Reshape", [f, sizes("in_a_row", [1, frames * tokens, channels])], "row", first)
            sources = add("Expand", [row, sizes("of_each", [frames, frames * tokens, channels])], "sources", first)
        else:
            f_KF = extra_input("f_KF", [keyframes, tokens, channels])
            row = add("Reshape", [f_KF, sizes("in_a_row", [1, keyframes * tokens, channels])], "row", first)
            each = add("Expand", [row, sizes("of_each", [frames, keyframes * tokens, channels])], "each", first)
            sources = add("Concat", [f, each], "sources", first, axis=1)
        for node in own_projection:
            node.input[0] = sources

        if scales_logits:
            query = by_name.get(prefix + "to_q/Add", by_name[first])  # an Add where the projection has a bias
            keys = frames * tokens if pass_name == "keyframe" else (1 + keyframes) * tokens
            ratio = math.log(keys) / math.log(tokens) if tokens > 1 else 1.0
            graph.initializer.append(numpy_helper.from_array(numpy.array([ratio], numpy.float32), at + "ratio"))
            scale = add("Pow", [at + "ratio", POWER], "scale", query.name)
            Q = query.output[0]
            query.output[0] = at + "Q"
            behind = next(i for i, n in enumerate(graph.node) if n.name == query.name) + 1
            graph.node.insert(behind, helper.make_node("Mul", [at + "Q", scale], [Q], at + "scaled"))

        F = last.output[0]
        if pass_name == "keyframe":
            for what, value in (("f", f), ("F", F)):
                graph.node.append(helper.make_node("Identity", [value], [at + what], at + what))
                graph.output.append(helper.make_tensor_value_info(at + what, TensorProto.FLOAT, [frames, tokens, channels]))
            continue
        last.output[0] = at + "F_hat"
        follower = next(n.name for n in graph.node if F in n.input)
        F_KF = extra_input("F_KF", [keyframes, tokens, channels])
        index = extra_input("index", [frames * tokens, width], TensorProto.INT32)
        weights = extra_input("weights", [frames * tokens, 1, width])
        own = extra_input("own", [frames, tokens, 1])
        rows = add("Reshape", [F_KF, sizes("rows_of", [keyframes * tokens, channels])], "rows", follower)
        gathered = add("Gather", [rows, index], "gathered", follower, axis=0)
        mixed = add("MatMul", [weights, gathered], "mixed", follower)
        F_bar = add("Reshape", [mixed, sizes("as_frames", [frames, tokens, channels])], "F_bar", follower)
        share = add("Mul", [at + "F_hat", own], "share", follower)
        out = add("Add", [share, F_bar], "F_out", follower)
        for node in graph.node:
            for i, name in enumerate(node.input):
                if name == F:
                    node.input[i] = out
    if not taking_part:
        raise ValueError(f"add_feature_io: no self-attention module is named {sites}, expected some of {modules_of(graph)}")
    if scales_logits:
        graph.input.append(helper.make_tensor_value_info(POWER, TensorProto.FLOAT, [1]))
        graph.node.append(helper.make_node("Identity", [POWER], [HONOURED], HONOURED))
        graph.output.append(helper.make_tensor_value_info(HONOURED, TensorProto.FLOAT, [1]))
    del graph.value_info[:]
    onnx.checker.check_model(model)
    return taking_part


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("model")
    parser.add_argument("out")
    parser.add_argument("--pass", dest="pass_name", choices=["keyframe", "injected"], required=True)
    parser.add_argument("--keyframes", type=int, required=True)
    parser.add_argument("--width", type=int, default=1)
    parser.add_argument("--sites", default="up_blocks")
    parser.add_argument("--scales-logits", action="store_true")
    given = parser.parse_args()
    changed = onnx.load(given.model)
    for number, prefix in add_feature_io(changed, given.pass_name, given.keyframes, given.width, given.sites,
                                         given.scales_logits):
        print(number, prefix)
    onnx.save(changed, given.out)
