# SPDX-License-Identifier: MIT
"""Times ONNX Runtime's fused attention on the shapes of benchmarks/attention/scaled_dot_product.bench.cpp.

Needs onnx, onnxruntime and NumPy. The operator is MultiHeadAttention of com.microsoft; inputs and output are bound, so
that nothing is copied into the session or out of it. Keys and values lie concatenated, which is not timed, once with a
token's heads side by side and once by heads, and the faster of both counts.
"""

# First of all, as the package that a Python without it is told to lack.
import onnxruntime

import numpy
import onnx

from support.attention_cases import attention_cases
from support.peer_times import peer_times

KERNELS = ["attention"]


def attention(heads, q, k, v):
    """Runs the operator for queries [frames, tokens, channels] and keys and values [frames, tokens, channels] or
    [frames, heads, tokens, head size]."""

    def tensor(name, of):
        return onnx.helper.make_tensor_value_info(name, onnx.TensorProto.FLOAT, of.shape)

    node = onnx.helper.make_node("MultiHeadAttention", ["Q", "K", "V"], ["F"], domain="com.microsoft", num_heads=heads)
    inputs = [tensor("Q", q), tensor("K", k), tensor("V", v)]
    graph = onnx.helper.make_graph([node], "attention", inputs, [tensor("F", q)])
    opsets = [onnx.helper.make_opsetid("", 17), onnx.helper.make_opsetid("com.microsoft", 1)]
    # The oldest format that has these opsets: every ONNX Runtime of today reads it, whichever onnx writes it.
    model = onnx.helper.make_model(graph, opset_imports=opsets, ir_version=8)

    options = onnxruntime.SessionOptions()
    options.intra_op_num_threads = options.inter_op_num_threads = 1
    session = onnxruntime.InferenceSession(model.SerializeToString(), options, providers=["CPUExecutionProvider"])
    binding = session.io_binding()
    # What is bound is the arrays' own memory: they live as long as what runs.
    arrays = {"Q": q, "K": k, "V": v, "F": numpy.zeros_like(q)}
    bound = {name: onnxruntime.OrtValue.ortvalue_from_numpy(values) for name, values in arrays.items()}
    for name in ("Q", "K", "V"):
        binding.bind_ortvalue_input(name, bound[name])
    binding.bind_ortvalue_output("F", bound["F"])
    return lambda kept=(arrays, bound): session.run_with_iobinding(binding)


def main():
    times = peer_times(__doc__, KERNELS)
    numbers = numpy.random.default_rng(1)
    for name, frames, tokens, heads, head_size, keyframes in attention_cases():
        if not times.wants(name):
            continue

        def random(*shape):
            return numbers.standard_normal(shape, dtype=numpy.float32)

        q = random(frames, tokens, heads * head_size)
        k, v = random(2, frames, heads, (keyframes + 1) * tokens, head_size)
        side_by_side = (x.transpose(0, 2, 1, 3).reshape(frames, -1, heads * head_size) for x in (k, v))
        times.add(name, f"ONNX Runtime {onnxruntime.__version__}", attention(heads, q, *side_by_side),
                  attention(heads, q, k, v))
    times.print()


if __name__ == "__main__":
    main()
