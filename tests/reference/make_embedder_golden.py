# SPDX-License-Identifier: MIT
"""Writes embedder_golden.hpp: what PyTorch computes in double precision for the encoder that train_embedder.py trains.

Needs Python 3.9 or later with PyTorch (any recent version, CPU only), numpy and safetensors:

    pip install torch numpy safetensors
    python3 tests/reference/make_embedder_golden.py

The tests compile the constants and never run Python. Weights and inputs are the numbers of golden_network.hpp.
"""

import math
import pathlib
import sys

import numpy
import torch

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[1] / "examples" / "reference_denoiser"))
import train_embedder  # noqa: E402


def values(name, count):
    """Numbers in [-1, 1): the scrambled sum (splitmix64) of a hash of the name and the index."""
    begin = 0xCBF29CE484222325
    for byte in name.encode():
        begin = ((begin ^ byte) * 0x100000001B3) % 2**64
    x = numpy.uint64(begin) + numpy.arange(count, dtype=numpy.uint64) * numpy.uint64(0x9E3779B97F4A7C15)
    x = (x ^ (x >> numpy.uint64(30))) * numpy.uint64(0xBF58476D1CE4E5B9)
    x = (x ^ (x >> numpy.uint64(27))) * numpy.uint64(0x94D049BB133111EB)
    x ^= x >> numpy.uint64(31)
    return (x >> numpy.uint64(40)).astype(numpy.float64) * 2.0**-23 - 1


def tensor(name, *shape):
    return torch.from_numpy(values(name, math.prod(shape))).reshape(shape)


model = train_embedder.PromptEmbedder(3).double().eval()
with torch.no_grad():
    for name, parameter in model.tensors().items():
        x = tensor(name, *parameter.shape)
        if parameter.dim() == 1:
            # Rounded as the file's single precision rounds it.
            x = (0.25 * x + (1 if name.endswith("weight") else 0)).float().double()
        else:
            # A power of two, so that the product is exact in float too.
            x = x * 2.0 ** math.floor(math.log2(math.sqrt(3 / parameter[0].numel())))
        parameter.copy_(x)
    image = model.image(0.5 + 0.5 * tensor("image", 1, 3, 18, 25))[0]
    text = model.text([[0, 3, 1]])[0]


def constants(name, comment, x):
    numbers = [repr(float(value)) for value in x]
    lines = [", ".join(numbers[i:i + 5]) for i in range(0, len(numbers), 5)]
    return (f"/// {comment}\ninline constexpr std::array<double, {len(numbers)}> {name} = {{\n    "
            + ",\n    ".join(lines) + "};\n")


(HERE / "embedder_golden.hpp").write_text(f"""// SPDX-License-Identifier: MIT
// What PyTorch computes in double precision. Written by make_embedder_golden.py: change that, not this.
// clang-format off
#pragma once

#include <array>

namespace genrender::golden {{

{constants("image_vector", "Of the image [3, 18, 25].", image)}
{constants("text_vector", "Of the third and the first of three words.", text)}
}} // namespace genrender::golden
""")
